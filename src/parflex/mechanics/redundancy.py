"""Rows of the closure that depend on others: found once, at assembly."""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, mv
from parflex.base.errors import OutOfReach
from parflex.mechanics.closure import ALL, POSE, closed, closure_matrix, displaced, flat_state, size_of, units
from parflex.mechanics.system import assembled
from parflex.robot.robot import Robot

DEPENDENT = 1e-7  # what is left of a unit row when the others are taken out
STATES = 4


class Rows(NamedTuple):
    """Closure rows by number: independent ones, those that depend on them, and the way back."""

    kept: Array
    dropped: Array
    order: Array


def closure_rows(robot: Robot) -> Rows:
    """The rows by pivoted orthogonalisation at several generic states near home.

    Legs that close by themselves have an invertible J, and so no row that depends on others.

    Raises OutOfReach where the legs do not meet the platform at home.
    """
    count = 3 * len(robot.tip_attachments)
    if robot.closed:
        kept = np.arange(count)
    else:
        kept = max((independent(G) for G in generic_matrices(robot)), key=len)
    dropped = np.setdiff1d(np.arange(count), kept)
    return Rows(kept, dropped, np.argsort(np.concatenate([kept, dropped])))


def generic_matrices(robot: Robot) -> list[Array]:
    """[−Wᵀ J] with rows of unit length, at states on the closure near home."""
    size, rng = size_of(robot), np.random.default_rng(0)
    home = flat_state(robot, robot.home)
    home, gap = closed(robot, home, POSE)
    if not gap <= 1e-9 * size:
        home, gap = closed(robot, home, ALL)
    if not gap <= 1e-9 * size:
        raise OutOfReach(
            f"at the home pose a gap of {gap:.3g} m remains between a leg and its attachment; move the home "
            f"pose or the legs, or give each leg a posture near its joint values there"
        )
    scale = size * units(robot, POSE)
    found = []
    for part in np.linspace(0.02, 0.05, STATES):
        moved = displaced(robot, home, part * scale * rng.uniform(-1, 1, len(scale)))
        x, gap = closed(robot, moved, POSE)
        if not gap <= 1e-9 * size:
            x = home
        G = closure_matrix(assembled(robot, x))
        found.append(G / np.linalg.norm(G, axis=-1, keepdims=True))
    return found


def independent(G: Array) -> Array:
    """Numbers of a largest set of independent rows, in order: pivoted Gram–Schmidt, twice over."""
    left = G.copy()
    chosen: list[int] = []
    basis = np.zeros((0, G.shape[1]))
    while True:
        lengths = np.linalg.norm(left, axis=1)
        best = int(np.argmax(lengths))
        if lengths[best] < DEPENDENT or len(chosen) == len(G):
            return np.array(sorted(chosen), dtype=int)
        chosen.append(best)
        unit = left[best] / lengths[best]
        unit = unit - basis.T @ mv(basis, unit)
        basis = np.vstack([basis, unit / np.linalg.norm(unit)])
        left = left - np.outer(left @ basis[-1], basis[-1])
