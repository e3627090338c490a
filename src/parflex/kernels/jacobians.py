"""Derivatives of the models as kernels; matrices by rows.

Small motions of the state are those of `Layout.motions`; pushes are wrenches (F, N) at places of the
platform, side by side.
"""

from collections.abc import Callable
from functools import partial

from parflex.base.array import Array, merged
from parflex.kernels.inputs import plainly
from parflex.kernels.kernel import Kernel, Vectors, kernel
from parflex.kernels.parametrised import for_any
from parflex.mechanics import system as assembly
from parflex.mechanics.derivatives import sensitivity
from parflex.mechanics.designs import placed
from parflex.mechanics.floor import BASE_CHANGES
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.output import PlatformOutput
from parflex.mechanics.wrench import Place, pushed
from parflex.robot.layout import Coordinates
from parflex.robot.parameters import Parameters

Places = tuple[Place, ...]


BY = ("state", "forces", "load", "base")
INVERSE_BY = ("by_state", "by_target", "by_base")


def direct_jacobian(mechanism: Mechanism, places: Places) -> Kernel:
    """∂(V̇_p, q̈_e) by state, forces and generalised force, and ∂s̈ of what the state carries of the legs; by
    the motion of the base where there is one."""
    rows, carried = 6 + mechanism.platform.modes, mechanism.layout.carried

    def function(x: Array, forces: Array, load: Array, pushes: Array) -> Vectors:
        system = assembly.assembled(mechanism, x)
        held = load_of(mechanism, places, load, pushes)
        found = dict(zip(BY, sensitivity.direct_sensitivity(system, forces, held), strict=True))
        of_platform = {f"by_{name}": merged(part[..., :rows, :]) for name, part in found.items()}
        of_legs = {f"carried_by_{name}": merged(part[..., rows:, :]) for name, part in found.items()}
        return of_platform | of_legs | {"health": assembly.health(system)}

    by_base = 0 if mechanism.base is None else BASE_CHANGES
    columns = dict(zip(BY, (mechanism.layout.motion_size, mechanism.n_forces, rows, by_base), strict=True))
    sizes = {f"by_{name}": rows * count for name, count in columns.items()}
    sizes |= {f"carried_by_{name}": carried * count for name, count in columns.items()}
    outputs, pushes = (*sizes, "health"), 6 * len(places)
    return kernel("direct_jacobian", function, mechanism, outputs, (places,), pushes=pushes, **sizes)


def inverse_jacobian(mechanism: Mechanism, output: PlatformOutput, places: Places) -> Kernel:
    """∂Γ by state and target, for as many outputs as actuators."""

    def function(x: Array, target: Array, load: Array, pushes: Array) -> Vectors:
        system = assembly.assembled(mechanism, x)
        held = load_of(mechanism, places, load, pushes)
        found = sensitivity.inverse_sensitivity(system, target, held, output)
        by_rows = dict(zip(INVERSE_BY, map(merged, found), strict=True))
        return by_rows | {"health": assembly.health(system)}

    m, motion = mechanism.n_forces, mechanism.layout.motion_size
    by_base = 0 if mechanism.base is None else BASE_CHANGES
    sizes = {"target": m, "pushes": 6 * len(places)}
    sizes |= dict(zip(INVERSE_BY, (m * motion, m * m, m * by_base), strict=True))
    outputs = (*INVERSE_BY, "health")
    return kernel("inverse_jacobian", function, mechanism, outputs, (output, places), **sizes)


def parameter_jacobian(
    mechanism: Mechanism, places: Places, parameters: Parameters, way: Callable[..., Kernel] = plainly
) -> Kernel:
    """∂(V̇_p, q̈_e)/∂θ and ∂s̈/∂θ, at any θ; the way is that of a kernel with one more input, if any."""

    def at(theta: Array) -> Kernel:
        return way(mechanism, by_parameters, places, parameters, theta)

    return for_any(parameters, at(parameters.own), lambda theta: at(theta).function)


def by_parameters(mechanism: Mechanism, places: Places, parameters: Parameters, theta: Array) -> Kernel:
    """∂(V̇_p, q̈_e)/∂θ and ∂s̈/∂θ at one θ (P,)."""
    rows, carried = 6 + mechanism.platform.modes, mechanism.layout.carried
    own, place = placed(parameters, mechanism, theta), partial(placed, parameters, mechanism)

    def function(x: Array, forces: Array, load: Array, pushes: Array) -> Vectors:
        system, held = assembly.assembled(own, x), load_of(own, places, load, pushes)
        found = sensitivity.parameter_sensitivity(place, theta, system, forces, held)
        by_rows = {"by_parameters": merged(found[..., :rows, :])}
        by_rows["carried_by_parameters"] = merged(found[..., rows:, :])
        return by_rows | {"health": assembly.health(system)}

    sizes = {"by_parameters": rows * parameters.size, "carried_by_parameters": carried * parameters.size}
    outputs, pushes = (*sizes, "health"), 6 * len(places)
    return kernel("parameter_jacobian", function, mechanism, outputs, (places,), pushes=pushes, **sizes)


def load_of(
    mechanism: Mechanism, places: Places, load: Array, pushes: Array
) -> Callable[[Coordinates], Array]:
    """The generalised force as a function of the state."""
    body = mechanism.platform.body
    return lambda c: load + pushed(body, places, pushes, c.rotation, c.elastic)
