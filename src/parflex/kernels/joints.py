"""The joints of the legs at a state, and of the actuated ones along a trajectory, as kernels."""

from dataclasses import replace

from parflex.base.array import Array, join
from parflex.kernels.kernel import Kernel, Vectors, kernel
from parflex.kernels.segment import SEGMENT, Sample, along, resting
from parflex.mechanics import system as assembly
from parflex.mechanics.imposed import imposed_accelerations
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.ordering import joints_of
from parflex.robot.layout import Coordinates, coordinates


def joints(mechanism: Mechanism) -> Kernel:
    """Positions and rates of all joints, leg by leg."""

    def function(x: Array) -> Vectors:
        system = assembly.assembled(mechanism, x)
        found = joints_of(system)
        return {"q": join(found.q), "qd": join(found.qd), "health": assembly.health(system)}

    count = sum(len(leg.joints) for leg in mechanism.robot.legs)
    return kernel("joints", function, mechanism, ("q", "qd", "health"), q=count, qd=count)


def leg_motion(mechanism: Mechanism) -> Kernel:
    """Positions, rates and accelerations of the actuated joints in the wanted motion.

    Of the state it reads what the motion leaves open: the bend, which is at rest, joints that are carried,
    and branches.
    """

    def function(x: Array, time: Array, row: Array) -> Vectors:
        wanted = along(row, time[..., 0])
        system = following(mechanism, coordinates(x, mechanism.layout), wanted)
        found = imposed_accelerations(system, wanted.acceleration, 0.0 * system.x.elastic)
        return {
            "positions": assembly.actuated_positions(system),
            "rates": assembly.joint_rates(system),
            "accelerations": assembly.actuated(system, found),
            "health": assembly.health(system),
        }

    outputs = ("positions", "rates", "accelerations", "health")
    home = mechanism.robot.home
    found = kernel("leg_motion", function, mechanism, outputs, row=SEGMENT)
    return replace(found, near={"row": resting(home.position, home.rotation).row})


def following(mechanism: Mechanism, x: Coordinates, wanted: Sample) -> assembly.System:
    """The mechanics in the wanted motion, the platform bent as in the coordinates, and its bend at rest."""
    pose = {"position": wanted.position, "rotation": wanted.rotation, "twist": wanted.twist}
    return assembly.assemble(mechanism, x._replace(**pose, elastic_rate=0.0 * x.elastic))
