"""A robot from a file at its home pose: whether it stands, moves and is driven as its author expects."""

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.mechanics.flat_state import turned
from parflex.model.model import Model
from parflex.robot.joint_words import joint_value
from parflex.robot.leg import Leg
from parflex.robot.robot import Robot

FAR = 1.0  # rad, between a joint at home and in the posture that names its branch


def joints_at_home(robot: Robot) -> tuple[Array, ...]:
    """Joint positions (n_i,) of each leg; raises InputError where one does not reach the platform."""
    return Model(robot, "numpy").joints(robot.home).q


def check_posture(leg: Leg, number: int, q: Array) -> None:
    """Raise InputError where a leg, with joints q (n,) at home, is on another branch than its posture."""
    if leg.posture is None:
        return
    if np.max(turned(leg, q, np.asarray(leg.posture))) > FAR:
        raise InputError(
            f"posture is {np.round(leg.posture, 3).tolist()}, but at home leg {number + 1} has joints "
            f"{np.round(q, 3).tolist()} (m, rad), on another assembly branch; give joint values near those "
            f"of the branch that you want, or correct the home pose"
        )


def check_stroke(leg: Leg, number: int, q: Array) -> None:
    """Raise InputError where a leg, with joints q (n,) at home, is beyond the stroke of its motor."""
    for joint, value in zip(leg.joints, q, strict=True):
        if joint.mu and not joint.q_min <= value <= joint.q_max:
            low, at, high = (joint_value(joint, x) for x in (joint.q_min, value, joint.q_max))
            raise InputError(
                f"stroke is {low} … {high}, but at home leg {number + 1} is at {at}; give limits on both "
                f"sides of that, or another home"
            )


def check_mobility(robot: Robot, expected: int | None) -> None:
    """Raise InputError where the robot at home has not the freedoms or the actuators that it needs."""
    found = Model(robot, "numpy").mobility(robot.home)
    if expected is not None and found.freedoms != expected:
        raise InputError(
            f"you expect {expected}, but the legs leave the platform {found.freedoms} freedoms at home; "
            f"correct the axes of the legs' joints, or the number"
        )
    if found.freedoms > found.actuators:
        raise InputError(
            f"the legs leave the platform {found.freedoms} freedoms at home, but only {found.actuators} "
            f"joints are actuated; set actuated = true on {found.freedoms - found.actuators} more"
        )
