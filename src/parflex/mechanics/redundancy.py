"""Rows of the closure that depend on others: found once, at assembly."""

from dataclasses import replace

import numpy as np

from parflex.base.array import Array, mv
from parflex.base.errors import OutOfReach
from parflex.mechanics.closure import ALL, POSE, closed, displaced, tip_matrix, units
from parflex.mechanics.flat_state import flat_state, shut
from parflex.mechanics.mechanism import Mechanism, Rows
from parflex.mechanics.rests import rested
from parflex.mechanics.system import assembled, examined
from parflex.robot.robot import Robot

# what is left of a unit row when the others are taken out; where rows are dependent at every state, as those
# of a table on sliding columns, states closed to CLOSED are off by its square root, 3e-7
DEPENDENT = 1e-6
STATES = 4
NONE = np.zeros(0, dtype=int)


def with_rows(mechanism: Mechanism) -> Mechanism:
    """The mechanism that knows which rows of its closure the models solve; raises as `closure_rows`."""
    rows, stiff, unbent = closure_rows(mechanism)
    return replace(mechanism, rows=rows, rows_stiff=stiff, rows_unbent=unbent)


def solvable(robot: Robot) -> Mechanism:
    """The mechanism of a robot, ready for the models; raises as `closure_rows`."""
    return with_rows(rested(robot))


def closure_rows(mechanism: Mechanism) -> tuple[Rows, Rows, Rows]:
    """The rows by pivoted orthogonalisation at several generic states near home; also those of legs that do
    not bend, and of a robot of which nothing bends.

    Legs that close by themselves have an invertible J, and so no row that depends on others.

    Raises OutOfReach where the legs do not meet the platform at home.
    """
    count, bend = 3 * len(mechanism.attachments), mechanism.layout.displacements.elastic
    if mechanism.closed and not mechanism.soft:
        every = rows_of(np.arange(count), count)
        return every, every, every
    found, firm = generic_matrices(mechanism), mechanism.firm
    held = firm[most_independent([G[firm] for G in found])]
    stiff = [G * (units(mechanism, ALL) > 0) for G in found]
    unbent = [np.delete(G, bend, axis=1) for G in stiff]
    of_stiff, of_unbent = (rows_of(most_independent(each), count) for each in (stiff, unbent))
    return rows_of(held, count, np.setdiff1d(np.arange(count), firm)), of_stiff, of_unbent


def rows_of(kept: Array, count: int, released: Array = NONE) -> Rows:
    """The rows that are kept, of so many, some of which are those of soft tips."""
    dropped = np.setdiff1d(np.arange(count), np.concatenate([kept, released]))
    return Rows(kept, dropped, released, np.argsort(np.concatenate([kept, dropped, released])))


def most_independent(matrices: list[Array]) -> Array:
    """Numbers of a largest set of rows that are independent in one of the matrices (r, c)."""
    units = (G / np.linalg.norm(G, axis=1, keepdims=True) for G in matrices)
    return max((independent(G) for G in units), key=len)


def generic_matrices(mechanism: Mechanism) -> list[Array]:
    """[−Wᵀ J] of all tips at states on the closure near home, soft tips closed where that can be."""
    size, rng, tight = mechanism.size, np.random.default_rng(0), shut(mechanism)
    start = flat_state(mechanism, mechanism.robot.home)
    home, gap = closed_near(tight, start)
    if mechanism.soft and not gap <= 1e-9 * size:
        tight = mechanism
        home, gap = closed_near(tight, start)
    if not gap <= 1e-9 * size:
        check_reach(mechanism)
        raise OutOfReach(
            f"at the home pose a gap of {gap:.3g} m remains between a leg and its attachment; move the home "
            f"pose or the legs, or give each leg a posture near its joint values there"
        )
    scale = size * units(mechanism, POSE)
    found = []
    for part in np.linspace(0.02, 0.05, STATES):
        moved = displaced(mechanism, home, part * scale * rng.uniform(-1, 1, len(scale)))
        x, gap = closed(tight, moved, POSE)
        if not gap <= 1e-9 * size:
            x = home
        found.append(tip_matrix(assembled(mechanism, x)))
    return found


def closed_near(mechanism: Mechanism, x: Array) -> tuple[Array, Array]:
    """The flat state on the closure near one, and the gap (m) that remains."""
    found, gap = closed(mechanism, x, POSE)
    return (found, gap) if gap <= 1e-9 * mechanism.size else closed(mechanism, found, ALL)


def check_reach(mechanism: Mechanism) -> None:
    """Raise OutOfReach where a leg cannot reach its attachment at home."""
    reach = examined(mechanism, flat_state(mechanism, mechanism.robot.home))[1][mechanism.health.reach]
    short = np.flatnonzero(~(reach >= 0))
    if len(short):
        raise OutOfReach(
            f"at home leg {short[0] + 1} cannot reach its attachment; move the home pose or the leg, or "
            f"give its links other lengths"
        )


def independent(G: Array) -> Array:
    """Numbers of a largest set of independent rows, in order: pivoted Gram–Schmidt, twice over."""
    left = G.copy()
    chosen: list[int] = []
    basis = np.zeros((0, G.shape[1]))
    while len(chosen) < len(G):
        lengths = np.linalg.norm(left, axis=1)
        best = int(np.argmax(lengths))
        if lengths[best] < DEPENDENT:
            break
        chosen.append(best)
        unit = left[best] / lengths[best]
        unit = unit - basis.T @ mv(basis, unit)
        basis = np.vstack([basis, unit / np.linalg.norm(unit)])
        left = left - np.outer(left @ basis[-1], basis[-1])
    return np.array(sorted(chosen), dtype=int)
