"""The linear system of a robot, asked for by state, forces, inputs and outputs."""

from collections.abc import Sequence
from typing import Any

from numpy.typing import ArrayLike

from parflex.analysis import health
from parflex.base.check import all_of_type
from parflex.base.errors import InputError
from parflex.linear.closed import feedback_of
from parflex.linear.point import point_at
from parflex.linear.signal import Input, Output
from parflex.linear.system import LinearModel, linear_model
from parflex.model import inputs as checked
from parflex.model.carried_rest import from_base
from parflex.model.core import Core
from parflex.model.inputs import Values, Wrenches
from parflex.robot.base_motion import BaseMotion
from parflex.robot.state import State

LOCKED = "locked"


def linearise(
    core: Core,
    state: State,
    forces: ArrayLike,
    inputs: Sequence[Input],
    outputs: Sequence[Output],
    wrenches: Wrenches,
    friction: str,
    controller: Any,
    base: BaseMotion | None,
    parameters: Values,
) -> LinearModel:
    """The system; see `Model.linearise`."""
    if parameters is not None:
        core = core.at(checked.single_values(checked.theta(core, parameters)))
    if base is not None:
        core, state, wrenches = from_base(core, base, state, wrenches)
    all_of_type("inputs", inputs, Input)
    all_of_type("outputs", outputs, Output)
    x = health.single("state", core.flat(state))
    core.system(state)
    given = checked.forces(core, forces)
    if given.ndim > 1:
        raise InputError(f"forces are a batch {given.shape[:-1]}; linearise takes single ones")
    checked.load(core, state, wrenches)
    locked = isinstance(controller, str) and controller == LOCKED
    point = point_at(core.readable.solvable, x, given, wrenches, friction, locked)
    feedback = None if controller is None or locked else feedback_of(point, controller)
    return linear_model(point, inputs, outputs, feedback)
