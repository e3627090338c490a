"""Answers sorted by leg and by attachment."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from parflex.base.array import Array, stack
from parflex.mechanics.kinematics import unstacked
from parflex.mechanics.leg_terms import joint_position
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.system import System


class Joints(NamedTuple):
    """Joint positions and rates, one (…, n_i) per leg; m and rad."""

    q: tuple[Array, ...]
    qd: tuple[Array, ...]


def joints_of(system: System) -> Joints:
    """Joint positions and rates of an assembled system."""
    positions = [
        np.broadcast_to(stack([joint_position(leg, j) for j in range(leg.group.chain.n)]), leg.qd.shape)
        for leg in system.legs
    ]
    rates = [leg.qd for leg in system.legs]
    return Joints(by_leg(system.mechanism, positions), by_leg(system.mechanism, rates))


def by_leg(mechanism: Mechanism, values: Sequence[Any], core: int = 1) -> tuple[Array, ...]:
    """Arrays (…, L, n) by group, or (…, L, n, 3) with two axes of their own, as one per leg."""
    found: list[Array] = [np.zeros(0)] * len(mechanism.robot.legs)
    for group, value in zip(mechanism.groups, values, strict=True):
        for place, number in enumerate(group.legs):
            found[number] = np.take(value, place, axis=-1 - core)
    return tuple(found)


def by_attachment(mechanism: Mechanism, f: Array) -> Array:
    """Contact forces (…, k, 3) by attachment, zero where no leg holds, from (…, 3 tips) by leg."""
    return np.matmul(mechanism.held, unstacked(f))


def by_rows(flat: Array, rows: int) -> Array:
    """A matrix (…, rows, c) that is given by rows, (…, rows c)."""
    return flat.reshape((*flat.shape[:-1], rows, flat.shape[-1] // rows))
