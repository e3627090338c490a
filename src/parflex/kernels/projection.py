"""A state put back on the closure of the legs."""

import numpy as np

from parflex.base.array import Array, dot, join, merged, mv, stack
from parflex.base.spatial import quaternion_rate
from parflex.kernels.kernel import Kernel, Vectors, kernel
from parflex.mechanics import contact, dynamics
from parflex.mechanics import system as assembly
from parflex.mechanics.mechanism import Mechanism


def projection(mechanism: Mechanism) -> Kernel:
    """A state nearer to the closure, in the metric of the robot's mass, and the health of x.

    One step of Newton's method for the gaps, and one for their rates: M⁻¹ Gᵀ C⁻¹ gap.
    """
    none = np.zeros(6 + mechanism.platform.modes)

    def function(x: Array) -> Vectors:
        system = assembly.assembled(mechanism, x)
        held = contact.contact_system(system, none)
        gap = join([np.zeros(0), *(merged(leg.gap) for leg in system.legs)])
        gap_rate = join([np.zeros(0), *(merged(leg.gap_rate) for leg in system.legs)])
        pulls = contact.contact_forces(mechanism, held.C, stack([gap, gap_rate]))
        (pose, bend), c = dynamics.acceleration_map(system, held, pulls), system.x
        s, sd = (assembly.carried_pull(system, pulls[..., i]) for i in (0, 1))
        quaternion = x[..., mechanism.layout.at.quaternion]
        turned = quaternion + quaternion_rate(quaternion, pose[..., 3:, 0])
        turned = turned / np.sqrt(dot(turned, turned))[..., None]
        place = c.position + mv(c.rotation, pose[..., :3, 0])
        rates = [c.elastic_rate + bend[..., 1], c.s - s, c.sd - sd]
        moved = [place, turned, c.twist + pose[..., 1], c.elastic + bend[..., 0], *rates, c.branches]
        return {"projected": join(moved), "health": assembly.health(system)}

    return kernel("projection", function, mechanism, ("projected", "health"), projected=mechanism.layout.size)
