"""What the models answer, and how answers are sorted: by leg, by attachment."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from parflex import assembly
from parflex.array import Array
from parflex.kinematics import unstacked
from parflex.robot import Robot


class Accelerations(NamedTuple):
    """The direct model's answer, all in Σp.

    platform V̇_p (…, 6) m/s², rad/s²; elastic q̈_e (…, N); contact_forces (…, k, 3) N on the
    platform, by attachment.
    """

    platform: Array
    elastic: Array
    contact_forces: Array


class Forces(NamedTuple):
    """The inverse model's answer.

    forces Γ (…, m) N or N m; elastic q̈_e (…, N), platform V̇_p (…, 6) and contact_forces
    (…, k, 3) N that go with them, in Σp.
    """

    forces: Array
    elastic: Array
    platform: Array
    contact_forces: Array


class DirectJacobian(NamedTuple):
    """∂(V̇_p, q̈_e), rows (6 + N), of the direct model.

    state (…, 6 + N, 12 + 2 N + 2 n) by small motions (δp 3 in Σ0, δθ 3, δv_p 3, δω_p 3, δq_e N,
    δq̇_e N[, δq, δq̇ carried]), δθ being a rotation vector in Σp: R → R exp(δθ̂); forces
    (…, 6 + N, m) by Γ; load (…, 6 + N, 6 + N) by a generalised force on (Σp, modes); parameters
    (…, 6 + N, P) by the model's parameters, one after the other.
    """

    state: Array
    forces: Array
    load: Array
    parameters: Array


class InverseJacobian(NamedTuple):
    """∂Γ, rows (m), of the inverse model.

    state (…, m, 12 + 2 N + 2 n) by small motions as in `DirectJacobian`, target (…, m, m) by the
    output's acceleration.
    """

    state: Array
    target: Array


class Reactions(NamedTuple):
    """What each link receives through its joint, in the axes of its own frame; one entry per leg.

    force (…, n_i, 3) N, moment (…, n_i, 3) N m about the frame's origin. Along the joint's axis it
    holds the actuator's force less friction, spring and rotor.
    """

    force: tuple[Array, ...]
    moment: tuple[Array, ...]


class Legs(NamedTuple):
    """Joint positions and rates, one (…, n_i) per leg; m and rad."""

    q: tuple[Array, ...]
    qd: tuple[Array, ...]


def legs_of(robot: Robot, system: assembly.System) -> Legs:
    """Joint positions and rates of an assembled system."""
    positions = [
        np.stack([assembly.joint_position(leg, j) for j in range(leg.group.chain.n)], axis=-1)
        for leg in system.legs
    ]
    return Legs(by_leg(robot, positions), by_leg(robot, [leg.qd for leg in system.legs]))


def by_leg(robot: Robot, values: Sequence[Any], core: int = 1) -> tuple[Array, ...]:
    """Arrays (…, L, n) by group, or (…, L, n, 3) with two axes of their own, as one per leg."""
    found: list[Array] = [np.zeros(0)] * len(robot.legs)
    for group, value in zip(robot.groups, values, strict=True):
        for place, number in enumerate(group.legs):
            found[number] = np.take(value, place, axis=-1 - core)
    return tuple(found)


def by_attachment(robot: Robot, f: Array) -> Array:
    """Contact forces (…, k, 3) by attachment, zero where no leg holds, from (…, 3 tips)."""
    return np.matmul(robot.held, unstacked(f))


def by_rows(flat: Array, rows: int) -> Array:
    """A matrix (…, rows, c) that is given by rows, (…, rows c)."""
    return flat.reshape((*flat.shape[:-1], rows, flat.shape[-1] // rows))
