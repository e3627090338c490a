"""The closure of the legs: states on it, and the pose that given joints lead to.

A state with lower mobility, or with joints of its own, satisfies the closure or is no state. Here
Newton's method, damped, finds what does: J δq − Wᵀ δ(pose, q_e) = −gap.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, block, block_diagonal, join, merged, mv, transpose
from parflex.base.check import of_type
from parflex.base.errors import NotConverged
from parflex.base.spatial import quaternion_rate, within_half_a_turn
from parflex.mechanics.branches import check_branch, check_joints
from parflex.mechanics.system import System, actuated_positions, assembled, diagonal
from parflex.robot.layout import coordinates, pack
from parflex.robot.robot import Robot
from parflex.robot.state import State

CLOSED = 1e-13  # of the platform's size: a gap that is round-off
STEPS = 60
LARGEST_TURN = 0.5  # rad, in one step
FOLLOW = 1e3  # how much easier a joint moves than the pose
WEAKEST = 1e-9  # of the largest singular value: what counts as a direction that can be moved along


class Freedom(NamedTuple):
    """What Newton's method may move besides the joints."""

    platform: bool
    elastic: bool


JOINTS, POSE, ALL = Freedom(False, False), Freedom(True, False), Freedom(True, True)


def flat_state(robot: Robot, state: State) -> Array:
    """The flat state (…, size); joints that it carries are closed by Newton's method.

    Raises InputError where the state does not fit the robot, or its joints are on another branch.
    """
    layout = robot.layout
    of_type("state", state, State)
    check_joints(robot, state)
    if layout.carried:
        x = pack(started(robot, state), layout)
        x = with_rates(robot, closed(robot, x, JOINTS)[0], JOINTS)
    else:
        x = pack(state, layout)
    if state.joints is not None:
        check_branch(robot, x, state.joints)
    return x


def started(robot: Robot, state: State) -> State:
    """The state with the legs' postures where it names no joints."""
    given = state.joints or (None,) * len(robot.legs)
    postures = [np.zeros(len(leg.joints)) if leg.posture is None else leg.posture for leg in robot.legs]
    joints = tuple(p if q is None else q for q, p in zip(given, postures, strict=True))
    return replace(state, joints=joints)


def projected(robot: Robot, state: State) -> Array:
    """The flat state on the closure nearest to a state: its pose is moved, or else its bend too.

    Raises NotConverged where there is none near.
    """
    x = flat_state(robot, state)
    for freedom in (POSE, ALL):
        found, gap = closed(robot, x, freedom)
        if np.all(gap <= 10 * CLOSED * size_of(robot)):
            return with_rates(robot, found, freedom)
    raise NotConverged(
        f"no state on the closure was found near the given one: a gap of {np.max(gap):.1e} m remains at "
        f"some tip; give a pose nearer to one the robot can take, and the legs' joints with it"
    )


def closed(robot: Robot, x: Array, freedom: Freedom) -> tuple[Array, Array]:
    """The flat state (…, size) moved until its gaps vanish, and the largest gap (…,) m that is left."""

    def gap_and_step(y: Array) -> tuple[Array, Array]:
        system = assembled(robot, y)
        r = gaps(system)
        return r, -least_squares(robot, closure_matrix(system), r, freedom)

    return damped(robot, x, gap_and_step)


def posed(robot: Robot, x: Array, wanted: Array) -> tuple[Array, Array]:
    """The flat state moved until its gaps vanish and its actuated joints are as wanted (…, m)."""
    slides = np.array([joint.sigma for leg in robot.legs for joint in leg.joints if joint.mu])

    def gap_and_step(y: Array) -> tuple[Array, Array]:
        system = assembled(robot, y)
        ahead = actuated_positions(robot, system) - wanted
        ahead = np.where(slides, ahead, within_half_a_turn(ahead))
        r = join([gaps(system), ahead])
        G = closure_matrix(system)
        S = np.broadcast_to(actuated_rows(robot), G.shape[:-2] + actuated_rows(robot).shape)
        return r, -least_squares(robot, np.concatenate([G, S], axis=-2), r, POSE)

    return damped(robot, x, gap_and_step)


def damped(
    robot: Robot, x: Array, gap_and_step: Callable[[Array], tuple[Array, Array]]
) -> tuple[Array, Array]:
    """Newton's method, for each state of a batch with the longest step that lessens the gap."""
    with np.errstate(invalid="ignore", divide="ignore"):
        r, step = gap_and_step(x)
        left, part = largest(r), np.ones(x.shape[:-1])
        for _ in range(STEPS):
            if np.all((left <= CLOSED * size_of(robot)) | (part < 1e-6)):
                break
            trial = displaced(robot, x, part[..., None] * step)
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


