"""The unrest of a robot that stands still: the accelerations of all that its state holds."""

from parflex.base.array import Array, join
from parflex.kernels.jacobians import Places, load_of
from parflex.kernels.kernel import Kernel, Vectors, kernel
from parflex.mechanics import dynamics
from parflex.mechanics import system as assembly
from parflex.mechanics.mechanism import Mechanism


def unrest(mechanism: Mechanism, places: Places) -> Kernel:
    """(V̇_p, q̈_e, s̈) under forces, a generalised force and pushes at places of the platform."""

    def function(x: Array, forces: Array, load: Array, pushes: Array) -> Vectors:
        system = assembly.assembled(mechanism, x)
        found = dynamics.direct_of(system, forces, load_of(mechanism, places, load, pushes)(system.x))
        carried = assembly.carried_accelerations(system, forces, found.contact)
        return {
            "accelerations": join([found.platform, found.elastic, carried]),
            "health": assembly.health(system),
        }

    sizes = {"pushes": 6 * len(places)}
    sizes["accelerations"] = 6 + mechanism.platform.modes + mechanism.layout.carried
    return kernel("unrest", function, mechanism, ("accelerations", "health"), (places,), **sizes)
