"""The forces of the legs on the platform, and figures that are linear in its bend."""

from dataclasses import dataclass

import numpy as np

from parflex.base.array import Array, join, mv
from parflex.base.check import exactly
from parflex.base.errors import InputError
from parflex.base.spatial import quaternion_rate
from parflex.compiled.slopes import slopes
from parflex.kernels import models
from parflex.kernels.moved_base import AT_REST, BASE, moved_base
from parflex.linear.point import Point
from parflex.linear.signal import Output, Rows, row_parts
from parflex.mechanics.closure import displaced
from parflex.mechanics.ordering import by_attachment
from parflex.robot.layout import coordinates
from parflex.robot.robot import Robot

STEP = 1e-5  # of the platform's size, by which wrenches that stay in the world are turned: they are smooth


@dataclass(frozen=True)
class ContactForces(Output):
    """The changes of the forces of the legs on the platform, N, in the axes of Σp: "contact[0]_x" … of each
    attachment that legs hold, those of several legs together.

    Raises InputError where contact forces are not unique (`model.mobility`).
    """

    def labels(self, robot: Robot) -> tuple[str, ...]:
        return tuple(f"contact[{i}]_{axis}" for i in held(robot) for axis in "xyz")

    def units(self, robot: Robot) -> tuple[str, ...]:
        return ("N",) * (3 * len(held(robot)))

    def rows(self, point: Point) -> Rows:
        """The rows, by the graph of the direct model. Raises InputError where forces are not unique."""
        if len(point.mechanism.solved_rows.dropped):
            raise InputError(
                "ContactForces are not unique: legs hold more than they must (model.mobility); observe "
                "StrutForce or the motion"
            )
        by_x, by_forces, by_load, by_base = contact_slopes(point)
        place, rate = moved_states(point)
        turned = np.stack([wrenches(point, step) for step in point.T.T], axis=-1)
        parts = {"place": by_x @ place + by_load @ turned, "rate": by_x @ rate}
        return row_parts(point, **parts, forces=by_forces, load=by_load, felt=by_base)


@dataclass(frozen=True)
class Strain(Output):
    """Figures that are linear in the platform's bend, as strain gauges and stresses are: y = shapes q_e, with
    shapes (o, N) per kg^½ m, such as the strains of the modes at o gauges: "strain[0]" …, in your own unit.

    Raises InputError where shapes are not as many as the platform has modes.
    """

    shapes: tuple[tuple[float, ...], ...]
    unit: str = "1"

    def __post_init__(self) -> None:
        found = exactly("Strain.shapes", self.shapes, (None, None))
        object.__setattr__(self, "shapes", tuple(tuple(float(v) for v in row) for row in found))
        if not isinstance(self.unit, str):
            raise InputError(f"Strain.unit is {type(self.unit).__name__}; give a text")

    def check(self, robot: Robot) -> None:
        N = robot.platform.modes
        if any(len(row) != N for row in self.shapes):
            raise InputError(f"Strain.shapes has rows of {len(self.shapes[0])}; the platform has {N} modes")

    def labels(self, robot: Robot) -> tuple[str, ...]:
        return tuple(f"strain[{i}]" for i in range(len(self.shapes)))

    def units(self, robot: Robot) -> tuple[str, ...]:
        return (self.unit,) * len(self.shapes)

    def rows(self, point: Point) -> Rows:
        N = point.mechanism.platform.modes
        return row_parts(point, place=np.array(self.shapes) @ point.T[6 : 6 + N])


def held(robot: Robot) -> list[int]:
    """The attachments that legs hold."""
    return sorted({tip.attachment for leg in robot.legs for tip in leg.tips})


def contact_slopes(point: Point) -> tuple[Array, ...]:
    """∂ of the forces (3k,) at the attachments that are held, by the flat state, by Γ, by the load on the
    platform and by the acceleration of the base (6,): exact, of the graph of the direct model."""
    mechanism = point.mechanism
    load = point.load(coordinates(point.x, mechanism.layout))
    given = {"x": point.x, "forces": point.forces, "load": load, BASE: AT_REST}
    found = slopes(moved_base(mechanism, models.direct), "contact", ("x", "forces", "load", BASE), given)
    by_x, by_forces, by_load, by_base = (at_attachments(point, part) for part in found)
    return by_x, by_forces, by_load, by_base[:, -6:]


def at_attachments(point: Point, rows: Array) -> Array:
    """Rows (3 tips, c) by leg and tip as rows (3k, c) by attachment that is held."""
    columns = by_attachment(point.mechanism, rows.T)
    found: Array = columns[:, held(point.mechanism.robot)].reshape(len(columns), -1).T
    return found


def moved_states(point: Point) -> tuple[Array, Array]:
    """∂ of the flat state (size, d) by ζ and by ζ̇."""
    layout, x, T = point.mechanism.layout, point.system.x, point.T.T
    at, none = layout.at, np.zeros((len(T), layout.size))
    place, rate, N = none.copy(), none.copy(), point.mechanism.platform.modes
    pose, bend, joints = T[:, :6], T[:, 6 : 6 + N], T[:, 6 + N :][:, point.mechanism.kept]
    place[:, at.position] = mv(x.rotation, pose[:, :3])
    place[:, at.quaternion] = quaternion_rate(point.x[at.quaternion], pose[:, 3:])
    for parts, state in (((at.elastic, at.joints), place), ((at.elastic_rate, at.joint_rates), rate)):
        state[:, parts[0]], state[:, parts[1]] = bend, joints
    rate[:, at.twist] = pose
    return place.T, rate.T


def wrenches(point: Point, step: Array) -> Array:
    """∂ of the load (6 + N,) along a displacement (6 + N + z,): of wrenches that stay in the world."""
    h, layout = STEP * point.mechanism.size, point.mechanism.layout
    moved = (displaced(point.mechanism, point.x, sign * h * step) for sign in (1, -1))
    ahead, behind = (point.load(coordinates(x, layout)) for x in moved)
    found: Array = (join([ahead]) - join([behind])) / (2 * h)
    return found
