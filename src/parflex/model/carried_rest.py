"""Equilibria on a base that accelerates steadily: seen from the base gravity is g − a, and all is at rest."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array, join, mtv, mv
from parflex.base.check import all_of_type, finite, of_type, rotation_matrix
from parflex.base.errors import InputError
from parflex.model.core import Core
from parflex.model.inputs import Values, Wrenches
from parflex.model.rest import equilibrium_of
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

    Without a motion the base is the world. Raises InputError for a batch, and for a base that turns.
    """
    if motion is None:
        return equilibrium_of(core, position, rotation, forces, guess, wrenches, parameters)
    flat = of_type("base", motion, BaseMotion).flat
    check_steady(motion, flat)
    base = base_of(flat)
    if position is not None:
        position = mtv(base.rotation, finite("position", position, (3,)) - base.position)
    if rotation is not None:
        rotation = base.rotation.T @ rotation_matrix("rotation", rotation)
    guess = None if guess is None else seen(base, of_type("guess", guess, State))
    pushes = turned(base, wrenches)
    found, held = equilibrium_of(
        core.weighed(base.acceleration, base.rotation), position, rotation, forces, guess, pushes, parameters
    )
    return carried(base, found), held


def from_base(core: Core, motion: BaseMotion, state: State, wrenches: Any) -> tuple[Core, State, Any]:
    """The core, a state that goes with a base, and wrenches, as they are seen from it, at rest.

    Raises InputError for a base that is a batch or turns, and a state that does not go with it.
    """
    flat = of_type("base", motion, BaseMotion).flat
    check_steady(motion, flat)
    base, state = base_of(flat), of_type("state", state, State)
    found = seen(base, state)
    apart = float(np.max(np.abs(state.twist - carried(base, found).twist)))
    if apart > GOES * (1.0 + float(np.max(np.abs(base.velocity)))):
        raise InputError(
            f"state moves relative to base, by {apart:.3g} m/s or rad/s; take both from "
            f"model.equilibrium(…, base=…)"
        )
    return core.weighed(base.acceleration, base.rotation), found, turned(base, wrenches)


def check_steady(motion: BaseMotion, flat: Array) -> None:
    """Raise InputError where the base is a batch, or turns."""
    if flat.ndim > 1:
        raise InputError(f"base is a batch {flat.shape[:-1]}; equilibrium takes a single one")
    for name in ("twist", "acceleration"):
        turning = np.asarray(getattr(motion, name))[3:]
        if np.any(turning):
            raise InputError(
                f"base turns, BaseMotion.{name}[3:] is {turning.tolist()}; nothing is at rest on it: give a "
                f"base that does not turn, or simulate"
            )


def turned(base: Base, wrenches: Any) -> Sequence[Wrench]:
    """The wrenches, those in world axes resolved in Σ0."""
    return [
        each
        if each.frame != "world"
        else replace(each, force=mtv(base.rotation, each.force), moment=mtv(base.rotation, each.moment))
        for each in all_of_type("wrenches", wrenches, Wrench)
    ]


def seen(base: Base, state: State) -> State:
    """The state at rest as it stands in Σ0."""
    place = mtv(base.rotation, state.position - base.position)
    return replace(state.still, position=place, rotation=base.rotation.T @ state.rotation)


def carried(base: Base, state: State) -> State:
    """The state in the world of one at rest in Σ0."""
    rotation = base.rotation @ state.rotation
    twist = join([mtv(rotation, base.velocity), np.zeros(3)])
    return replace(
        state, position=base.position + mv(base.rotation, state.position), rotation=rotation, twist=twist
    )
