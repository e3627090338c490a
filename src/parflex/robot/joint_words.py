"""Joints and actuators in words: their names, units, values and limits."""

from collections.abc import Iterator

import numpy as np

from parflex.base.array import Array
from parflex.robot.leg import Joint
from parflex.robot.robot import Robot


def driven(robot: Robot) -> Iterator[tuple[int, int, Joint]]:
    """The actuated joints in the order of Γ: number of the leg, number in the leg (both from 1), joint."""
    for number, leg in enumerate(robot.legs, start=1):
        for j, joint in enumerate(leg.joints, start=1):
            if joint.mu:
                yield number, j, joint


def actuator_names(robot: Robot) -> list[str]:
    """The names of the actuators: by leg, and by joint where a leg has several."""
    legs = [number for number, _, _ in driven(robot)]
    return [f"leg {leg}" + f", joint {j}" * (legs.count(leg) > 1) for leg, j, _ in driven(robot)]


def actuator_units(robot: Robot) -> str:
    """The unit of the actuators' forces: N, N m, or both where sliders and motors are mixed."""
    return by_type(robot, "N", "N m")


def position_units(robot: Robot) -> str:
    """The unit of the actuated joints' positions: m, rad, or both."""
    return by_type(robot, "m", "rad")


def by_type(robot: Robot, sliding: str, turning: str) -> str:
    """The units that the actuators have, those of sliders first."""
    kinds = {joint.sigma for _, _, joint in driven(robot)}
    return ", ".join(unit for sigma, unit in ((1, sliding), (0, turning)) if sigma in kinds) or sliding


def beyond_limits(robot: Robot, joints: Array) -> str:
    """A line for each joint of (T, legs, n) that was beyond its limits; they are not enforced."""
    lines = []
    for number, leg in enumerate(robot.legs, start=1):
        q = joints[:, number - 1]
        for j, joint in enumerate(leg.joints):
            if np.any((q[:, j] < joint.q_min) | (q[:, j] > joint.q_max)):
                was = f"{joint_value(joint, np.min(q[:, j]))} … {joint_value(joint, np.max(q[:, j]))}"
                kept = f"{joint_value(joint, joint.q_min)} … {joint_value(joint, joint.q_max)}"
                lines.append(f"leg {number}, joint {j + 1} was at {was}, beyond its limits {kept}")
    return "\n".join(lines)


def beyond_strokes(robot: Robot, positions: Array) -> list[str]:
    """A line for each actuated joint of (T, m) that is to go beyond its limits."""
    lines = []
    for (leg, _, joint), q in zip(driven(robot), positions.T, strict=True):
        if np.any((q < joint.q_min) | (q > joint.q_max)):
            asked = f"{joint_value(joint, np.min(q))} … {joint_value(joint, np.max(q))}"
            kept = f"{joint_value(joint, joint.q_min)} … {joint_value(joint, joint.q_max)}"
            lines.append(f"the joint of leg {leg} is to go {asked}, beyond its stroke {kept}")
    return lines


def joint_value(joint: Joint, value: float) -> str:
    """A joint value in degrees, or in metres."""
    number, unit = (value, "m") if joint.sigma else (np.degrees(value), "deg")
    return f"{round(float(number), 9) + 0.0:.4g} {unit}"
