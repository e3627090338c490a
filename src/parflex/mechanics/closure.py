"""The closure of the legs: Newton's method, damped, for J δq − Wᵀ δ(pose, q_e) = −gap.

A displacement δ (6 + N + z) holds those of Σp, in Σp, of the modes, and of all coordinates z = (q, e) of the
legs, group by group.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, block, block_diagonal, join, merged, mv, transpose
from parflex.base.spatial import quaternion_rate, within_half_a_turn
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.system import System, actuated_positions, assembled, diagonal
from parflex.robot.layout import coordinates

CLOSED = 1e-13  # of the platform's size: a gap that is round-off
STEPS = 60
LARGEST_TURN = 0.5  # rad, in one step
FOLLOW = 1e3  # how much easier a joint moves than the pose
WEAKEST = 1e-9  # of the largest singular value: what counts as a direction that can be moved along


class Freedom(NamedTuple):
    """The coordinates that Newton's method may move besides the joints."""

    platform: bool
    elastic: bool
    links: bool = False


JOINTS, POSE, ALL = Freedom(False, False), Freedom(True, False), Freedom(True, True)
EVERY = Freedom(True, True, True)
Equations = Callable[[Array], tuple[Array, Array]]  # gaps (…, r) and closure matrix of flat states


def closed(
    mechanism: Mechanism, x: Array, freedom: Freedom, equations: Equations | None = None
) -> tuple[Array, Array]:
    """The flat state (…, size) moved until its gaps vanish, and the largest gap (…,) m that is left.

    `equations` gives the gaps and the matrix of the closure of flat states where that is quicker than here.
    """

    def gap_and_step(y: Array) -> tuple[Array, Array]:
        r, G = equations_at(mechanism, y) if equations is None else equations(y)
        return r, -least_squares(mechanism, G, r, freedom)

    return damped(mechanism, x, gap_and_step)


def equations_at(mechanism: Mechanism, x: Array) -> tuple[Array, Array]:
    """Gaps (…, r) and closure matrix (…, r, 6 + N + z) at a flat state."""
    system = assembled(mechanism, x)
    return gaps(system), closure_matrix(system)


def posed(mechanism: Mechanism, x: Array, wanted: Array) -> tuple[Array, Array]:
    """The flat state moved until its gaps vanish and its actuated joints are as wanted (…, m)."""
    slides = mechanism.slides[mechanism.driven][mechanism.force_order]

    def gap_and_step(y: Array) -> tuple[Array, Array]:
        system = assembled(mechanism, y)
        ahead = actuated_positions(system) - wanted
        ahead = np.where(slides, ahead, within_half_a_turn(ahead))
        r = join([gaps(system), ahead])
        G, S = closure_matrix(system), actuated_rows(mechanism)
        S = np.broadcast_to(S, G.shape[:-2] + S.shape)
        return r, -least_squares(mechanism, np.concatenate([G, S], axis=-2), r, POSE)

    return damped(mechanism, x, gap_and_step)


def damped(
    mechanism: Mechanism, x: Array, gap_and_step: Callable[[Array], tuple[Array, Array]]
) -> tuple[Array, Array]:
    """Newton's method, for each state of a batch with the longest step that lessens the gap."""
    with np.errstate(invalid="ignore", divide="ignore"):
        r, step = gap_and_step(x)
        left, part = largest(r), np.ones(x.shape[:-1])
        for _ in range(STEPS):
            if np.all((left <= CLOSED * mechanism.size) | (part < 1e-6)):
                break
            trial = displaced(mechanism, x, part[..., None] * step)
            r, next_step = gap_and_step(trial)
            better = largest(r) < left
            x = np.where(better[..., None], trial, x)
            step = np.where(better[..., None], next_step, step)
            left = np.where(better, largest(r), left)
            part = np.where(better, np.minimum(1.0, 4 * part), part / 4)
    return x, left


def largest(r: Array) -> Array:
    """The largest entry (…,); infinite where one is not a number."""
    return np.max(np.nan_to_num(np.abs(r), nan=np.inf), axis=-1, initial=0.0)


def with_rates(mechanism: Mechanism, x: Array, freedom: Freedom) -> Array:
    """The flat state with rates corrected, as little as need be, so that the tips stay closed."""
    system = assembled(mechanism, x)
    rates = gaps(system, rate=True)
    change = least_squares(mechanism, closure_matrix(system), rates, freedom, np.inf)
    return accelerated(mechanism, x, -change)


