"""Inputs and outputs of a linear system."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.linear.point import Point
from parflex.robot.robot import Robot

AXES = ("x", "y", "z", "rx", "ry", "rz")


class Push(NamedTuple):
    """The effect of r inputs u, their rates and double integrals: ζ̈ = … + B u + B_t u̇ + B_2 ∬u, forces along
    the actuated joints, and the acceleration of the base that is felt."""

    by_value: Array  # B (d, r)
    by_rate: Array  # B_t (d, r)
    by_integral: Array  # B_2 (d, r)
    forces: Array  # (m, r), by u
    forces_by_rate: Array  # (m, r), by u̇
    felt: Array  # (6, r), by u, linear and angular, in Σ0
    felt_by_integral: Array  # (6, r), by ∬u
    load: Array  # (6 + N, r), the load on the platform by u


class Rows(NamedTuple):
    """The rows of o outputs: y = P ζ + R ζ̇ + Q ζ̈ + G Γ + F a_b + L w, with the felt acceleration of the base
    and the load w on the platform."""

    place: Array  # (o, d)
    rate: Array  # (o, d)
    acceleration: Array  # (o, d)
    forces: Array  # (o, m)
    felt: Array  # (o, 6)
    load: Array  # (o, 6 + N)


@dataclass(frozen=True)
class Signal(ABC):
    """A group of inputs or outputs, with a label and a unit for each."""

    @abstractmethod
    def labels(self, robot: Robot) -> tuple[str, ...]:
        """The labels, such as "force[0]" or "node[12]_z"."""

    @abstractmethod
    def units(self, robot: Robot) -> tuple[str, ...]:
        """The units of the entries."""

    def check(self, robot: Robot) -> None:
        """Nothing where the robot has it; raises InputError where it lacks it."""
        return


class Input(Signal):
    """Inputs that push a robot."""

    @abstractmethod
    def push(self, point: Point) -> Push:
        """Their effect about an equilibrium."""


class Output(Signal):
    """Outputs that are seen of a robot."""

    @abstractmethod
    def rows(self, point: Point) -> Rows:
        """Their rows about an equilibrium."""


def push_parts(count: int, point: Point, **parts: Array) -> Push:
    """A push of r inputs of which some parts are given, and others zero."""
    none = Push(*(np.zeros((rows, count)) for rows in push_lengths(point)))
    return none._replace(**parts)


def push_lengths(point: Point) -> tuple[int, ...]:
    """The lengths of the columns of the parts of a push."""
    d, m, n = point.T.shape[1], len(point.forces), 6 + point.mechanism.platform.modes
    return (d, d, d, m, m, 6, 6, n)


def row_lengths(point: Point) -> tuple[int, ...]:
    """The lengths of the parts of rows."""
    d = point.T.shape[1]
    return (d, d, d, len(point.forces), 6, 6 + point.mechanism.platform.modes)


def along_joints(point: Point, forces: Array, by_rate: Array | None = None) -> Push:
    """The push of forces (m, r) along the actuated joints, by inputs and by their rates."""
    by_rate = 0.0 * forces if by_rate is None else by_rate
    pushed, by_rates = point.pushed(forces=forces), point.pushed(forces=by_rate)
    parts = {"by_value": pushed, "by_rate": by_rates, "forces": forces, "forces_by_rate": by_rate}
    return push_parts(forces.shape[1], point, **parts)


def on_platform(point: Point, load: Array) -> Push:
    """The push of loads (6 + N, r) on the platform."""
    return push_parts(load.shape[1], point, by_value=point.pushed(load=load), load=load)


def row_parts(
    point: Point,
    place: Array | None = None,
    rate: Array | None = None,
    acceleration: Array | None = None,
    forces: Array | None = None,
    felt: Array | None = None,
    load: Array | None = None,
) -> Rows:
    """Rows of which some parts are given, and others zero."""
    parts = (place, rate, acceleration, forces, felt, load)
    count = next(len(part) for part in parts if part is not None)
    widths = row_lengths(point)
    found = (np.zeros((count, n)) if part is None else part for part, n in zip(parts, widths, strict=True))
    return Rows(*found)
