"""What a flat state holds, and where."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.base.check import finite, of_type
from parflex.base.errors import InputError
from parflex.base.spatial import quaternion_from_rotation, rotation_from_quaternion
from parflex.robot.state import State, elastic_vector


class Layout(NamedTuple):
    """What a flat state holds: N modes, and how many joints of each leg are carried."""

    modes: int
    joints: tuple[int, ...] = ()

    @property
    def carried(self) -> int:
        """The number of joints that are carried."""
        return sum(self.joints)

    @property
    def size(self) -> int:
        """Length of the flat state: p 3, quaternion 4, v_p 3, ω_p 3, q_e N, q̇_e N, q, q̇ carried."""
        return 13 + 2 * self.modes + 2 * self.carried


class Coordinates(NamedTuple):
    """A state as the mechanics reads it: floats, a batch, or symbols; nothing is checked."""

    position: Array
    rotation: Array
    twist: Array
    elastic: Array
    elastic_rate: Array
    q: Array  # joints that are carried, in the order of the legs
    qd: Array


def coordinates(x: Array, layout: Layout) -> Coordinates:
    """The flat state (…, size) as coordinates; the quaternion may have any length."""
    modes, carried = layout.modes, layout.carried
    ends = np.cumsum([13, modes, modes, carried, carried])
    elastic, elastic_rate, q, qd = (x[..., i:j] for i, j in pairwise(ends))
    return Coordinates(
        position=x[..., 0:3],
        rotation=rotation_from_quaternion(x[..., 3:7]),
        twist=x[..., 7:13],
        elastic=elastic,
        elastic_rate=elastic_rate,
        q=q,
        qd=qd,
    )


def pack(state: State, layout: Layout) -> Array:
    """The flat state (…, size) of a checked state; carried joints that it does not name are zero."""
    of_type("state", state, State)
    batch, modes = state.batch, layout.modes
    parts: Sequence[tuple[Array, int]] = (
        (state.position, 3),
        (quaternion_from_rotation(state.rotation), 4),
        (state.twist, 6),
        (elastic_vector("elastic", state.elastic, modes), modes),
        (elastic_vector("elastic_rate", state.elastic_rate, modes), modes),
        *carried_vectors(state.joints, layout),
        *carried_vectors(state.joint_rates, layout),
    )
    if not batch:
        return np.concatenate([part for part, _ in parts])
    return np.concatenate([np.broadcast_to(v, batch + (n,)) for v, n in parts], axis=-1)


def unpack(x: Array, layout: Layout) -> State:
    """The state of a flat vector (…, size)."""
    flat = finite("x", x, (layout.size,))
    if np.any(np.sum(flat[..., 3:7] ** 2, axis=-1) == 0):
        raise InputError("x holds a quaternion of length zero at 3 … 6; it must be a rotation (w, x, y, z)")
    c = coordinates(flat, layout)
    return State(*c[:5], joints=by_leg(c.q, layout), joint_rates=by_leg(c.qd, layout))


def by_leg(q: Array, layout: Layout) -> tuple[Array | None, ...] | None:
    """Carried joints (…, n) as one array per leg, None for legs that carry none."""
    if not layout.carried:
        return None
    ends = np.cumsum((0, *layout.joints))
    return tuple(
        q[..., end - count : end] if count else None
        for end, count in zip(ends[1:], layout.joints, strict=True)
    )


def carried_vectors(values: Any, layout: Layout) -> list[tuple[Array, int]]:
    """Carried joints of each leg, with their number."""
    if values is None:
        return [(np.zeros(layout.carried), layout.carried)] if layout.carried else []
    pairs = zip(values, layout.joints, strict=True)
    return [(value if count and value is not None else np.zeros(count), count) for value, count in pairs]
