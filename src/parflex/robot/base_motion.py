"""The motion of a robot's base: where Σ0 is in the world, and how it moves there."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from parflex.base.array import Array
from parflex.base.check import of_type, rotation_matrix
from parflex.base.errors import InputError
from parflex.base.held import Given
from parflex.base.spatial import quaternion_from_rotation
from parflex.robot.carrying import carried, place_of, seen, with_place
from parflex.robot.fields import batched, check_fields, held
from parflex.robot.state import State
from parflex.robot.words import listed

BASE = 19  # numbers of a flat base: p 3, quaternion w x y z 4, v 3, ω 3, a 3, ω̇ 3
STILL = (0.0,) * 6
HOME = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True, eq=False)
class BaseMotion:
    """Pose, twist and acceleration of the frame Σ0, all in world axes; leading axes are batch axes.

    position (…, 3) m and rotation (…, 3, 3) place Σ0 in the world; twist (…, 6) is the velocity of its origin
    and its angular velocity, m/s and rad/s; acceleration (…, 6) holds their rates, m/s² and rad/s². By
    default the base is at rest, and Σ0 is the world's frame.

    Raises InputError for wrong shapes, values that are not finite, or a matrix that is no rotation.

    >>> BaseMotion(twist=(0.1, 0, 0, 0, 0, 0)).position
    array([0., 0., 0.])
    """

    position: Given = held(batched((3,)), default=(0.0, 0.0, 0.0))
    rotation: Given = held(rotation_matrix, default=HOME)
    twist: Given = held(batched((6,)), default=STILL)
    acceleration: Given = held(batched((6,)), default=STILL)

    def __post_init__(self) -> None:
        check_fields(self)
        _ = self.batch  # the leading axes must broadcast

    def __repr__(self) -> str:
        if self.batch:
            return f"BaseMotion: a batch {self.batch}"
        angle = np.degrees(np.arccos(np.clip((np.trace(self.rotation) - 1) / 2, -1, 1)))
        return (
            f"BaseMotion: position {listed(self.position)} m, turned by {angle:.4g} deg\n"
            f"  twist {listed(self.twist)} m/s and rad/s, acceleration {listed(self.acceleration)}"
        )

    def __getitem__(self, index: Any) -> "BaseMotion":
        """Motions of a batch, chosen along its leading axes."""
        return BaseMotion(
            *(np.broadcast_to(a, self.batch + np.shape(a)[-core:])[index] for a, core in self._arrays())
        )

    def carried(self, state: State) -> State:
        """The state in the world of one that is seen from the base: what rests there moves with it."""
        return with_place(state, carried(self.flat, place_of(of_type("state", state, State))))

    def seen(self, state: State) -> State:
        """The state as it is seen from the base, of one in the world."""
        return with_place(state, seen(self.flat, place_of(of_type("state", state, State))))

    @property
    def batch(self) -> tuple[int, ...]:
        """The common leading axes."""
        shapes = [np.shape(value)[:-core] for value, core in self._arrays()]
        try:
            return np.broadcast_shapes(*shapes)
        except ValueError:
            raise InputError(
                f"BaseMotion: the leading (batch) axes of position, rotation, twist and acceleration are "
                f"{shapes}; they must broadcast together"
            ) from None

    @property
    def flat(self) -> Array:
        """(…, 19): p 3, quaternion w x y z 4, v 3, ω 3, a 3, ω̇ 3."""
        turn = quaternion_from_rotation(np.asarray(self.rotation))
        parts: list[Any] = [self.position, turn, self.twist, self.acceleration]
        return np.concatenate([np.broadcast_to(a, self.batch + np.shape(a)[-1:]) for a in parts], axis=-1)

    def _arrays(self) -> tuple[tuple[Any, int], ...]:
        """The fields, with the number of axes of one item."""
        return (self.position, 1), (self.rotation, 2), (self.twist, 1), (self.acceleration, 1)
