"""The inputs of the models, checked at the door."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import broadcast_together, finite, of_type
from parflex.base.errors import InputError
from parflex.mechanics.output import FrameOutput, Output, PlatformOutput
from parflex.mechanics.wrench import generalised_force, pushes_of
from parflex.model.core import Core
from parflex.robot.base_motion import BaseMotion
from parflex.robot.state import State
from parflex.robot.wrench import Wrench

Values = Mapping[str, ArrayLike] | None
Wrenches = Sequence[Wrench]
Floor = BaseMotion | None  # None: Σ0 is the world's frame


def forces(core: Core, given: ArrayLike) -> Array:
    """Actuator forces (…, m)."""
    return finite("forces", given, (core.mechanism.n_forces,))


def preload(core: Core, given: ArrayLike | None) -> Array:
    """Actuator forces (…, m) that others are to be near to, by default zero."""
    m = core.mechanism.n_forces
    return np.zeros(m) if given is None else finite("preload", given, (m,))


def load(core: Core, state: State, wrenches: Wrenches) -> Array:
    """The generalised force (…, 6 + N) of wrenches on the platform."""
    return generalised_force(core.robot.platform, state, wrenches)


def theta(core: Core, values: Values) -> Array:
    """θ (…, P), by default the model's."""
    own = core.functions.theta
    return own if values is None else core.functions.parameters.vector(values, own)


def single_values(theta: Array) -> Array:
    """θ (P,); raises InputError for a batch."""
    if theta.ndim > 1:
        raise InputError(
            f"parameters are a batch {theta.shape[:-1]}; a model has one value of each: pass batches to "
            f"model.direct or model.inverse"
        )
    return theta


def of_jacobian(
    core: Core, state: State, wrenches: Wrenches, values: Values, **argument: Array
) -> tuple[dict[str, Array], Array]:
    """The inputs of a Jacobian, its wrenches side by side (6 L,), and θ (…, P).

    Raises InputError for a batch of wrenches.
    """
    x, parameters = core.flat(state), theta(core, values)
    load(core, state, wrenches)
    pushes = pushes_of(wrenches)
    if pushes.ndim > 1:
        raise InputError(f"wrenches are a batch {pushes.shape[:-1]}; derivatives take single ones")
    broadcast_together(state=x, **argument, parameters=parameters)
    return {"x": x, "pushes": pushes, **argument}, parameters


def output_of(core: Core, given: Output | None) -> Output:
    """The output, all of V̇_p by default; raises InputError where the robot does not have it."""
    output = FrameOutput() if given is None else given
    of_type("output", output, Output, "an")
    return output.of(core.robot)


def commanded(core: Core, given: Output | None) -> Output:
    """The output; raises InputError where the robot does not have it, or too few actuators drive it."""
    output, m = output_of(core, given), core.mechanism.n_forces
    if m < output.size:
        raise InputError(
            f"output asks for {output.size} accelerations, but the robot has "
            f"{m} actuators; name as many with {type(output).__name__}(rows=…)"
        )
    return output


def square(core: Core, given: Output | None) -> PlatformOutput:
    """The output, as `commanded`; raises InputError where it has not as many rows as there are actuators, or
    is not of the platform."""
    output, m = commanded(core, given), core.mechanism.n_forces
    if not isinstance(output, PlatformOutput):
        raise InputError(
            f"output is a {type(output).__name__}; the derivative is known for accelerations of the "
            f"platform: give a FrameOutput or a PointOutput"
        )
    if output.size != m:
        raise InputError(
            f"output has {output.size} rows and the robot {m} actuators; the derivative is known for "
            f"as many rows as actuators: choose another output"
        )
    return output
