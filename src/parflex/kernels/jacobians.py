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


def direct_jacobian(mechanism: Mechanism, places: Places) -> Kernel:
    """∂(V̇_p, q̈_e) by state, forces and generalised force."""

    def function(x: Array, forces: Array, load: Array, pushes: Array) -> Vectors:
        system = assembly.assembled(mechanism, x)
        held = load_of(mechanism, places, load, pushes)
        found = sensitivity.direct_sensitivity(system, forces, held)
        by_rows = zip(("by_state", "by_forces", "by_load"), found, strict=True)
        return {name: merged(part) for name, part in by_rows} | {"health": assembly.health(system)}

    rows, motion = 6 + mechanism.platform.modes, mechanism.layout.motion_size
    sizes = {"by_state": rows * motion, "by_forces": rows * mechanism.n_forces, "by_load": rows * rows}
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
    """∂(V̇_p, q̈_e)/∂θ, at any θ."""

    def at(theta: Array) -> Callable[..., Vectors]:
        own = placed(parameters, mechanism, theta)

        def function(x: Array, forces: Array, load: Array, pushes: Array) -> Vectors:
            system = assembly.assembled(own, x)
            held = load_of(own, places, load, pushes)
            place = partial(placed, parameters, mechanism)
            found = sensitivity.parameter_sensitivity(place, theta, system, forces, held)
            return {"by_parameters": merged(found), "health": assembly.health(system)}

        return function

    size = (6 + mechanism.platform.modes) * parameters.size
    sizes = {"pushes": 6 * len(places), "by_parameters": size}
    outputs = ("by_parameters", "health")
    plain = kernel("parameter_jacobian", at(parameters.own), mechanism, outputs, (places,), **sizes)
    return for_any(parameters, plain, at)


def load_of(
    mechanism: Mechanism, places: Places, load: Array, pushes: Array
) -> Callable[[Coordinates], Array]:
    """The generalised force as a function of the state."""
    body = mechanism.platform.body
    return lambda c: load + pushed(body, places, pushes, c.rotation, c.elastic)
