"""Derivatives of the models, asked for by state, forces and loads."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from parflex.analysis import health
from parflex.analysis.posed import check_reached
from parflex.base.array import Array
from parflex.base.check import finite
from parflex.kernels import jacobians
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.ordering import by_rows
from parflex.mechanics.output import Output
from parflex.mechanics.wrench import places_of
from parflex.model import inputs
from parflex.model.core import Core
from parflex.model.inputs import Values, Wrenches
from parflex.model.results import DirectJacobian, InverseJacobian
from parflex.robot.state import State


def direct_jacobian_of(
    core: Core, state: State, forces: ArrayLike, wrenches: Wrenches, parameters: Values
) -> DirectJacobian:
    """The derivatives of the direct model; see `Model.direct_jacobian`."""
    functions, places, u = core.functions, places_of(wrenches), inputs.forces(core, forces)
    given, theta = inputs.of_jacobian(core, state, wrenches, parameters, forces=u)
    found = functions(jacobians.direct_jacobian, places, theta=theta)(**given)
    core.check(given["x"], found.pop("health"))
    health.check_finite(found["by_state"])
    if functions.parameters.items:
        build = jacobians.parameter_jacobian
        found |= functions(build, places, functions.parameters, functions.way, theta=theta)(**given)
    return by_fields(core.mechanism, found)


def by_fields(mechanism: Mechanism, found: Mapping[str, Array]) -> DirectJacobian:
    """The derivatives of what `kernels.jacobians` gives by rows; without parameters (…, 0) by them."""
    rows = {"by": 6 + mechanism.platform.modes, "carried_by": mechanism.layout.carried}
    columns = {"state": mechanism.layout.motion_size, "forces": mechanism.n_forces, "load": rows["by"]}
    for name in ("parameters", "base"):
        columns[name] = found.get(f"by_{name}", np.zeros(0)).shape[-1] // rows["by"]
    batch = found["by_state"].shape[:-1]
    none = np.zeros((*batch, 0))
    parts = {
        (kind, name): found.get(f"{kind}_{name}", none).reshape((*batch, r, c))
        for kind, r in rows.items()
        for name, c in columns.items()
    }
    of_platform = {name: part for (kind, name), part in parts.items() if kind == "by"}
    of_legs = {f"carried_{name}": part for (kind, name), part in parts.items() if kind != "by"}
    return DirectJacobian(**of_platform, carried=of_legs.pop("carried_state"), **of_legs)


def inverse_jacobian_of(
    core: Core,
    state: State,
    target: ArrayLike,
    output: Output | None,
    wrenches: Wrenches,
    parameters: Values,
) -> InverseJacobian:
    """The derivatives of the inverse model; see `Model.inverse_jacobian`."""
    output, m = inputs.square(core, output), core.mechanism.n_forces
    wanted = finite("target", target, (m,))
    given, theta = inputs.of_jacobian(core, state, wrenches, parameters, target=wanted)
    check_reached(core.readable, output, given["x"])
    found = core.functions(jacobians.inverse_jacobian, output, places_of(wrenches), theta=theta)(**given)
    core.check(given["x"], found["health"])
    health.check_finite(found["by_state"])
    return InverseJacobian(*(by_rows(found[name], m) for name in jacobians.INVERSE_BY))
