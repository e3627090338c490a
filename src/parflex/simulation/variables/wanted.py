"""The trajectory that was to be followed, and the differences from it; none of a run without one."""

from collections.abc import Callable
from typing import Any

import numpy as np

from parflex.base.array import Array, mtv, mv
from parflex.kernels import models
from parflex.kernels.segment import Sample
from parflex.robot.joint_words import actuator_units, position_units
from parflex.robot.layout import pack
from parflex.robot.state import State
from parflex.simulation.laws.joint_pd import joints_ahead
from parflex.simulation.surroundings.imposed import IMPOSED
from parflex.simulation.variables.motion import ACCELERATION_UNITS
from parflex.simulation.variables.recorded import Recorded
from parflex.simulation.variables.variable import Variable

Wanted = Callable[[Recorded, Sample], Array | None]


def of_trajectory(compute: Wanted) -> Callable[[Recorded], Array | None]:
    """The function of a run that gives a function of the wanted motion, where there is one."""

    def of(run: Recorded) -> Array | None:
        return None if run.wanted is None else compute(run, run.wanted)

    return of


def wanted_turn(run: Recorded, wanted: Sample) -> Array:
    """R_pd (T, 3, 3), from the wanted frame to the actual one."""
    return np.swapaxes(run.state.rotation, -1, -2) @ wanted.rotation


def wanted_acceleration(run: Recorded, wanted: Sample) -> Array:
    """(T, 6), turned to the actual platform's axes."""
    R_pd = wanted_turn(run, wanted)
    parts = (wanted.acceleration[:, :3], wanted.acceleration[:, 3:])
    return np.concatenate([mv(R_pd, part) for part in parts], axis=-1)


def pose_error(run: Recorded, wanted: Sample) -> Array:
    """(T, 6) m and a rotation vector."""
    from scipy.spatial.transform import Rotation

    place = mtv(run.state.rotation, wanted.position - run.state.position)
    return np.concatenate([place, Rotation.from_matrix(wanted_turn(run, wanted)).as_rotvec()], axis=-1)


def rigid_forces(run: Recorded, wanted: Sample) -> Array | None:
    """Γ (T, m) that a robot which cannot bend would need; None where the state carries joints.

    Not a number at instants whose pose a leg does not reach.
    """
    layout = run.mechanism.layout
    if any(layout.joints):
        return None
    x = pack(State(wanted.position, wanted.rotation, wanted.twist), layout)
    x[:, layout.at.branches] = run.state.branches
    imposed = run.replay.imposed
    kernel: list[Any] = [*(IMPOSED[name].kernel for name in imposed), models.frozen_inverse]
    with np.errstate(invalid="ignore", divide="ignore"):
        return run.core.readable(*kernel)(x=x, platform=wanted.acceleration, **imposed)["forces"]


def joint_error(run: Recorded) -> Array | None:
    """(T, m); angles within half a turn."""
    if run.wanted_joints is None:
        return None
    return np.asarray(joints_ahead(run.system, run.wanted_joints))


WANTED_VARIABLES = (
    Variable(
        "rigid_forces",
        ("time", "actuator"),
        actuator_units,
        "actuator forces that a platform which cannot bend would need along the trajectory",
        of_trajectory(rigid_forces),
    ),
    Variable(
        "joint_error",
        ("time", "actuator"),
        position_units,
        "desired minus actual position of the actuated joints",
        joint_error,
    ),
    Variable(
        "desired_position",
        ("time", "axis"),
        "m",
        "desired position",
        of_trajectory(lambda run, wanted: wanted.position),
    ),
    Variable(
        "desired_rotation",
        ("time", "axis", "platform_axis"),
        "1",
        "desired rotation",
        of_trajectory(lambda run, wanted: wanted.rotation),
    ),
    Variable(
        "desired_acceleration",
        ("time", "component"),
        ACCELERATION_UNITS,
        "desired acceleration of the platform frame, in platform axes",
        of_trajectory(wanted_acceleration),
    ),
    Variable(
        "acceleration_error",
        ("time", "component"),
        ACCELERATION_UNITS,
        "desired minus calculated acceleration, in platform axes",
        of_trajectory(lambda run, wanted: wanted_acceleration(run, wanted) - run.acceleration),
    ),
    Variable(
        "pose_error",
        ("time", "component"),
        "m, rad",
        "desired minus actual pose, in platform axes",
        of_trajectory(pose_error),
    ),
)
