"""Where a run is looked at from: the world, or the base that carries the robot.

What the legs allow, and how much the platform bends, is the same for a robot on a moving base and for one at
rest that stands and moves in the same way as seen from its base.
"""

from typing import Protocol

import numpy as np

from parflex.base.array import Array, cross, join, mtv, mv
from parflex.kernels.segment import Sample
from parflex.robot.carrying import base_of, carried, carrying, place_of, seen, with_place
from parflex.robot.state import State


class Standpoint:
    """A base that carries a robot; this one is at rest at the origin."""

    def seen(self, t: Array | float, x: Array) -> Array:
        """Flat states (…, n) at times (…,) as seen from the base; what stands behind the twist stays."""
        return x

    def carried(self, t: Array | float, x: Array) -> Array:
        """Flat states (…, n) at times (…,) in the world, of those that are seen from the base."""
        return x

    def state_seen(self, t: float, state: State) -> State:
        """A state at a time as seen from the base."""
        return with_place(state, self.seen(t, place_of(state)))

    def state_carried(self, t: float, state: State) -> State:
        """The state in the world at a time, of one that is seen from the base."""
        return with_place(state, self.carried(t, place_of(state)))

    def sample_carried(self, t: Array, sample: Sample) -> Sample:
        """The motion in the world at times (…,), of one that is seen from the base."""
        return sample


class Fixed(Standpoint):
    """A base at rest at the origin: all is seen as it is."""

    def state_seen(self, t: float, state: State) -> State:
        return state

    state_carried = state_seen


class Rows(Protocol):
    """A base's motion (…, 19) as a function of times (…,)."""

    def __call__(self, t: float) -> Array: ...

    def rows(self, t: Array) -> Array: ...


class Carried(Standpoint):
    """A base that moves."""

    def __init__(self, base: Rows) -> None:
        self._base = base

    def seen(self, t: Array | float, x: Array) -> Array:
        return seen(self._at(t), x)

    def carried(self, t: Array | float, x: Array) -> Array:
        return carried(self._at(t), x)

    def sample_carried(self, t: Array, sample: Sample) -> Sample:
        return carried_motion(self._at(t), sample)

    def _at(self, t: Array | float) -> Array:
        return self._base.rows(t) if isinstance(t, np.ndarray) and t.ndim else self._base(float(t))


FIXED = Fixed()


def carried_motion(base: Array, sample: Sample) -> Sample:
    """The motion in the world of frames (…,) that move as a sample says to bases (…, 19)."""
    b = base_of(base)
    away, rotation = mv(b.rotation, sample.position), b.rotation @ sample.rotation
    twist = sample.twist + carrying(b, away, rotation)
    v, omega = (mv(rotation, part) for part in (sample.twist[..., :3], sample.twist[..., 3:]))
    pushed = b.acceleration + cross(b.omegad, away) + cross(b.omega, cross(b.omega, away) + 2.0 * v)
    turned = b.omegad + cross(b.omega, omega)
    acceleration = sample.acceleration + join([mtv(rotation, pushed), mtv(rotation, turned)])
    return Sample(b.position + away, rotation, twist, acceleration)
