"""External wrenches on platform nodes, as generalised forces W_a (F, N)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, join, mtv, mv
from parflex.base.check import all_of_type, of_type
from parflex.base.errors import InputError
from parflex.mechanics.kinematics import node_wrench_map
from parflex.robot.body import FlexibleBody
from parflex.robot.layout import elastic_vector
from parflex.robot.state import State
from parflex.robot.wrench import Wrench


class Place(NamedTuple):
    """The place of a wrench, and the axes in which it is given."""

    node: int
    in_world: bool


def pushed(body: FlexibleBody, places: Sequence[Place], pushes: Array, rotation: Array, q_e: Array) -> Array:
    """Σ W_a (F, N): (…, 6 + N), in Σp, of wrenches (F, N) side by side in pushes (…, 6 L)."""
    total = np.zeros(6 + body.modes)
    for i, place in enumerate(places):
        parts = [pushes[..., 6 * i : 6 * i + 3], pushes[..., 6 * i + 3 : 6 * i + 6]]
        if place.in_world:
            parts = [mtv(rotation, part) for part in parts]
        total = total + mv(node_wrench_map(body, place.node, q_e), join(parts))
    return total


def generalised_force(body: FlexibleBody, state: State, wrenches: Sequence[Wrench]) -> Array:
    """Σ W_a (F, N): (…, 6 + N), in Σp.

    Raises InputError for an unknown node, and for a moment on a body without rotation shapes.
    """
    of_type("state", state, State)
    q_e = elastic_vector("elastic", state.elastic, body.modes)
    if not all_of_type("wrenches", wrenches, Wrench):
        return np.zeros(6 + body.modes)
    check_axes(state, wrenches)
    check_nodes(body, wrenches)
    return pushed(body, places_of(wrenches), pushes_of(wrenches), np.asarray(state.rotation), q_e)


def places_of(wrenches: Sequence[Wrench]) -> tuple[Place, ...]:
    """The places of the wrenches; raises InputError where they are none."""
    known = all_of_type("wrenches", wrenches, Wrench)
    return tuple(Place(wrench.node, wrench.frame == "world") for wrench in known)


def pushes_of(wrenches: Sequence[Wrench]) -> Array:
    """(F, N) of the wrenches side by side, (…, 6 L)."""
    return join(
        [np.zeros(0), *(np.asarray(part) for wrench in wrenches for part in (wrench.force, wrench.moment))]
    )


def check_nodes(body: FlexibleBody, wrenches: Sequence[Wrench]) -> None:
    """Raise InputError for an unknown node, and for a moment on a body without rotation shapes."""
    for number, wrench in enumerate(wrenches):
        if not 0 <= wrench.node < len(body.nodes):
            raise InputError(
                f"wrenches[{number}].node is {wrench.node}; the platform has nodes 0 … {len(body.nodes) - 1}"
            )
        if body.modes and body.rotation_shapes is None and np.any(wrench.moment):
            raise InputError(
                f"wrenches[{number}] is a moment, but the platform has no rotation shapes; give "
                f"rotation_shapes to the body, or apply a pair of forces"
            )


def check_axes(state: State, wrenches: Sequence[Wrench]) -> None:
    """The leading axes of all wrenches must broadcast with those of the state."""
    shapes = [np.shape(part)[:-1] for wrench in wrenches for part in (wrench.force, wrench.moment)]
    try:
        np.broadcast_shapes(state.batch, *shapes)
    except ValueError:
        raise InputError(
            f"the leading (batch) axes of the wrenches' forces and moments are {shapes}, those of the "
            f"state {state.batch}; they must broadcast together"
        ) from None
