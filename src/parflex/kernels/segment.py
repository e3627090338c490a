"""The wanted motion on one stretch of a trajectory, for floats and for symbols."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array, dot, join, mtv, outer, skew
from parflex.robot.state import State

ONE = np.eye(3)
SEGMENT = 21  # numbers that describe a way from pose to pose


class Sample(NamedTuple):
    """Wanted motion of Σp: pose in Σ0; twist and acceleration resolved in Σp, as in `State`."""

    position: Array  # (…, 3) m
    rotation: Array  # (…, 3, 3)
    twist: Array  # (…, 6) m/s, rad/s
    acceleration: Array  # (…, 6) m/s², rad/s²

    def state(self, elastic: ArrayLike = 0.0) -> State:
        """The state on the trajectory, with elastic coordinates (…, N) at rest."""
        return State(self.position, self.rotation, self.twist, elastic)


def along(segment: Array, time: Array) -> Sample:
    """The wanted motion at times (…,) of segments (…, 21), floats or symbols.

    A segment is (start 1, duration 1, position 3, line to the next pose 3, R 9 by rows, axis 3 of the
    turn to the next pose, angle 1); on one that rests, line and angle are zero.
    """
    ends = (0, 1, 2, 5, 8, 17, 20, 21)
    start, span, position, line, by_rows, axis, angle = (segment[..., i:j] for i, j in pairwise(ends))
    tau = (time[..., None] - start) / span
    left = 1 - tau
    s = tau * tau * tau * (10 - 15 * tau + 6 * tau * tau)
    ds = 30 * tau * tau * left * left / span
    dds = 60 * tau * left * (1 - 2 * tau) / (span * span)
    sine, versine = np.sin(s * angle)[..., None], 1 - np.cos(s * angle)[..., None]
    turn = ONE + sine * skew(axis) + versine * (outer(axis, axis) - dot(axis, axis)[..., None, None] * ONE)
    rotation = by_rows.reshape(by_rows.shape[:-1] + (3, 3)) @ turn
    way = mtv(rotation, line)
    twist = join([ds * way, ds * angle * axis])
    acceleration = join([dds * way, dds * angle * axis])
    return Sample(position + s * line, rotation, twist, acceleration)
