"""Trajectories: moves one after the other, at rest between them."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import all_of_type, exactly, finite, of_type, positive, rotation_matrix
from parflex.base.errors import InputError
from parflex.base.held import Given
from parflex.kernels.segment import Sample, Segment, along, resting
from parflex.robot.fields import check_fields, exact, held
from parflex.robot.state import State
from parflex.robot.words import counted, listed
from parflex.simulation.moves import Move, MoveTo, Pose

SAME = 1e-9  # m, and of a rotation matrix: poses that are one


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Motion through the poses (n, 3) m, (n, 3, 3), one after the other.

    durations (n − 1,) s are the times from pose to pose; rest is the time (s) spent in the first
    pose and in the last. `moves` lead from each pose to the next, by default straight (`MoveTo`); whoever
    has moves alone takes `Trajectory.of`. Each begins and ends at rest: velocity and acceleration vanish
    at every pose, and are continuous throughout.

    Raises InputError for fewer than two poses, wrong shapes, durations that are not positive, or moves that
    do not lead through the poses in these times.
    """

    positions: Given = held(exact((None, 3)))
    rotations: Given = held(rotation_matrix)
    durations: Given = held()
    rest: tuple[float, float] = (0.5, 0.5)
    moves: tuple[Move, ...] = ()

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
        object.__setattr__(self, "moves", self._led())

    @staticmethod
    def of(start: State, moves: Sequence[Move], rest: tuple[float, float] = (0.0, 0.0)) -> "Trajectory":
        """From the pose of a state through moves, each from the pose where the one before ended.

        Raises InputError for a batch of states, and for no moves.

        >>> from parflex.simulation.moves import Circle, Hold, MoveTo
        >>> start = State(position=(0, 0, 1), rotation=np.eye(3))
        >>> up = MoveTo(position=(0, 0, 1.01), duration=0.05)
        >>> way = Trajectory.of(start, [Hold(1.0), up, Circle(radius=0.01, frequency=5, turns=5, ramp=0.4)])
        >>> way.duration
        2.45
        """
        moves = all_of_type("moves", moves, Move)
        if not moves:
            raise InputError("moves is empty; give at least one move")
        return Trajectory(*between(pose_of(start), moves), rest, moves)

    @staticmethod
    def through(
        start: State,
        moves: ArrayLike,
        duration: float,
        rest: tuple[float, float] = (0.5, 0.5),
    ) -> "Trajectory":
        """From the pose of a state through displacements of it, and back.

        Each of moves (n, 2, 3) is a displacement (3,) m and a rotation vector (3,) rad, both from the start,
        in world axes; each leg of the journey takes `duration` seconds.

        Raises InputError for a batch of states and wrong shapes.

        >>> start = State(position=(0, 0, 1), rotation=np.eye(3))
        >>> there_and_back = Trajectory.through(start, [((0.1, 0, 0), (0, 0, 0))], duration=1.0)
        >>> there_and_back.duration  # half a second of rest at either end
        3.0
        >>> there_and_back.sample([0.0, 1.5, 3.0]).position[:, 0]
        array([0. , 0.1, 0. ])
        """
        from scipy.spatial.transform import Rotation

        pose, steps = pose_of(start), exactly("moves", moves, (None, 2, 3))
        p, R = pose.position, Rotation.from_matrix(pose.rotation)
        positions = [p, *(p + step[0] for step in steps), p]
        rotations = [R, *(Rotation.from_rotvec(step[1]) * R for step in steps), R]
        matrices = np.stack([rotation.as_matrix() for rotation in rotations])
        return Trajectory(positions, matrices, np.full(len(steps) + 1, positive("duration", duration)), rest)

    def __repr__(self) -> str:
        ends = f"from {listed(self.positions[0])} to {listed(self.positions[-1])} m"
        return f"Trajectory: {counted(len(self.moves), 'move')} in {self.duration:.4g} s, {ends}"

    @property
    def duration(self) -> float:
        """Total time, rests included, s."""
        return float(np.sum(self.durations)) + sum(self.rest)

    def sample(self, t: ArrayLike) -> Sample:
        """The wanted motion at times t (…,) s; before the start and after the end it rests."""
        return self.at(finite("t", t))

    def at(self, time: Array) -> Sample:
        """As `sample`; the times are not checked."""
        return along(self.rows(time), time)

    def rows(self, time: Array) -> Array:
        """(…, SEGMENT), what `along` reads at times (…,)."""
        return self.segments[self.starts.searchsorted(time, side="right") - 1]

    @cached_property
    def starts(self) -> Array:
        """(n,) s, when each segment begins, from −∞ on."""
        return np.array([-np.inf, *(each.start for each in self.stretches[1:])])

    @cached_property
    def segments(self) -> Array:
        """(n, SEGMENT), what `along` reads of each."""
        return np.stack([each.row for each in self.stretches])

    @cached_property
    def stretches(self) -> tuple[Segment, ...]:
        """The segments: rest in the first pose, those of the moves, rest in the last pose."""
        poses = self._poses
        moving = [each for move, pose in zip(self.moves, poses, strict=False) for each in move.segments(pose)]
        begin = self.rest[0] + np.cumsum([0.0, *(each.span for each in moving)])
        placed = [each._replace(start=start) for each, start in zip(moving, begin, strict=False)]
        return (resting(*poses[0]), *placed, resting(*poses[-1])._replace(start=begin[-1]))

    @property
    def still(self) -> bool:
        """True where it stays in one pose, to round-off."""
        return all(each.still for each in self.stretches)

    @property
    def _poses(self) -> list[Pose]:
        return [Pose(*each) for each in zip(self.positions, self.rotations, strict=True)]

    def _led(self) -> tuple[Move, ...]:
        """The moves, checked; straight ones where none are given."""
        poses, moves = self._poses, all_of_type("Trajectory.moves", self.moves, Move)
        if not moves:
            ways = zip(poses[1:], self.durations, strict=True)
            return tuple(MoveTo(*pose, duration=time) for pose, time in ways)
        given = self.positions, self.rotations, self.durations
        pairs = zip(between(poses[0], moves), given, strict=True)
        if not all(a.shape == b.shape and np.allclose(a, b, 0, SAME) for a, b in pairs):
            raise InputError(
                "Trajectory.moves do not lead through its positions and rotations in its durations; use "
                "Trajectory.of, which finds them"
            )
        return moves


