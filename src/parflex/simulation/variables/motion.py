"""The state, the forces and the accelerations over time."""

from parflex.mechanics.ordering import by_attachment
from parflex.robot.joint_words import actuator_units
from parflex.simulation.variables.variable import Variable

TWIST_UNITS = "m s-1, rad s-1"
ACCELERATION_UNITS = "m s-2, rad s-2"

MOTION_VARIABLES = (
    Variable(
        "position",
        ("time", "axis"),
        "m",
        "position of the platform frame in the world",
        lambda run: run.state.position,
        missed="where the platform is",
        pictured=True,
    ),
    Variable(
        "rotation",
        ("time", "axis", "platform_axis"),
        "1",
        "rotation matrix, platform axes to world axes",
        lambda run: run.state.rotation,
        missed="how the platform is turned",
        pictured=True,
    ),
    Variable(
        "twist",
        ("time", "component"),
        TWIST_UNITS,
        "velocity and angular velocity of the platform frame, in platform axes",
        lambda run: run.state.twist,
    ),
    Variable(
        "elastic",
        ("time", "mode"),
        "kg0.5 m",
        "elastic coordinates",
        lambda run: run.state.elastic,
        missed="the elastic coordinates",
        pictured=True,
    ),
    Variable(
        "elastic_rate",
        ("time", "mode"),
        "kg0.5 m s-1",
        "elastic rates",
        lambda run: run.state.elastic_rate,
    ),
    Variable(
        "forces",
        ("time", "actuator"),
        actuator_units,
        "actuator forces",
        lambda run: run.replay.forces,
    ),
    Variable(
        "acceleration",
        ("time", "component"),
        ACCELERATION_UNITS,
        "acceleration of the platform frame, resolved in platform axes",
        lambda run: run.acceleration,
    ),
    Variable(
        "elastic_acceleration",
        ("time", "mode"),
        "kg0.5 m s-2",
        "elastic accelerations",
        lambda run: run.elastic_acceleration,
    ),
    Variable(
        "contact_forces",
        ("time", "attachment", "axis"),
        "N",
        "forces of the legs on the platform, in platform axes",
        lambda run: by_attachment(run.mechanism, run.replay.contact),
        missed="the forces at the joints",
    ),
)
