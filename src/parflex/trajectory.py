"""Trajectories through several poses: fifth-order polynomials, at rest in each pose."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from parflex.array import Array, Given, skew
from parflex.check import exactly, finite, rotation_matrix, scalar
from parflex.errors import InputError
from parflex.state import State

ONE = np.eye(3)


class Sample(NamedTuple):
    """Wanted motion of Σp: pose in Σ0; twist and acceleration resolved in Σp, as in `State`."""

    position: Array  # (…, 3) m
    rotation: Array  # (…, 3, 3)
    twist: Array  # (…, 6) m/s, rad/s
    acceleration: Array  # (…, 6) m/s², rad/s²

    def state(self, elastic: ArrayLike = 0.0) -> State:
        """The state on the trajectory, with elastic coordinates (…, N) at rest."""
        return State(self.position, self.rotation, self.twist, elastic)


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Motion through the poses (n, 3) m, (n, 3, 3), one after the other.

    durations (n − 1,) s are the times from pose to pose; rest is the time (s) spent in the first
    pose and in the last. Between two poses the position goes along a straight line and the
    orientation along the geodesic of SO(3), both as 10 τ³ − 15 τ⁴ + 6 τ⁵: velocity and
    acceleration vanish at every pose, and are continuous throughout.

    Raises InputError for fewer than two poses, wrong shapes or durations that are not positive.
    """

    positions: Given
    rotations: Given
    durations: Given
    rest: tuple[float, float] = (0.5, 0.5)

    def __post_init__(self) -> None:
        positions = exactly("Trajectory.positions", self.positions, (None, 3))
        rotations = rotation_matrix("Trajectory.rotations", self.rotations)
        if len(positions) < 2 or rotations.shape != (len(positions), 3, 3):
            raise InputError(
                f"Trajectory has positions {positions.shape} and rotations {rotations.shape}; give "
                f"(n, 3) and (n, 3, 3) with n at least 2"
            )
        durations = exactly("Trajectory.durations", self.durations, (len(positions) - 1,))
        rest = exactly("Trajectory.rest", self.rest, (2,))
        if np.any(durations <= 0) or np.any(rest < 0):
            raise InputError(
                f"Trajectory.durations {durations} must be positive and rest {rest} not negative"
            )
        for name, value in (
            ("positions", positions),
            ("rotations", rotations),
            ("durations", durations),
            ("rest", (float(rest[0]), float(rest[1]))),
        ):
            object.__setattr__(self, name, value)

    @staticmethod
    def through(
        start: State,
        moves: Sequence[ArrayLike],
        duration: float,
        rest: tuple[float, float] = (0.5, 0.5),
    ) -> "Trajectory":
        """From the pose of a state through displacements of it, and back.

        Each move is a displacement (3,) m and a rotation vector (3,) rad, both from the start, in
        world axes; each leg of the journey takes `duration` seconds.
        """
        p, R = np.asarray(start.position), Rotation.from_matrix(np.asarray(start.rotation))
        steps = [exactly(f"moves[{i}]", move, (2, 3)) for i, move in enumerate(moves)]
        positions = [p, *(p + step[0] for step in steps), p]
        rotations = [R, *(Rotation.from_rotvec(step[1]) * R for step in steps), R]
        matrices = np.stack([rotation.as_matrix() for rotation in rotations])
        return Trajectory(positions, matrices, np.full(len(steps) + 1, scalar("duration", duration)), rest)

    @property
    def duration(self) -> float:
        """Total time, rests included, s."""
        return float(np.sum(self.durations)) + sum(self.rest)

    def sample(self, t: ArrayLike) -> Sample:
        """The wanted motion at times t (…,) s; before the start and after the end it rests."""
        return self.at(finite("t", t))

    def at(self, time: Array) -> Sample:
        """As `sample`, for control loops: the times are not checked."""
        way = self._way
        k = way.starts.searchsorted(time, side="right") - 1
        span, line, axis, angle = way.span[k], way.line[k], way.axis[k], way.angle[k]
        tau = np.minimum(np.maximum((time - way.times[k]) / span, 0.0), 1.0)
        s = tau**3 * (10 - 15 * tau + 6 * tau**2)
        ds = 30 * tau**2 * (1 - tau) ** 2 / span
        dds = 60 * tau * (1 - tau) * (1 - 2 * tau) / span**2
        sine, versine = np.sin(s * angle)[..., None, None], (1 - np.cos(s * angle))[..., None, None]
        rotation = way.rotation[k] @ (ONE + sine * way.hat[k] + versine * way.hat_squared[k])
        along = (line[..., None, :] @ rotation)[..., 0, :]
        ds, dds, angle = ds[..., None], dds[..., None], angle[..., None]
        twist = np.concatenate([ds * along, ds * angle * axis], axis=-1)
        acceleration = np.concatenate([dds * along, dds * angle * axis], axis=-1)
        return Sample(way.position[k] + s[..., None] * line, rotation, twist, acceleration)

    @cached_property
    def _way(self) -> "Way":
        positions, rotations = np.asarray(self.positions), np.asarray(self.rotations)
        span = np.asarray(self.durations)
        turns = Rotation.from_matrix(np.swapaxes(rotations[:-1], -1, -2) @ rotations[1:]).as_rotvec()
        angle = np.linalg.norm(turns, axis=-1)
        axis = turns / np.where(angle > 0, angle, 1.0)[:, None]
        times = self.rest[0] + np.concatenate([[0.0], np.cumsum(span)[:-1]])
        starts = np.concatenate([[-np.inf], times[1:]])
        line, hat = positions[1:] - positions[:-1], skew(axis)
        return Way(starts, times, span, positions, line, rotations, axis, angle, hat, hat @ hat)


class Way(NamedTuple):
    """The stretches between poses: when, from where, along which line and about which axis."""

    starts: Array  # (n − 1,) s; the first is minus infinity
    times: Array  # (n − 1,) s, when each begins
    span: Array
    position: Array  # (n, 3)
    line: Array  # (n − 1, 3)
    rotation: Array  # (n, 3, 3)
    axis: Array  # (n − 1, 3), the same in both poses' axes
    angle: Array  # (n − 1,)
    hat: Array  # (n − 1, 3, 3), the axis as a cross product
    hat_squared: Array
