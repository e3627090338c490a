"""A robot from a file at its home pose: whether it stands, moves and is driven as its author expects."""

from dataclasses import replace

import numpy as np

from parflex.analysis.health import OFF
from parflex.base.array import Array
from parflex.base.errors import InputError, NotConverged
from parflex.base.spatial import vector_from_rotation
from parflex.mechanics.flat_state import flat_state, projected, state_of, turned
from parflex.mechanics.mechanism import Mechanism, mechanism_of
from parflex.mechanics.system import examined
from parflex.model.model import Model
from parflex.robot.joint_words import joint_value
from parflex.robot.leg import Leg
from parflex.robot.robot import Robot

ROUNDED = 1e-4  # of the platform's size: a gap that decimals leave
FAR = 1.0  # rad, between a joint at home and in the posture that names its branch


def settled(robot: Robot) -> Robot:
    """The robot with its home on the closure, from which the decimals of its file keep it by a little."""
    if not robot.legs:
        return robot
    mechanism = mechanism_of(robot)
    gap, _ = largest_gap(mechanism)
    if not OFF * min(1.0, mechanism.size) < gap < ROUNDED * mechanism.size:
        return robot
    try:
        found = state_of(mechanism, projected(mechanism, robot.home))
    except NotConverged:
        return robot
    return replace(robot, home_pose=(found.position, found.rotation))


def joints_at_home(robot: Robot) -> tuple[Array, ...]:
    """Joint positions (n_i,) of each leg; raises InputError where one does not reach the platform."""
    model = Model(robot, "numpy")
    mechanism = mechanism_of(robot)
    gap, leg = largest_gap(mechanism)
    if OFF * min(1.0, mechanism.size) < gap < np.inf:
        raise InputError(
            f"at home a gap of {1000 * gap:.3g} mm remains between leg {leg + 1} and its attachment, since "
            f"the legs leave the platform fewer than six freedoms; {nearest_home(mechanism)}"
        )
    return model.joints(robot.home).q


def largest_gap(mechanism: Mechanism) -> tuple[float, int]:
    """The largest distance (m, along an axis) of a tip from its attachment at home, and the leg it is on."""
    at = mechanism.health
    gaps = np.abs(examined(mechanism, flat_state(mechanism, mechanism.robot.home))[1][at.gap])
    if not gaps.size:
        return 0.0, 0
    worst = int(np.argmax(np.nan_to_num(gaps, nan=np.inf)))
    return float(gaps[worst]), int(at.gap_legs[worst])


def nearest_home(mechanism: Mechanism) -> str:
    """A remedy for a home that the legs do not allow."""
    try:
        found = state_of(mechanism, projected(mechanism, mechanism.robot.home))
    except NotConverged:
        return "correct the places of the legs and of the attachments, or move home"
    turned_by = vector_from_rotation(np.asarray(found.rotation))
    place, turn = (np.round(v, 9).tolist() for v in (found.position, turned_by))
    return f"correct the legs, or give the nearest home, position = {place}, rotation = {turn}"


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
