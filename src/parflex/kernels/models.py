"""The models as kernels.

The direct and the inverse model give the legs' `health` too, by which the doors refuse states that are
none of the robot's. Gains, contact matrix and actuated joints give none: who asks for them has checked.
"""

from collections.abc import Callable

import numpy as np

from parflex.base.array import Array, merged
from parflex.kernels.kernel import Kernel, Vectors, kernel
from parflex.mechanics import contact, dynamics
from parflex.mechanics import system as assembly
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.output import Output, check_at_once
from parflex.mechanics.stiffening import stiffened, unbalanced

Restricted = Callable[[assembly.System], assembly.System]


def direct(mechanism: Mechanism) -> Kernel:
    """The direct dynamic model."""

    def function(x: Array, forces: Array, load: Array) -> Vectors:
        system = assembly.assembled(mechanism, x)
        return moved(system, dynamics.direct_of(system, forces, load))

    return kernel("direct", function, mechanism, ANSWER)


ANSWER = ("platform", "elastic", "contact", "health")


def moved(system: assembly.System, found: dynamics.Acceleration) -> Vectors:
    """Accelerations and contact forces, these in the order of the legs, and the legs' health."""
    contact = assembly.tip_forces(system, found.contact)[..., system.mechanism.contact_order]
    return {
        "platform": found.platform,
        "elastic": found.elastic,
        "contact": contact,
        "health": assembly.health(system),
    }


def inverse(mechanism: Mechanism, output: Output) -> Kernel:
    """The inverse dynamic model, with its gain ∂output/∂Γ by rows; raises InputError as `check_at_once`."""
    check_at_once(mechanism, output)

    def function(x: Array, target: Array, load: Array, preload: Array) -> Vectors:
        system = assembly.assembled(mechanism, x)
        found = dynamics.inverse_of(system, target, load, output, preload)
        answer = moved(system, found.acceleration)
        return {"forces": found.forces, **answer, "gain": merged(found.gain)}

    outputs = ("forces", *ANSWER[:-1], "gain", "health")
    size = output.size
    sizes = {"target": size, "gain": size * mechanism.n_forces}
    return kernel("inverse", function, mechanism, outputs, (output,), **sizes)


def static_inverse(mechanism: Mechanism, output: Output) -> Kernel:
    """The inverse model of legs that do not accelerate in their bend, and by how much that is to change, as
    `stiffening.unbalanced`."""

    def function(x: Array, target: Array, load: Array, preload: Array) -> Vectors:
        system = assembly.assembled(mechanism, x)
        found = dynamics.inverse_of(stiffened(system), target, load, output, preload)
        excess = unbalanced(system, found.forces, found.acceleration.contact)
        answer = moved(system, found.acceleration)
        return {"forces": found.forces, **answer, "gain": merged(found.gain), "excess": excess}

    sizes = {"target": output.size, "gain": output.size * mechanism.n_forces}
    sizes |= {"excess": mechanism.layout.carried}
    outputs = ("forces", *ANSWER, "gain", "excess")
    return kernel("static_inverse", function, mechanism, outputs, (output,), **sizes)


def gains(mechanism: Mechanism, output: Output) -> Kernel:
    """∂output/∂Γ by rows, as it is and as it were if neither platform nor legs could bend."""
    return both_gains("gains", mechanism, output, lambda system: system)


def platform_gains(mechanism: Mechanism, output: Output) -> Kernel:
    """∂output/∂Γ by rows for legs that do not bend, and for a platform that does not either."""
    return both_gains("platform_gains", mechanism, output, stiffened)


def both_gains(name: str, mechanism: Mechanism, output: Output, of: Restricted) -> Kernel:
    """∂output/∂Γ by rows of a robot some parts of which do not bend, and as it were if none could."""

    def function(x: Array) -> Vectors:
        flexible, rigid = dynamics.gains(of(assembly.assembled(mechanism, x)), output)
        return {"flexible": merged(flexible), "rigid": merged(rigid)}

    size = output.size * mechanism.n_forces
    outputs = ("flexible", "rigid")
    return kernel(name, function, mechanism, outputs, (output,), flexible=size, rigid=size)


def frozen_inverse(mechanism: Mechanism) -> Kernel:
    """Γ for a wanted V̇_p of platform and legs frozen in their bend."""

    def function(x: Array, platform: Array) -> Vectors:
        return {"forces": dynamics.frozen_inverse(assembly.assembled(mechanism, x), platform)[0]}

    return kernel("frozen_inverse", function, mechanism, ("forces",))


def contact_matrix(mechanism: Mechanism) -> Kernel:
    """The contact system's matrix, its independent rows: definite where the legs do not lock."""
    kept = mechanism.solved_rows.kept

    def function(x: Array) -> Vectors:
        none = np.zeros(6 + mechanism.platform.modes)
        C = contact.contact_system(assembly.assembled(mechanism, x), none).C
        return {"matrix": merged(C[..., kept, :][..., kept])}

    return kernel("contact_matrix", function, mechanism, ("matrix",), matrix=len(kept) ** 2)


def actuators(mechanism: Mechanism) -> Kernel:
    """Positions and rates of the actuated joints."""

    def function(x: Array) -> Vectors:
        system = assembly.assembled(mechanism, x)
        return {"positions": assembly.actuated_positions(system), "rates": assembly.joint_rates(system)}

    return kernel("actuators", function, mechanism, ("positions", "rates"))
