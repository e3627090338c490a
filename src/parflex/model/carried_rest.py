"""Equilibria on a base that accelerates steadily: seen from the base gravity is g − a, and all is at rest."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array, join, merged, mtv, mv, transpose
from parflex.base.check import all_of_type, broadcast_together, finite, index_of, of_type, rotation_matrix
from parflex.base.errors import InputError
from parflex.mechanics.wrench import pushes_of
from parflex.model.core import Core
from parflex.model.inputs import Values, Wrenches
from parflex.model.rest import Seat, equilibrium_of
from parflex.robot.base_motion import BaseMotion
from parflex.robot.carrying import Base, base_of
from parflex.robot.state import State
from parflex.robot.wrench import Wrench

GOES = 1e-9  # m/s, rad/s: relative rates that are round-off


def carried_equilibrium(
    core: Core,
    motion: BaseMotion | None,
    position: ArrayLike | None,
    rotation: ArrayLike | None,
    forces: ArrayLike | None,
    guess: State | None,
    wrenches: Wrenches,
    parameters: Values,
) -> tuple[State, Array]:
    """The state in the world that goes with the base, and the forces (m,); see `Model.equilibrium`.

    Without a motion the base is the world. Raises InputError for a base that turns.
    """
    if motion is None:
        return equilibrium_of(core, position, rotation, forces, guess, wrenches, parameters)
    flat = of_type("base", motion, BaseMotion).flat
    check_steady(motion)
    base = base_of(flat)
    if position is not None:
        place = finite("position", position, (3,))
        broadcast_together(position=place, base=flat)
        position = mtv(base.rotation, place - base.position)
    if rotation is not None:
        turn = rotation_matrix("rotation", rotation)
        broadcast_together(rotation=merged(turn), base=flat)
        rotation = transpose(base.rotation) @ turn
    if guess is not None:
        broadcast_together(guess=np.zeros((*of_type("guess", guess, State).batch, 1)), base=flat)
        guess = seen(base, guess)
    pushes = turned(base, wrenches)
    seat = Seat(base.acceleration, base.rotation)
    found, held = equilibrium_of(core, position, rotation, forces, guess, pushes, parameters, seat)
    return carried(base, found), held


def from_base(core: Core, motion: BaseMotion, state: State, wrenches: Any) -> tuple[Core, State, Any]:
    """The core, a state that goes with a base, and wrenches, as they are seen from it, at rest.

    Raises InputError for a base that is a batch or turns, and a state that does not go with it.
    """
    flat = of_type("base", motion, BaseMotion).flat
    if flat.ndim > 1:
        raise InputError(f"base is a batch {flat.shape[:-1]}; give one at a time")
    check_steady(motion)
    base, state = base_of(flat), of_type("state", state, State)
    found = seen(base, state)
    apart = float(np.max(np.abs(state.twist - carried(base, found).twist)))
    if apart > GOES * (1.0 + float(np.max(np.abs(base.velocity)))):
        raise InputError(
            f"state moves relative to base, by {apart:.3g} m/s or rad/s; take both from "
            f"model.equilibrium(…, base=…)"
        )
    return core.weighed(base.acceleration, base.rotation), found, turned(base, wrenches)


def check_steady(motion: BaseMotion) -> None:
    """Raise InputError where the base turns."""
    for name in ("twist", "acceleration"):
        turning = np.asarray(getattr(motion, name))[..., 3:]
        bad = np.any(turning != 0, axis=-1)
        if np.any(bad):
            raise InputError(
                f"base{index_of(bad)} turns, BaseMotion.{name}[3:] is {turning[bad][0].tolist()}; nothing is "
                f"at rest on it: give a base that does not turn, or simulate"
            )


def turned(base: Base, wrenches: Any) -> Sequence[Wrench]:
    """The wrenches, those in world axes resolved in Σ0."""
    broadcast_together(wrenches=pushes_of(all_of_type("wrenches", wrenches, Wrench)), base=base.position)
    return [
        each
        if each.frame != "world"
        else replace(each, force=mtv(base.rotation, each.force), moment=mtv(base.rotation, each.moment))
        for each in all_of_type("wrenches", wrenches, Wrench)
    ]


def seen(base: Base, state: State) -> State:
    """The state at rest as it stands in Σ0."""
    place = mtv(base.rotation, state.position - base.position)
    return replace(state.still, position=place, rotation=transpose(base.rotation) @ state.rotation)


def carried(base: Base, state: State) -> State:
    """The state in the world of one at rest in Σ0."""
    rotation = base.rotation @ state.rotation
    v_p = mtv(rotation, base.velocity)
    twist = join([v_p, np.zeros(3)])
    return replace(
        state, position=base.position + mv(base.rotation, state.position), rotation=rotation, twist=twist
    )
