"""A state put back on the closure of the legs."""

import numpy as np

from parflex.base.array import Array, dot, join, merged, mv, stack
from parflex.base.spatial import quaternion_rate
from parflex.kernels.kernel import Kernel, sizes
from parflex.mechanics import contact, dynamics
from parflex.mechanics import system as assembly
from parflex.robot.robot import Robot


def projection(robot: Robot) -> Kernel:
    """x -> x nearer to the closure, in the metric of the robot's mass, and the health of x.

    One step of Newton's method for the gaps, and one for their rates: M⁻¹ Gᵀ C⁻¹ gap.
    """
    n, N, _, _ = sizes(robot)

    def function(x: Array) -> tuple[Array, ...]:
        system = assembly.assembled(robot, x)
        held = contact.contact_system(robot, system, np.zeros(6 + N))
        gap = join([np.zeros(0), *(merged(leg.gap) for leg in system.legs)])
        gap_rate = join([np.zeros(0), *(merged(leg.gap_rate) for leg in system.legs)])
        pulls = contact.contact_forces(robot, held.C, stack([gap, gap_rate]))
        (pose, bend), c = dynamics.acceleration_map(robot.platform, system, held, pulls), system.x
        q, qd = (assembly.carried_pull(robot, system, pulls[..., i]) for i in (0, 1))
        turned = x[..., 3:7] + quaternion_rate(x[..., 3:7], pose[..., 3:, 0])
        turned = turned / np.sqrt(dot(turned, turned))[..., None]
        place = c.position + mv(c.rotation, pose[..., :3, 0])
        rates = [c.elastic_rate + bend[..., 1], c.q - q, c.qd - qd]
        moved = [place, turned, c.twist + pose[..., 1], c.elastic + bend[..., 0], *rates]
        return join(moved), assembly.health(system)

    return Kernel("projection", function, (n,), (n, assembly.health_size(robot)), (robot,))
