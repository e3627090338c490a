"""The models as functions of flat vectors: what every backend runs.

A state is x (layout.size), forces u (m), external generalised forces w (6 + N). Every kernel that
assembles legs ends with their `health`, from which the doors tell a state that is none.
"""

import numpy as np

from parflex.base.array import Array, merged
from parflex.kernels.kernel import Kernel, sizes
from parflex.mechanics import contact, dynamics
from parflex.mechanics import system as assembly
from parflex.mechanics.output import Output
from parflex.robot.robot import Robot


def direct(robot: Robot) -> Kernel:
    """(x, u, w) -> V̇_p, q̈_e, contact forces by tip, health."""
    n, N, m, k = sizes(robot)

    def function(x: Array, u: Array, w: Array) -> tuple[Array, ...]:
        system = assembly.assembled(robot, x)
        return (*dynamics.direct_of(robot, system, u, w), assembly.health(system))

    return Kernel("direct", function, (n, m, 6 + N), (6, N, k, assembly.health_size(robot)), (robot,))


def inverse(robot: Robot, output: Output) -> Kernel:
    """(x, target, w, preload) -> Γ, V̇_p, q̈_e, contact forces by tip, gain (by rows), health."""
    n, N, m, k = sizes(robot)

    def function(x: Array, target: Array, w: Array, preload: Array) -> tuple[Array, ...]:
        system = assembly.assembled(robot, x)
        found = dynamics.inverse_of(robot, system, target, w, output, preload)
        return (found.forces, *found.acceleration, merged(found.gain), assembly.health(system))

    return Kernel(
        "inverse",
        function,
        (n, output.size, 6 + N, m),
        (m, 6, N, k, output.size * m, assembly.health_size(robot)),
        (robot, output),
    )


def gains(robot: Robot, output: Output) -> Kernel:
    """x -> ∂output/∂Γ by rows, as it is and as it were for a platform that does not bend."""
    n, _, m, _ = sizes(robot)

    def function(x: Array) -> tuple[Array, ...]:
        flexible, rigid = dynamics.gains(robot, assembly.assembled(robot, x), output)
        return merged(flexible), merged(rigid)

    return Kernel("gains", function, (n,), (output.size * m, output.size * m), (robot, output))


def contact_matrix(robot: Robot) -> Kernel:
    """x -> the contact system's matrix, its independent rows: definite where the legs do not lock."""
    n, N, _, _ = sizes(robot)
    kept = robot.rows.kept

    def function(x: Array) -> tuple[Array, ...]:
        C = contact.contact_system(robot, assembly.assembled(robot, x), np.zeros(6 + N)).C
        return (merged(C[..., kept, :][..., kept]),)

    return Kernel("contact_matrix", function, (n,), (len(kept) ** 2,), (robot,))


def actuators(robot: Robot) -> Kernel:
    """x -> q_a and q̇_a, positions and rates of the actuated joints."""
    n, _, m, _ = sizes(robot)

    def function(x: Array) -> tuple[Array, ...]:
        system = assembly.assembled(robot, x)
        return assembly.actuated_positions(robot, system), assembly.joint_rates(robot, system)

    return Kernel("actuators", function, (n,), (m, m), (robot,))
