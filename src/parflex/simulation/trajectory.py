"""Trajectories through several poses: fifth-order polynomials, at rest in each pose."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from parflex.base.array import Array
from parflex.base.check import exactly, finite, rotation_matrix, scalar
from parflex.base.errors import InputError
from parflex.base.held import Given
from parflex.kernels.segment import Sample, along
from parflex.robot.fields import check_fields, exact, held
from parflex.robot.state import State
from parflex.robot.words import listed


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Motion through the poses (n, 3) m, (n, 3, 3), one after the other.

    durations (n − 1,) s are the times from pose to pose; rest is the time (s) spent in the first
    pose and in the last. Between two poses the position goes along a straight line and the
    orientation along the geodesic of SO(3), both as 10 τ³ − 15 τ⁴ + 6 τ⁵: velocity and
    acceleration vanish at every pose, and are continuous throughout.

    Raises InputError for fewer than two poses, wrong shapes or durations that are not positive.
    """

    positions: Given = held(exact((None, 3)))
    rotations: Given = held(rotation_matrix)
    durations: Given = held()
    rest: tuple[float, float] = (0.5, 0.5)

    def __post_init__(self) -> None:
        check_fields(self)
        positions, rotations = self.positions, self.rotations
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
        object.__setattr__(self, "durations", durations)
        object.__setattr__(self, "rest", (float(rest[0]), float(rest[1])))

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

        >>> start = State(position=(0, 0, 1), rotation=np.eye(3))
        >>> there_and_back = Trajectory.through(start, [((0.1, 0, 0), (0, 0, 0))], duration=1.0)
        >>> there_and_back.duration  # half a second of rest at either end
        3.0
        >>> there_and_back.sample([0.0, 1.5, 3.0]).position[:, 0]
        array([0. , 0.1, 0. ])
        """
        p, R = np.asarray(start.position), Rotation.from_matrix(np.asarray(start.rotation))
        steps = [exactly(f"moves[{i}]", move, (2, 3)) for i, move in enumerate(moves)]
        positions = [p, *(p + step[0] for step in steps), p]
        rotations = [R, *(Rotation.from_rotvec(step[1]) * R for step in steps), R]
        matrices = np.stack([rotation.as_matrix() for rotation in rotations])
        return Trajectory(positions, matrices, np.full(len(steps) + 1, scalar("duration", duration)), rest)

    def __repr__(self) -> str:
        ends = f"from {listed(self.positions[0])} to {listed(self.positions[-1])} m"
        return f"Trajectory: {len(self.positions)} poses in {self.duration:.4g} s, {ends}"

    @property
    def duration(self) -> float:
        """Total time, rests included, s."""
        return float(np.sum(self.durations)) + sum(self.rest)

    def sample(self, t: ArrayLike) -> Sample:
        """The wanted motion at times t (…,) s; before the start and after the end it rests."""
        return self.at(finite("t", t))

    def at(self, time: Array) -> Sample:
        """As `sample`; the times are not checked."""
        number = self.starts.searchsorted(time, side="right") - 1
        return along(self.segments[number], time)

    @cached_property
    def starts(self) -> Array:
        """(n + 1,) s, when each segment begins: rest, the ways between the poses, rest."""
        times = self.rest[0] + np.concatenate([[0.0], np.cumsum(self.durations)])
        return np.concatenate([[-np.inf], times])

    @cached_property
    def segments(self) -> Array:
        """(n + 1, 21), what `along` reads of each."""
        p, R = np.asarray(self.positions), np.asarray(self.rotations)
        turns = Rotation.from_matrix(np.swapaxes(R[:-1], -1, -2) @ R[1:]).as_rotvec()
        angle = np.linalg.norm(turns, axis=-1)
        axis = turns / np.where(angle > 0, angle, 1.0)[:, None]
        none, still = np.zeros((1, 3)), np.zeros((1, 1))
        times = np.concatenate([[0.0], self.starts[1:-1], [0.0]])
        return np.concatenate(
            [
                times[:, None],
                np.concatenate([[1.0], self.durations, [1.0]])[:, None],
                np.concatenate([p[:1], p]),
                np.concatenate([none, p[1:] - p[:-1], none]),
                np.concatenate([R[:1], R]).reshape(-1, 9),
                np.concatenate([none, axis, none]),
                np.concatenate([still, angle[:, None], still]),
            ],
            axis=-1,
        )
