"""Derivatives of the models as kernels; matrices by rows.

Small motions of the state are those of `Layout.motions`; pushes are wrenches (F, N) at places of the
platform, side by side.
"""

from collections.abc import Callable
from functools import partial

from parflex.base.array import Array, merged
from parflex.kernels.kernel import Kernel, Vectors, kernel
from parflex.kernels.parametrised import for_any
from parflex.mechanics import system as assembly
from parflex.mechanics.derivatives import sensitivity
from parflex.mechanics.designs import placed
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.output import PlatformOutput
from parflex.mechanics.wrench import Place, pushed
from parflex.robot.layout import Coordinates
from parflex.robot.parameters import Parameters

Places = tuple[Place, ...]


BY = ("state", "forces", "load")


def direct_jacobian(mechanism: Mechanism, places: Places) -> Kernel:
    """∂(V̇_p, q̈_e) by state, forces and generalised force, and ∂s̈ of what the state carries of the legs."""
    rows, carried = 6 + mechanism.platform.modes, mechanism.layout.carried

    def function(x: Array, forces: Array, load: Array, pushes: Array) -> Vectors:
        system = assembly.assembled(mechanism, x)
        held = load_of(mechanism, places, load, pushes)
        found = dict(zip(BY, sensitivity.direct_sensitivity(system, forces, held), strict=True))
        of_platform = {f"by_{name}": merged(part[..., :rows, :]) for name, part in found.items()}
        of_legs = {f"carried_by_{name}": merged(part[..., rows:, :]) for name, part in found.items()}
        return of_platform | of_legs | {"health": assembly.health(system)}

    columns = dict(zip(BY, (mechanism.layout.motion_size, mechanism.n_forces, rows), strict=True))
    sizes = {f"by_{name}": rows * count for name, count in columns.items()}
    sizes |= {f"carried_by_{name}": carried * count for name, count in columns.items()}
    outputs, pushes = (*sizes, "health"), 6 * len(places)
    return kernel("direct_jacobian", function, mechanism, outputs, (places,), pushes=pushes, **sizes)


def inverse_jacobian(mechanism: Mechanism, output: PlatformOutput, places: Places) -> Kernel:
    """∂Γ by state and target, for as many outputs as actuators."""

    def function(x: Array, target: Array, load: Array, pushes: Array) -> Vectors:
        system = assembly.assembled(mechanism, x)
        held = load_of(mechanism, places, load, pushes)
        by_state, by_target = sensitivity.inverse_sensitivity(system, target, held, output)
        health = assembly.health(system)
        return {"by_state": merged(by_state), "by_target": merged(by_target), "health": health}

    m, motion = mechanism.n_forces, mechanism.layout.motion_size
    sizes = {"target": m, "pushes": 6 * len(places), "by_state": m * motion, "by_target": m * m}
    outputs = ("by_state", "by_target", "health")
    return kernel("inverse_jacobian", function, mechanism, outputs, (output, places), **sizes)


def parameter_jacobian(mechanism: Mechanism, places: Places, parameters: Parameters) -> Kernel:
    """∂(V̇_p, q̈_e)/∂θ and ∂s̈/∂θ, at any θ."""
    rows, carried = 6 + mechanism.platform.modes, mechanism.layout.carried

    def at(theta: Array) -> Callable[..., Vectors]:
        own = placed(parameters, mechanism, theta)

        def function(x: Array, forces: Array, load: Array, pushes: Array) -> Vectors:
            system = assembly.assembled(own, x)
            held = load_of(own, places, load, pushes)
            place = partial(placed, parameters, mechanism)
            found = sensitivity.parameter_sensitivity(place, theta, system, forces, held)
            by_rows = {"by_parameters": merged(found[..., :rows, :])}
            by_rows["carried_by_parameters"] = merged(found[..., rows:, :])
            return by_rows | {"health": assembly.health(system)}

        return function

    sizes = {"by_parameters": rows * parameters.size, "carried_by_parameters": carried * parameters.size}
    outputs, pushes = (*sizes, "health"), 6 * len(places)
    plain = kernel(
        "parameter_jacobian", at(parameters.own), mechanism, outputs, (places,), pushes=pushes, **sizes
    )
    return for_any(parameters, plain, at)


def load_of(
    mechanism: Mechanism, places: Places, load: Array, pushes: Array
) -> Callable[[Coordinates], Array]:
    """The generalised force as a function of the state."""
    body = mechanism.platform.body
    return lambda c: load + pushed(body, places, pushes, c.rotation, c.elastic)
