"""The state of a robot, the loads on its platform, and how both are packed into flat vectors."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from parflex.array import Array, Given
from parflex.check import finite, integer, of_type, rotation_matrix
from parflex.errors import InputError
from parflex.spatial import rotation_from_quaternion


@dataclass(frozen=True, eq=False)
class State:
    """Pose, twist and elastic coordinates of the platform; leading axes are batch axes.

    position (…, 3) m and rotation (…, 3, 3) place Σp in Σ0; twist (…, 6) is (v_p, ω_p) in Σp,
    m/s and rad/s; elastic and elastic_rate (…, N) are q_e and q̇_e (0: undeformed, at rest).
    `joints` is reserved for legs without closed-form inverse geometry.

    Raises InputError for wrong shapes, values that are not finite, or a matrix that is no rotation.
    """

    position: Given
    rotation: Given
    twist: Given = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    elastic: Given = 0.0
    elastic_rate: Given = 0.0
    joints: tuple[ArrayLike, ...] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", finite("State.position", self.position, (3,)))
        object.__setattr__(self, "rotation", rotation_matrix("State.rotation", self.rotation))
        object.__setattr__(self, "twist", finite("State.twist", self.twist, (6,)))
        for name in ("elastic", "elastic_rate"):
            object.__setattr__(self, name, finite(f"State.{name}", getattr(self, name)))
        if self.joints is not None:
            raise InputError("State.joints: no leg type of this version carries its joints in the state")
        _ = self.batch  # the leading axes must broadcast

    def __getitem__(self, index: Any) -> "State":
        """States of a batch, chosen along its leading axes."""
        batch = self.batch
        parts: list[Any] = [
            value if np.ndim(value) == 0 else np.broadcast_to(value, batch + np.shape(value)[-core:])[index]
            for value, core in zip(self._arrays(), (1, 2, 1, 1, 1), strict=True)
        ]
        return State(*parts)

    @property
    def batch(self) -> tuple[int, ...]:
        """The common leading axes."""
        shapes = [
            np.shape(value)[: max(np.ndim(value) - core, 0)]
            for value, core in zip(self._arrays(), (1, 2, 1, 1, 1), strict=True)
        ]
        try:
            return np.broadcast_shapes(*shapes)
        except ValueError:
            raise InputError(
                f"State: the leading (batch) axes of position, rotation, twist, elastic and "
                f"elastic_rate are {shapes}; they must broadcast together"
            ) from None

    def _arrays(self) -> tuple[ArrayLike, ...]:
        return self.position, self.rotation, self.twist, self.elastic, self.elastic_rate


class Coordinates(NamedTuple):
    """A state as the mechanics reads it: floats, a batch, or symbols; nothing is checked."""

    position: Array
    rotation: Array
    twist: Array
    elastic: Array
    elastic_rate: Array


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


def state_size(modes: int) -> int:
    """Length of the flat state: p 3, quaternion 4, v_p 3, ω_p 3, q_e N, q̇_e N."""
    return 13 + 2 * modes


def coordinates(x: Array, modes: int) -> Coordinates:
    """The flat state (…, 13 + 2N) as coordinates; the quaternion may have any length."""
    return Coordinates(
        position=x[..., 0:3],
        rotation=rotation_from_quaternion(x[..., 3:7]),
        twist=x[..., 7:13],
        elastic=x[..., 13 : 13 + modes],
        elastic_rate=x[..., 13 + modes : 13 + 2 * modes],
    )


def pack(state: State, modes: int) -> Array:
    """The flat state (…, 13 + 2N) of a checked state."""
    from scipy.spatial.transform import Rotation

    of_type("state", state, State)
    batch = state.batch
    rotation = np.asarray(state.rotation)
    quaternion = Rotation.from_matrix(rotation.reshape(-1, 3, 3)).as_quat(scalar_first=True)
    parts: Sequence[tuple[Array, int]] = (
        (np.asarray(state.position), 3),
        (quaternion.reshape(rotation.shape[:-2] + (4,)), 4),
        (np.asarray(state.twist), 6),
        (elastic_vector("elastic", state.elastic, modes), modes),
        (elastic_vector("elastic_rate", state.elastic_rate, modes), modes),
    )
    return np.concatenate([np.broadcast_to(v, batch + (n,)) for v, n in parts], axis=-1)


def unpack(x: Array, modes: int) -> State:
    """The state of a flat vector (…, 13 + 2N)."""
    flat = finite("x", x, (state_size(modes),))
    if np.any(np.sum(flat[..., 3:7] ** 2, axis=-1) == 0):
        raise InputError("x holds a quaternion of length zero at 3 … 6; it must be a rotation (w, x, y, z)")
    return State(*coordinates(flat, modes))


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
