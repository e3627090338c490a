"""Outputs that are seen of a robot: its platform's motion, its joints', and the forces in its struts."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from parflex.base.array import skew
from parflex.base.errors import InputError
from parflex.base.spatial import cayley
from parflex.linear.inputs import axis_labels, in_world
from parflex.linear.place import NodePlace
from parflex.linear.point import Point, moved_with
from parflex.linear.signal import Output, Rows, row_parts
from parflex.mechanics.closure import actuated_rows
from parflex.robot.robot import Robot


class Kind(NamedTuple):
    """The kinds of motion that are seen: the letter in labels, the units, and the part of `Rows`."""

    letter: str
    units: tuple[str, str]
    part: str


OF = {
    "displacement": Kind("", ("m", "rad"), "place"),
    "velocity": Kind("v", ("m/s", "rad/s"), "rate"),
    "acceleration": Kind("a", ("m/s^2", "rad/s^2"), "acceleration"),
}
FRAMES = ("world", "platform")


@dataclass(frozen=True)
class FramePose(Output):
    """The pose of Σp: displacement and rotation vector in the axes of the world, m and rad: "frame_x" …
    "frame_rz"."""

    def labels(self, robot: Robot) -> tuple[str, ...]:
        return axis_labels("frame")

    def units(self, robot: Robot) -> tuple[str, ...]:
        return ("m",) * 3 + ("rad",) * 3

    def rows(self, point: Point) -> Rows:
        return row_parts(point, place=in_world(point, point.T[:6]))


@dataclass(frozen=True)
class NodeMotion(NodePlace, Output):
    """The motion of a node of the platform, or of a point fixed to it at `offset` (3,) m in Σp, as it bends:
    "node[5]_x" … "node[5]_rz" for displacement and rotation vector, "…_vx" for velocities, "…_ax" for
    accelerations; in the axes of the "world" or the "platform".

    Raises InputError for a node that there is not, and for an unknown word.
    """

    of: str = "displacement"
    frame: str = "world"

    def __post_init__(self) -> None:
        super().__post_init__()
        for name, given, known in (("of", self.of, tuple(OF)), ("frame", self.frame, FRAMES)):
            if given not in known:
                raise InputError(f"NodeMotion.{name} is {given!r}; choose one of {', '.join(known)}")

    def labels(self, robot: Robot) -> tuple[str, ...]:
        return axis_labels(self.name, OF[self.of].letter)

    def units(self, robot: Robot) -> tuple[str, ...]:
        linear, angular = OF[self.of].units
        return (linear,) * 3 + (angular,) * 3

    def rows(self, point: Point) -> Rows:
        moved = self.motion(point)
        moved = in_world(point, moved) if self.frame == "world" else moved
        return row_parts(point, **{OF[self.of].part: moved})


@dataclass(frozen=True)
class JointMotion(Output):
    """The actuated joints as their encoders see them, m or rad: "joint[0]" …, in the order of the forces."""

    def labels(self, robot: Robot) -> tuple[str, ...]:
        return tuple(f"joint[{i}]" for i in range(robot.n_forces))

    def units(self, robot: Robot) -> tuple[str, ...]:
        return tuple("m" if joint.sigma else "rad" for joint in robot.actuated)

    def rows(self, point: Point) -> Rows:
        return row_parts(point, place=actuated_rows(point.mechanism) @ point.T)


@dataclass(frozen=True)
class StrutForce(Output):
    """The force along each actuated joint, N or N m: Γ − k q − c q̇ of its actuator, spring and damper, as a
    load cell in series with all three sees it: "strut[0]" …, in the order of the forces."""

    def labels(self, robot: Robot) -> tuple[str, ...]:
        return tuple(f"strut[{i}]" for i in range(robot.n_forces))

    def units(self, robot: Robot) -> tuple[str, ...]:
        return tuple("N" if joint.sigma else "N m" for joint in robot.actuated)

    def rows(self, point: Point) -> Rows:
        joints = point.mechanism.robot.actuated
        k, c = (np.array([getattr(joint, name) for joint in joints]) for name in ("k", "Fv"))
        moved = actuated_rows(point.mechanism) @ point.T
        every = np.eye(len(joints))
        return row_parts(point, place=-k[:, None] * moved, rate=-c[:, None] * moved, forces=every)


@dataclass(frozen=True)
class Accelerometer(NodePlace, Output):
    """An accelerometer on a node of the platform, m/s², in its own axes, which are those of Σp and turn as
    the platform does there: it sees gravity, too: "accelerometer[5]_x" … "accelerometer[5]_z".

    Raises InputError for a node that there is not, and for a body without rotation shapes.
    """

    def check(self, robot: Robot) -> None:
        super().check(robot)
        if robot.platform.modes and robot.platform.rotation_shapes is None:
            raise InputError(
                f"Accelerometer on node {self.node} turns with the platform, which has no rotation shapes; "
                f"give rotation_shapes to the body"
            )

    def labels(self, robot: Robot) -> tuple[str, ...]:
        return tuple(f"accelerometer[{self.node}]_{axis}" for axis in "xyz")

    def units(self, robot: Robot) -> tuple[str, ...]:
        return ("m/s^2",) * 3

    def rows(self, point: Point) -> Rows:
        x, body = point.system.x, point.mechanism.platform.body
        moved, gravity = self.motion(point), np.asarray(x.rotation).T @ point.mechanism.gravity
        turns = body.shapes_at(self.node, self.offset)[1]
        axes, tilt = cayley(turns @ x.elastic, turns)
        turned = point.T[3:6] + tilt @ point.T[6 : 6 + body.modes]
        carried = x.rotation.T @ moved_with(self.position(point))[:3]
        parts = {"place": -axes.T @ skew(gravity) @ turned, "acceleration": axes.T @ moved[:3]}
        return row_parts(point, **parts, felt=axes.T @ carried)