def pose_of(start: State) -> Pose:
    """The pose of a state; raises InputError for a batch, and for what is no state."""
    if of_type("start", start, State).batch:
        raise InputError(f"start is a batch {start.batch}; give one state")
    return Pose(np.asarray(start.position), np.asarray(start.rotation))


def between(start: Pose, moves: Sequence[Move]) -> tuple[Array, Array, Array]:
    """The positions (n + 1, 3) and rotations (n + 1, 3, 3) that n moves lead through, and times (n,)."""
    poses, times = [start], []
    for move in moves:
        times.append(sum(float(each.span) for each in move.segments(poses[-1])))
        poses.append(move.end(poses[-1]))
    return (
        np.stack([pose.position for pose in poses]),
        np.stack([pose.rotation for pose in poses]),
        np.array(times),
    )


def check_along(check: Callable[[Array], None], t: Array, rows: Array) -> None:
    """Raise the InputError that `check` has of some of the rows (T, n), with the first of the times (T,)."""
    try:
        check(rows)
    except InputError:
        for time, row in zip(t, rows, strict=True):
            with told_at(time):
                check(row)


@contextmanager
def told_at(time: float) -> Iterator[None]:
    """An InputError within is told with the time (s) on the trajectory."""
    try:
        yield
    except InputError as error:
        raise type(error)(f"trajectory at t = {time:.6g} s: {error}") from None
