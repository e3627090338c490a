"""Inputs that push a robot: its actuators, the rests of its springs, wrenches."""

from dataclasses import dataclass

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.linear.place import NodePlace
from parflex.linear.point import Point
from parflex.linear.signal import AXES, Input, Push, along_joints, on_platform, push_parts
from parflex.robot.robot import Robot


@dataclass(frozen=True)
class Actuators(Input):
    """The forces Γ of all actuators, N or N m: "force[0]" …, in the order of the forces."""

    def labels(self, robot: Robot) -> tuple[str, ...]:
        return tuple(f"force[{i}]" for i in range(robot.n_forces))

    def units(self, robot: Robot) -> tuple[str, ...]:
        return tuple("N" if joint.sigma else "N m" for joint in robot.actuated)

    def push(self, point: Point) -> Push:
        return along_joints(point, np.eye(len(point.forces)))


@dataclass(frozen=True)
class Reference(Input):
    """The rests q_0 of the springs on actuated joints, m or rad: "reference[0]" …, numbered as the forces.

    A rest r acts as the force k r + c ṙ of the joint's actuator: the length that a piezo strut or a drive
    with position control is told. Joints without a spring have no such input.

    Raises InputError where no actuated joint has a spring.
    """

    def joints(self, robot: Robot) -> list[int]:
        """The numbers of the actuators whose joints have springs."""
        return [i for i, joint in enumerate(robot.actuated) if joint.k > 0]

    def check(self, robot: Robot) -> None:
        if not self.joints(robot):
            raise InputError(
                "Reference is the rest of springs, but no actuated joint has one; give it a stiffness k, or "
                "take Actuators()"
            )

    def labels(self, robot: Robot) -> tuple[str, ...]:
        return tuple(f"reference[{i}]" for i in self.joints(robot))

    def units(self, robot: Robot) -> tuple[str, ...]:
        joints = robot.actuated
        return tuple("m" if joints[i].sigma else "rad" for i in self.joints(robot))

    def push(self, point: Point) -> Push:
        which, joints = self.joints(point.mechanism.robot), point.mechanism.robot.actuated
        along = np.eye(len(point.forces))[:, which]
        k, c = (np.array([getattr(joints[i], name) for i in which]) for name in ("k", "Fv"))
        return along_joints(point, along * k, along * c)


@dataclass(frozen=True)
class NodeWrench(NodePlace, Input):
    """A force and a moment on a node of the platform, or on a point fixed to it at `offset` (3,) m in Σp:
    "node[5]_fx" … "node[5]_mz", N and N m, in the axes of the world.

    Raises InputError for a node that there is not, and for an offset on a body without rotation shapes.
    """

    def labels(self, robot: Robot) -> tuple[str, ...]:
        return tuple(f"{self.name}_{part}" for part in ("fx", "fy", "fz", "mx", "my", "mz"))

    def units(self, robot: Robot) -> tuple[str, ...]:
        return ("N",) * 3 + ("N m",) * 3

    def push(self, point: Point) -> Push:
        R = np.asarray(point.system.x.rotation)
        world = np.kron(np.eye(2), R.T)
        return on_platform(point, self.wrench_map(point) @ world)


@dataclass(frozen=True)
class BaseAcceleration(Input):
    """The acceleration of the base, of Σ0's origin and its turning, in the world's axes, m/s² and rad/s²:
    "base_x" … "base_rz". Outputs are relative to the base.

    Where there is gravity, turns of the base lean it: the system has them and their rates as states, poles at
    zero, which `modes()` and `poles` leave out.
    """

    def labels(self, robot: Robot) -> tuple[str, ...]:
        return axis_labels("base")

    def units(self, robot: Robot) -> tuple[str, ...]:
        return ("m/s^2",) * 3 + ("rad/s^2",) * 3

    def push(self, point: Point) -> Push:
        leaning = np.hstack([np.zeros((6, 3)), point.leaning()])
        by_integral = point.by_base @ leaning
        parts = {"by_value": point.by_base, "by_integral": by_integral}
        return push_parts(6, point, **parts, felt=np.eye(6), felt_by_integral=leaning)


def axis_labels(name: str, letters: str = "") -> tuple[str, ...]:
    """Labels of six components."""
    return tuple(f"{name}_{letters}{axis}" for axis in AXES)


def in_world(point: Point, rows: Array) -> Array:
    """Rows (6, d) of vectors in Σp, turned into the axes of the world."""
    found: Array = np.kron(np.eye(2), np.asarray(point.system.x.rotation)) @ rows
    return found
