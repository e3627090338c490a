"""External wrenches on platform nodes, as generalised forces W_a (F, N)."""

from collections.abc import Sequence

import numpy as np

from parflex.array import Array, mtv, mv
from parflex.body import FlexibleBody
from parflex.check import all_of_type, of_type
from parflex.errors import InputError
from parflex.kinematics import node_wrench_map
from parflex.state import State, Wrench, elastic_vector


def generalised_force(body: FlexibleBody, state: State, wrenches: Sequence[Wrench]) -> Array:
    """Σ W_a (F, N): (…, 6 + N), in Σp.

    Raises InputError for an unknown node, and for a moment on a body without rotation shapes.
    """
    of_type("state", state, State)
    total = np.zeros(6 + body.modes)
    q_e = elastic_vector("elastic", state.elastic, body.modes)
    check_axes(state, all_of_type("wrenches", wrenches, Wrench))
    for number, wrench in enumerate(wrenches):
        if not 0 <= wrench.node < len(body.nodes):
            raise InputError(
                f"wrenches[{number}].node is {wrench.node}; the platform has nodes 0 … {len(body.nodes) - 1}"
            )
        force, moment = np.asarray(wrench.force), np.asarray(wrench.moment)
        if body.modes and body.rotation_shapes is None and np.any(moment):
            raise InputError(
                f"wrenches[{number}] is a moment, but the platform has no rotation shapes; give "
                f"rotation_shapes to the body, or apply a pair of forces"
            )
        if wrench.frame == "world":
            R = np.asarray(state.rotation)
            force, moment = mtv(R, force), mtv(R, moment)
        batch = np.broadcast_shapes(force.shape[:-1], moment.shape[:-1])
        both = [np.broadcast_to(part, batch + (3,)) for part in (force, moment)]
        total = total + mv(node_wrench_map(body, wrench.node, q_e), np.concatenate(both, axis=-1))
    return total


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
