"""The trajectory that was to be followed, and the differences from it; none of a run without one."""

from collections.abc import Callable

import numpy as np

from parflex.base.array import Array, mtv, mv
from parflex.kernels.segment import Sample
from parflex.simulation.variables.motion import ACCELERATION_UNITS
from parflex.simulation.variables.recorded import Recorded
from parflex.simulation.variables.variable import Variable

Wanted = Callable[[Recorded, Sample], Array]


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


WANTED_VARIABLES = (
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
