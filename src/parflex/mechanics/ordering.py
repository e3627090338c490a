"""Answers sorted by leg and by attachment."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.mechanics import system as assembly
from parflex.mechanics.kinematics import unstacked
from parflex.robot.robot import Robot


class Joints(NamedTuple):
    """Joint positions and rates, one (…, n_i) per leg; m and rad."""

    q: tuple[Array, ...]
    qd: tuple[Array, ...]


def joints_of(robot: Robot, system: assembly.System) -> Joints:
    """Joint positions and rates of an assembled system."""
    positions = [
        np.stack([assembly.joint_position(leg, j) for j in range(leg.group.chain.n)], axis=-1)
        for leg in system.legs
    ]
    return Joints(by_leg(robot, positions), by_leg(robot, [leg.qd for leg in system.legs]))


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
