"""The state of a robot, the loads on its platform, and how both are packed into flat vectors."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from parflex.array import Array, Given
from parflex.check import finite, integer, of_type, rotation_matrix
from parflex.errors import InputError
from parflex.spatial import quaternion_from_rotation, rotation_from_quaternion


@dataclass(frozen=True, eq=False)
class State:
    """Pose, twist and elastic coordinates of the platform; leading axes are batch axes.

    position (…, 3) m and rotation (…, 3, 3) place Σp in Σ0; twist (…, 6) is (v_p, ω_p) in Σp,
    m/s and rad/s; elastic and elastic_rate (…, N) are q_e and q̇_e (0: undeformed, at rest).

    joints and joint_rates, one (…, n_i) per leg, matter to legs whose inverse geometry has no closed
    form: Newton's method starts from them (by default from the leg's posture, with the rates that
    the platform imposes). For other legs they may be None; where given they name the assembly branch
    of a leg without a posture, and are checked against that of one with a posture.

    Raises InputError for wrong shapes, values that are not finite, or a matrix that is no rotation.
    """

    position: Given
    rotation: Given
    twist: Given = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    elastic: Given = 0.0
    elastic_rate: Given = 0.0
    joints: Given = None
    joint_rates: Given = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", finite("State.position", self.position, (3,)))
        object.__setattr__(self, "rotation", rotation_matrix("State.rotation", self.rotation))
        object.__setattr__(self, "twist", finite("State.twist", self.twist, (6,)))
        for name in ("elastic", "elastic_rate"):
            object.__setattr__(self, name, finite(f"State.{name}", getattr(self, name)))
        for name in ("joints", "joint_rates"):
            object.__setattr__(self, name, per_leg(f"State.{name}", getattr(self, name)))
        _ = self.batch  # the leading axes must broadcast

    def __getitem__(self, index: Any) -> "State":
        """States of a batch, chosen along its leading axes."""
        batch = self.batch

        def chosen(value: Any, core: int) -> Any:
            if value is None or np.ndim(value) == 0:
                return value
            return np.broadcast_to(value, batch + np.shape(value)[-core:])[index]

        parts = [chosen(value, core) for value, core in self._arrays()]
        legs = [
            None if values is None else tuple(chosen(value, 1) for value in values)
            for values in (self.joints, self.joint_rates)
        ]
        return State(*parts, *legs)

    @cached_property
    def batch(self) -> tuple[int, ...]:
        """The common leading axes."""
        legs = [(value, 1) for values in (self.joints, self.joint_rates) for value in values or ()]
        shapes = [value.shape[:-core] for value, core in (*self._arrays(), *legs) if value is not None]
        if not any(shapes):
            return ()
        try:
            return np.broadcast_shapes(*shapes)
        except ValueError:
            raise InputError(
                f"State: the leading (batch) axes of position, rotation, twist, elastic, "
                f"elastic_rate and joints are {shapes}; they must broadcast together"
            ) from None

    def _arrays(self) -> tuple[tuple[Any, int], ...]:
        """The platform's fields, with the number of axes of one item."""
        return (
            (self.position, 1),
            (self.rotation, 2),
            (self.twist, 1),
            (self.elastic, 1),
            (self.elastic_rate, 1),
        )


def per_leg(name: str, values: Any) -> tuple[Array | None, ...] | None:
    """One (…, n_i) array, or None, per leg."""
    if values is None:
        return None
    if not isinstance(values, (list, tuple)):
        raise InputError(f"{name} is {type(values).__name__}; give a tuple with one (…, n_i) per leg")
    return tuple(
        None if value is None else finite(f"{name}[{number}]", value, (None,))
        for number, value in enumerate(values)
    )


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


@dataclass(frozen=True, eq=False)
class Wrench:
    """A force (…, 3) N and a moment (…, 3) N m on platform node `node`, in world or platform axes.

    Raises InputError for wrong shapes or another frame name.
    """

    node: int
    force: Given = (0.0, 0.0, 0.0)
    moment: Given = (0.0, 0.0, 0.0)
    frame: str = "world"

    def __post_init__(self) -> None:
        object.__setattr__(self, "force", finite("Wrench.force", self.force, (3,)))
        object.__setattr__(self, "moment", finite("Wrench.moment", self.moment, (3,)))
        object.__setattr__(self, "node", integer("Wrench.node", self.node))
        if self.frame not in ("world", "platform"):
            raise InputError(f'Wrench.frame is {self.frame!r}; choose "world" or "platform"')


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


def elastic_vector(name: str, value: ArrayLike, modes: int) -> Array:
    """(…, N) of an elastic coordinate; a lone 0 stands for the undeformed platform."""
    array = np.asarray(value)
    if array.ndim == 0 and array == 0:
        return np.zeros(modes)
    if array.ndim == 0 or array.shape[-1] != modes:
        raise InputError(
            f"State.{name} has shape {array.shape}; this platform has {modes} modes, "
            f"so the last axis must be {modes} long"
        )
    return array
