"""Equilibria, asked for by pose or by forces."""

import numpy as np
from numpy.typing import ArrayLike

from parflex.analysis.equilibrium import at_rest, under_forces
from parflex.base.array import Array
from parflex.base.check import of_type
from parflex.base.errors import InputError
from parflex.mechanics.wrench import pushes_of
from parflex.model import inputs
from parflex.model.core import Core
from parflex.model.inputs import Values, Wrenches
from parflex.robot.state import State


def equilibrium_of(
    core: Core,
    position: ArrayLike | None,
    rotation: ArrayLike | None,
    forces: ArrayLike | None,
    guess: State | None,
    wrenches: Wrenches,
    parameters: Values,
) -> tuple[State, Array]:
    """The state at rest and the forces (m,); see `Model.equilibrium`."""
    posed = position is not None and rotation is not None
    if posed == (forces is not None) or (position is None) != (rotation is None):
        raise InputError(
            "equilibrium takes a pose, position and rotation, or else forces=…, with a guess= to start from"
        )
    if posed and guess is not None:
        raise InputError("guess is given with a pose; equilibrium reads it with forces=… only: leave it out")
    if parameters is not None:
        core = core.at(inputs.single_values(inputs.theta(core, parameters)))
    state = core.robot.home if guess is None else of_type("guess", guess, State)
    if position is not None and rotation is not None:
        state = State(position, rotation)
    inputs.load(core, state, wrenches)
    if pushes_of(wrenches).ndim > 1:
        raise InputError(
            f"wrenches are a batch {pushes_of(wrenches).shape[:-1]}; equilibrium takes single ones"
        )
    if posed:
        x, held = at_rest(core.functions, "position and rotation", state, wrenches)
    else:
        given = inputs.forces(core, np.zeros(0) if forces is None else forces)
        if given.ndim > 1:
            raise InputError(f"forces are a batch {given.shape[:-1]}; equilibrium takes single ones")
        x, held = under_forces(core.functions, given, state, wrenches)
    return core.state(x), held