def with_rates(robot: Robot, x: Array, freedom: Freedom) -> Array:
    """The flat state with rates corrected, as little as need be, so that the tips stay closed."""
    system = assembled(robot, x)
    rates = gaps(system, rate=True)
    return accelerated(robot, x, -least_squares(robot, closure_matrix(system), rates, freedom, np.inf))


def least_squares(robot: Robot, G: Array, r: Array, freedom: Freedom, longest: float = LARGEST_TURN) -> Array:
    """The shortest δ (…, 6 + N + n) with G δ nearest to r, no longer than one step may be.

    Where the pose may move, its length is what counts: the joints follow.
    """
    scale = units(robot, freedom)
    ease = np.where(
        np.arange(len(scale)) < 6 + robot.platform.modes, 1.0, FOLLOW if freedom.platform else 1.0
    )
    bad = ~np.all(np.isfinite(G), axis=(-2, -1))[..., None]
    inverse = np.linalg.pinv(np.where(bad[..., None], 0.0, G * (scale * ease)), rcond=WEAKEST / np.max(ease))
    step = ease * mv(inverse, np.where(bad, 0.0, r))
    length = np.max(np.abs(step), axis=-1, initial=0.0)[..., None] / size_of(robot)
    return scale * step * np.minimum(1.0, longest / np.maximum(length, 1e-300))


def units(robot: Robot, freedom: Freedom) -> Array:
    """(6 + N + n,): what makes displacements comparable, in metres; zero where there is no freedom."""
    size, modes = size_of(robot), robot.platform.modes
    slides = [j.sigma for group in robot.groups for i in group.legs for j in robot.legs[i].joints]
    return np.concatenate(
        [
            freedom.platform * np.repeat([1.0, 1.0 / size], 3),
            np.full(modes, freedom.elastic * np.sqrt(robot.platform.moments.m)),
            np.where(np.array(slides, dtype=bool), 1.0, 1.0 / size),
        ]
    )


def closure_matrix(system: System) -> Array:
    """[−Wᵀ J] (…, 3k, 6 + N + n), legs and tips in the order of the groups."""
    J = diagonal([block_diagonal(leg.J) for leg in system.legs])
    return block([[-transpose(system.W_p), -transpose(system.W_e), J]])


def gaps(system: System, rate: bool = False) -> Array:
    """From the platform's points to the tips (…, 3k), or the rates of it; zero for closed legs."""
    parts = [np.zeros(0)]
    for leg in system.legs:
        gap = leg.gap_rate if rate else leg.gap
        parts.append(merged(0.0 * gap if leg.group.closed else gap))
    return join(parts)


def actuated_rows(robot: Robot) -> Array:
    """(m, 6 + N + n), taking the step of a state to that of the actuated joints, in order of Γ."""
    mu = [j.mu for group in robot.groups for i in group.legs for j in robot.legs[i].joints]
    joints = np.eye(len(mu))[np.flatnonzero(mu)][robot.force_order]
    return np.hstack([np.zeros((len(joints), 6 + robot.platform.modes)), joints])


def displaced(robot: Robot, x: Array, step: Array) -> Array:
    """The flat state moved by δ (…, 6 + N + n) of its pose, in Σp, its modes and its joints."""
    c, N, n = coordinates(x, robot.layout), robot.platform.modes, robot.layout.carried
    turned = x[..., 3:7] + quaternion_rate(x[..., 3:7], step[..., 3:6])
    turned = turned / np.linalg.norm(turned, axis=-1, keepdims=True)
    place = x[..., :3] + mv(c.rotation, step[..., :3])
    q = c.q + carried_part(robot, step[..., 6 + N :])
    bent = c.elastic + step[..., 6 : 6 + N]
    return join([place, turned, c.twist, bent, c.elastic_rate, q, x[..., x.shape[-1] - n :]])


def accelerated(robot: Robot, x: Array, step: Array) -> Array:
    """The flat state with its rates changed by δ (…, 6 + N + n)."""
    c, N = coordinates(x, robot.layout), robot.platform.modes
    qd = c.qd + carried_part(robot, step[..., 6 + N :])
    rates = c.elastic_rate + step[..., 6 : 6 + N]
    return join([x[..., :7], c.twist + step[..., :6], c.elastic, rates, c.q, qd])


def carried_part(robot: Robot, joints: Array) -> Array:
    """Of all joints (…, n), in the order of the groups, those the state carries, in its order."""
    carried = [group.type.carries for group in robot.groups for _ in range(len(group.legs) * group.chain.n)]
    return joints[..., np.flatnonzero(carried)][..., robot.carried_order]


def size_of(robot: Robot) -> float:
    """Root mean square distance of the attachments from their centre, m."""
    return robot.platform.size