def least_squares(
    mechanism: Mechanism, G: Array, r: Array, freedom: Freedom, longest: float = LARGEST_TURN
) -> Array:
    """The shortest δ (…, 6 + N + z) with G δ nearest to r, no longer than one step may be.

    Where the pose may move, its length is what counts: the joints follow.
    """
    scale = units(mechanism, freedom)
    ease = np.full(len(scale), FOLLOW if freedom.platform else 1.0)
    ease[: mechanism.layout.displacements.joints.start] = 1.0
    bad = ~np.all(np.isfinite(G), axis=(-2, -1))[..., None]
    inverse = np.linalg.pinv(np.where(bad[..., None], 0.0, G * (scale * ease)), rcond=WEAKEST / np.max(ease))
    step = ease * mv(inverse, np.where(bad, 0.0, r))
    length = np.max(np.abs(step), axis=-1, initial=0.0)[..., None] / mechanism.size
    return scale * step * np.minimum(1.0, longest / np.maximum(length, 1e-300))


def units(mechanism: Mechanism, freedom: Freedom) -> Array:
    """(6 + N + n,): what makes displacements comparable, in metres; zero where there is no freedom."""
    size, body = mechanism.size, mechanism.platform.body
    return np.concatenate(
        [
            freedom.platform * np.repeat([1.0, 1.0 / size], 3),
            np.full(body.modes, freedom.elastic * np.sqrt(body.moments.m)),
            np.where(
                mechanism.bends, freedom.links * mechanism.roots, np.where(mechanism.slides, 1.0, 1.0 / size)
            ),
        ]
    )


def closure_matrix(system: System) -> Array:
    """The rows (…, r, 6 + N + z) of [−Wᵀ J] of the tips that are not soft."""
    G = tip_matrix(system)
    return G[..., system.mechanism.firm, :] if system.mechanism.soft else G


def tip_matrix(system: System) -> Array:
    """[−Wᵀ J] (…, 3k, 6 + N + z), of all tips."""
    J = diagonal([block_diagonal(leg.J) for leg in system.legs])
    return block([[-transpose(system.W_p), -transpose(system.W_e), J]])


def gaps(system: System, rate: bool = False) -> Array:
    """The vectors from the platform's points to the tips (…, r) that are not soft, or their rates; zero for
    closed legs."""
    parts = [np.zeros(0)]
    for leg in system.legs:
        gap = leg.gap_rate if rate else leg.gap
        gap = gap[..., leg.group.firm]
        parts.append(merged(0.0 * gap if leg.group.closed else gap))
    return join(parts)


def actuated_rows(mechanism: Mechanism) -> Array:
    """(m, 6 + N + z), taking a displacement to that of the motors, in the order of Γ."""
    S = [block_diagonal(np.tile(group.S.T, (len(group.legs), 1, 1))) for group in mechanism.groups]
    joints = diagonal(S)[mechanism.force_order]
    return np.hstack([np.zeros((len(joints), 6 + mechanism.platform.modes)), joints])


def displaced(mechanism: Mechanism, x: Array, step: Array) -> Array:
    """The flat state with its pose, its bend and its carried joints displaced by δ (…, 6 + N + z)."""
    layout = mechanism.layout
    c, (pose, elastic, joints) = coordinates(x, layout), layout.displacements
    quaternion, step_p = x[..., layout.at.quaternion], step[..., pose]
    turned = quaternion + quaternion_rate(quaternion, step_p[..., 3:])
    turned = turned / np.linalg.norm(turned, axis=-1, keepdims=True)
    place = c.position + mv(c.rotation, step_p[..., :3])
    s = c.s + step[..., joints][..., mechanism.kept]
    return join([place, turned, c.twist, c.elastic + step[..., elastic], c.elastic_rate, s, c.sd, c.branches])


def accelerated(mechanism: Mechanism, x: Array, step: Array) -> Array:
    """The flat state with its rates changed by δ (…, 6 + N + z)."""
    layout = mechanism.layout
    c, (pose, elastic, joints) = coordinates(x, layout), layout.displacements
    rates = c.elastic_rate + step[..., elastic]
    sd = c.sd + step[..., joints][..., mechanism.kept]
    start = [x[..., layout.at.position], x[..., layout.at.quaternion], c.twist + step[..., pose]]
    return join([*start, c.elastic, rates, c.s, sd, c.branches])
