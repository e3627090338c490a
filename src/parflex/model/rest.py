"""Equilibria, asked for by pose or by forces, one or many."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array, join, merged
from parflex.base.check import broadcast_together, of_type
from parflex.base.errors import InputError
from parflex.mechanics.wrench import pushes_of
from parflex.model import inputs
from parflex.model.core import Core
from parflex.model.inputs import Values, Wrenches
from parflex.model.rows_at_rest import Asked, at_rest_in_rows, flat_rows, raise_first, state_rows
from parflex.robot.state import State


class Seat(NamedTuple):
    """A base that accelerates steadily and does not turn, as equilibria see it."""

    acceleration: Array  # (…, 3) in the world
    rotation: Array  # (…, 3, 3), its axes in the world


def equilibrium_of(
    core: Core,
    position: ArrayLike | None,
    rotation: ArrayLike | None,
    forces: ArrayLike | None,
    guess: State | None,
    wrenches: Wrenches,
    parameters: Values,
    seat: Seat | None = None,
) -> tuple[State, Array]:
    """The states at rest (…) and the forces (…, m); see `Model.equilibrium`."""
    posed = position is not None and rotation is not None
    if posed == (forces is not None) or (position is None) != (rotation is None):
        raise InputError(
            "equilibrium takes a pose, position and rotation, or else forces=…, with a guess= to start from"
        )
    if posed and guess is not None:
        raise InputError("guess is given with a pose; equilibrium reads it with forces=… only: leave it out")
    state = core.robot.home if guess is None else of_type("guess", guess, State).still
    if position is not None and rotation is not None:
        state = State(position, rotation)
    inputs.load(core, state, wrenches)
    given = inputs.forces(core, np.zeros(core.mechanism.n_forces) if forces is None else forces)
    pushes, setting = pushes_of(wrenches), setting_of(core, parameters, seat)
    place = np.zeros((*state.batch, 1))
    parts = {"pose" if posed else "guess": place, "forces": given, "wrenches": pushes}
    broadcast_together(**parts, **{"parameters and base": setting})
    batch = np.broadcast_shapes(*(part.shape[:-1] for part in (place, given, pushes, setting)))
    asked = Asked(
        state_rows(state, batch), flat_rows(given, batch), flat_rows(pushes, batch), wrenches, posed
    )
    x, held = np.zeros((len(asked.forces), core.mechanism.layout.size)), np.array(asked.forces)
    errors: dict[int, InputError] = {}
    for one, which in by_setting(setting, batch):
        found = at_rest_in_rows(set_so(core, one, parameters, seat), asked.part(which))
        x[which], held[which] = found.x, found.forces
        errors |= {int(which[row]): error for row, error in found.errors.items()}
    raise_first(errors, batch)
    return core.state(x.reshape((*batch, x.shape[-1]))), held.reshape((*batch, held.shape[-1]))


def setting_of(core: Core, parameters: Values, seat: Seat | None) -> Array:
    """The values θ and the base side by side (…, P + 12), as far as they are given."""
    theta = inputs.theta(core, parameters)
    return theta if seat is None else join([theta, seat.acceleration, merged(seat.rotation)])


def set_so(core: Core, setting: Array, parameters: Values, seat: Seat | None) -> Core:
    """The core at one setting (P + 12,)."""
    theta = setting[: len(core.functions.theta)]
    core = core if parameters is None else core.at(theta)
    if seat is None:
        return core
    acceleration, rotation = np.split(setting[len(theta) :], [3])
    return core.weighed(acceleration, rotation.reshape(3, 3))


def by_setting(setting: Array, batch: tuple[int, ...]) -> list[tuple[Array, Array]]:
    """Each setting (…, s) that there is, once, and the numbers of the rows of a batch that are at it."""
    if setting.ndim == 1:
        return [(setting, np.arange(int(np.prod(batch, dtype=int))))]
    every, number = np.unique(flat_rows(setting, batch), axis=0, return_inverse=True)
    return [(each, np.flatnonzero(number.reshape(-1) == i)) for i, each in enumerate(every)]
