"""The base, of a run in which it moves, and the platform as it is seen from there."""

from collections.abc import Callable

from parflex.base.array import Array, join
from parflex.robot.carrying import Base
from parflex.robot.layout import Coordinates
from parflex.simulation.variables.motion import ACCELERATION_UNITS, TWIST_UNITS
from parflex.simulation.variables.recorded import Recorded
from parflex.simulation.variables.variable import Variable


def of_base(values: Callable[[Base], Array]) -> Callable[[Recorded], Array | None]:
    """The function of a run that gives a function of the base's motion, where it moves."""
    return lambda run: None if run.base is None else values(run.base)


def of_seen(values: Callable[[Coordinates], Array]) -> Callable[[Recorded], Array | None]:
    """The function of a run that gives a function of the states seen from a base that moves."""
    return lambda run: None if run.relative is None else values(run.relative)


BASE_VARIABLES = (
    Variable(
        "base_position",
        ("time", "axis"),
        "m",
        "position of the base, Σ0, in the world",
        of_base(lambda base: base.position),
    ),
    Variable(
        "base_rotation",
        ("time", "axis", "base_axis"),
        "1",
        "rotation matrix, base axes to world axes",
        of_base(lambda base: base.rotation),
    ),
    Variable(
        "base_twist",
        ("time", "component"),
        TWIST_UNITS,
        "velocity and angular velocity of the base, in world axes",
        of_base(lambda base: join([base.velocity, base.omega])),
    ),
    Variable(
        "base_acceleration",
        ("time", "component"),
        ACCELERATION_UNITS,
        "acceleration of the base, in world axes",
        of_base(lambda base: join([base.acceleration, base.omegad])),
    ),
    Variable(
        "relative_position",
        ("time", "axis"),
        "m",
        "position of the platform frame seen from the base, in base axes",
        of_seen(lambda state: state.position),
    ),
    Variable(
        "relative_rotation",
        ("time", "base_axis", "platform_axis"),
        "1",
        "rotation matrix, platform axes to base axes",
        of_seen(lambda state: state.rotation),
    ),
    Variable(
        "relative_twist",
        ("time", "component"),
        TWIST_UNITS,
        "velocity and angular velocity of the platform frame to the base, in platform axes",
        of_seen(lambda state: state.twist),
    ),
)
