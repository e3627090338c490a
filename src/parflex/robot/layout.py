"""The layout of the flat state: its parts by name. Nobody else knows an offset."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import finite, of_type
from parflex.base.errors import InputError
from parflex.base.spatial import quaternion_from_rotation, rotation_from_quaternion
from parflex.robot.state import State


class Places(NamedTuple):
    """The slices of a flat state."""

    position: slice
    quaternion: slice
    twist: slice
    elastic: slice
    elastic_rate: slice
    joints: slice
    joint_rates: slice
    branches: slice


class Motions(NamedTuple):
    """The slices of a small motion of the state.

    It is (δp 3 in Σ0, δθ 3, δv_p 3, δω_p 3, δq_e N, δq̇_e N[, δq, δq̇ carried]), δθ being a rotation vector
    in Σp: R → R exp(δθ̂).
    """

    position: slice
    rotation: slice
    velocity: slice
    omega: slice
    elastic: slice
    elastic_rate: slice
    joints: slice
    joint_rates: slice


class Displacements(NamedTuple):
    """The slices of a displacement: of Σp in Σp, of the modes, of all joints in the order of the groups."""

    pose: slice
    elastic: slice
    joints: slice


@dataclass(frozen=True)
class Layout:
    """N modes, how many joints of each leg are carried, the legs whose branch is an entry of the state, and
    how many elastic coordinates each leg has.

    The carried coordinates s of a leg are its carried joints, then its elastic coordinates.
    """

    modes: int
    joints: tuple[int, ...] = ()
    branched: tuple[int, ...] = ()
    elastic: tuple[int, ...] = ()

    @cached_property
    def carried(self) -> int:
        """The number of coordinates of the legs that are carried."""
        return sum(self.joints) + sum(self.elastic)

    @cached_property
    def by_leg(self) -> tuple[list[slice], list[slice]]:
        """The places of each leg's joints, and of its elastic coordinates, among those that are carried."""
        elastic = self.elastic or (0,) * len(self.joints)
        both = spans(*(n for pair in zip(self.joints, elastic, strict=True) for n in pair))
        return both[::2], both[1::2]

    @cached_property
    def at(self) -> Places:
        """The places of the parts: p 3, quaternion 4, v_p and ω_p 6, q_e N, q̇_e N, s, ṡ carried,
        branches ±1."""
        N, n = self.modes, self.carried
        return Places(*spans(3, 4, 6, N, N, n, n, len(self.branched)))

    @cached_property
    def size(self) -> int:
        """The length of the flat state."""
        return self.at.branches.stop

    @cached_property
    def motions(self) -> Motions:
        """The places of the parts of a small motion."""
        N, n = self.modes, self.carried
        return Motions(*spans(3, 3, 3, 3, N, N, n, n))

    @cached_property
    def motion_size(self) -> int:
        """The length of a small motion, 12 + 2 N + 2 n."""
        return self.motions.joint_rates.stop

    @cached_property
    def displacements(self) -> Displacements:
        """The places of the parts of a displacement; the joints reach to its end."""
        pose, elastic, _ = spans(6, self.modes, 0)
        return Displacements(pose, elastic, slice(elastic.stop, None))


def spans(*lengths: int) -> list[slice]:
    """Consecutive slices of given lengths."""
    return [slice(int(i), int(j)) for i, j in pairwise(np.cumsum((0, *lengths)))]


class Coordinates(NamedTuple):
    """A state as the mechanics reads it: floats, a batch, or symbols; nothing is checked."""

    position: Array
    rotation: Array
    twist: Array
    elastic: Array
    elastic_rate: Array
    s: Array  # coordinates of the legs that are carried, in their order
    sd: Array
    branches: Array  # ±1 of the legs whose branch is an entry of the state


def coordinates(x: Array, layout: Layout) -> Coordinates:
    """The coordinates of a flat state (…, size); the quaternion may have any length."""
    position, quaternion, *rest = (x[..., part] for part in layout.at)
    return Coordinates(position, rotation_from_quaternion(quaternion), *rest)


def pack(state: State, layout: Layout) -> Array:
    """The flat state (…, size) of a checked state; carried coordinates that it does not name are zero.

    All branches are +1.
    """
    of_type("state", state, State)
    batch, modes = state.batch, layout.modes
    parts: Sequence[tuple[Array, int]] = (
        (state.position, 3),
        (quaternion_from_rotation(state.rotation), 4),
        (state.twist, 6),
        (elastic_vector("elastic", state.elastic, modes), modes),
        (elastic_vector("elastic_rate", state.elastic_rate, modes), modes),
        *carried_vectors(state.joints, state.leg_elastic, layout),
        *carried_vectors(state.joint_rates, state.leg_elastic_rate, layout),
        *([(np.ones(len(layout.branched)), len(layout.branched))] if layout.branched else []),
    )
    if not batch:
        return np.concatenate([part for part, _ in parts])
    return np.concatenate([np.broadcast_to(v, batch + (n,)) for v, n in parts], axis=-1)


def checked_flat(x: ArrayLike, layout: Layout) -> Array:
    """A flat state (…, size).

    Raises InputError for a wrong length, values that are not finite, or a quaternion of length zero.
    """
    flat = finite("x", x, (layout.size,))
    if np.any(np.sum(flat[..., layout.at.quaternion] ** 2, axis=-1) == 0):
        raise InputError("x holds a quaternion of length zero at 3 … 6; it must be a rotation (w, x, y, z)")
    return flat


def unpack(x: ArrayLike, layout: Layout) -> State:
    """The state of a flat vector (…, size), without the branches; raises as `checked_flat`."""
    c, (joints, elastic) = coordinates(checked_flat(x, layout), layout), layout.by_leg
    parts = (of_legs(s, places) for places in (joints, elastic) for s in (c.s, c.sd))
    q, qd, e, ed = parts
    return State(*c[:5], joints=q, joint_rates=qd, leg_elastic=e, leg_elastic_rate=ed)


def of_legs(s: Array, places: Sequence[slice]) -> tuple[Array | None, ...] | None:
    """Parts of carried coordinates (…, n) as one array per leg, None for legs without; None where all are."""
    found = tuple(s[..., place] if place.stop > place.start else None for place in places)
    return None if all(part is None for part in found) else found


def carried_vectors(joints: Any, elastic: Any, layout: Layout) -> list[tuple[Array, int]]:
    """Carried joints and elastic coordinates of each leg, with their number."""
    if joints is None and elastic is None:
        return [(np.zeros(layout.carried), layout.carried)] if layout.carried else []
    found, nothing = [], (None,) * len(layout.joints)
    for number, pair in enumerate(zip(joints or nothing, elastic or nothing, strict=True)):
        for value, places in zip(pair, layout.by_leg, strict=True):
            count = places[number].stop - places[number].start
            found.append((value if count and value is not None else np.zeros(count), count))
    return found


def elastic_vector(name: str, value: ArrayLike, modes: int) -> Array:
    """(…, N) of an elastic coordinate; a lone 0 stands for the undeformed platform.

    Raises InputError for another number of modes.
    """
    array = np.asarray(value)
    if array.ndim == 0 and array == 0:
        return np.zeros(modes)
    if array.ndim == 0 or array.shape[-1] != modes:
        raise InputError(
            f"State.{name} has shape {array.shape}; this platform has {modes} modes, "
            f"so the last axis must be {modes} long"
        )
    return array
