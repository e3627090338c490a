"""Derivatives of the models as functions of flat vectors; matrices by rows.

Small motions of the state are those of `tangent.py`, 12 + 2 N + 2 n of them; pushes are wrenches (F, N)
at places of the platform, side by side.
"""

from collections.abc import Callable
from functools import partial

from parflex.base.array import Array, merged
from parflex.kernels.kernel import Kernel, sizes
from parflex.kernels.parametrised import for_any
from parflex.mechanics import system as assembly
from parflex.mechanics.derivatives import sensitivity
from parflex.mechanics.designs import placed
from parflex.mechanics.output import Output
from parflex.mechanics.wrench import Place, pushed
from parflex.robot.layout import Coordinates
from parflex.robot.parameters import Parameters
from parflex.robot.robot import Robot

Places = tuple[Place, ...]


def direct_jacobian(robot: Robot, places: Places) -> Kernel:
    """(x, u, w, pushes) -> ∂(V̇_p, q̈_e) by state, forces and generalised force; health."""
    n, N, m, _ = sizes(robot)
    rows = 6 + N

    def function(x: Array, u: Array, w: Array, pushes: Array) -> tuple[Array, ...]:
        system = assembly.assembled(robot, x)
        found = sensitivity.direct_sensitivity(robot, system, u, load_of(robot, places, w, pushes))
        return (*(merged(part) for part in found), assembly.health(system))

    outputs = (rows * (n - 1), rows * m, rows * rows, assembly.health_size(robot))
    return Kernel("direct_jacobian", function, (n, m, rows, 6 * len(places)), outputs, (robot, places))


def inverse_jacobian(robot: Robot, output: Output, places: Places) -> Kernel:
    """(x, target, w, pushes) -> ∂Γ by state and target; health. For as many outputs as actuators."""
    n, N, m, _ = sizes(robot)

    def function(x: Array, target: Array, w: Array, pushes: Array) -> tuple[Array, ...]:
        system = assembly.assembled(robot, x)
        load = load_of(robot, places, w, pushes)
        found = sensitivity.inverse_sensitivity(robot, system, target, load, output)
        return (*(merged(part) for part in found), assembly.health(system))

    inputs, outputs = (n, m, 6 + N, 6 * len(places)), (m * (n - 1), m * m, assembly.health_size(robot))
    return Kernel("inverse_jacobian", function, inputs, outputs, (robot, output, places))


def parameter_jacobian(parameters: Parameters, places: Places) -> Kernel:
    """(x, u, w, pushes, θ) -> ∂(V̇_p, q̈_e)/∂θ; health."""
    first = parameters.first
    n, N, m, _ = sizes(first)
    rows = 6 + N

    def at(theta: Array) -> Callable[..., tuple[Array, ...]]:
        robot = placed(parameters, theta)

        def function(x: Array, u: Array, w: Array, pushes: Array) -> tuple[Array, ...]:
            system = assembly.assembled(robot, x)
            load = load_of(robot, places, w, pushes)
            found = sensitivity.parameter_sensitivity(partial(placed, parameters), theta, system, u, load)
            return merged(found), assembly.health(system)

        return function

    inputs, outputs = (n, m, rows, 6 * len(places)), (rows * parameters.size, assembly.health_size(first))
    plain = Kernel("parameter_jacobian", at(parameters.own), inputs, outputs, (first, places))
    return for_any(parameters, plain, at)


def load_of(robot: Robot, places: Places, w: Array, pushes: Array) -> Callable[[Coordinates], Array]:
    """The generalised force as a function of the state."""
    return lambda c: w + pushed(robot.platform, places, pushes, c.rotation, c.elastic)
