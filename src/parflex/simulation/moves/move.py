"""A move: one stretch of a trajectory, which any number of segments describe.

A kind of move is one file: a dataclass whose fields say how they are checked and written in trajectory
files, and the segments that it makes from the pose where it begins.
"""

from abc import ABC, abstractmethod
from dataclasses import MISSING, field
from typing import Any, ClassVar, NamedTuple

from parflex.base.array import Array
from parflex.base.check import Rule, scalar
from parflex.base.kinds import Kind
from parflex.kernels.segment import Segment, along
from parflex.robot.fields import about, check_fields, exact, optional
from parflex.robot.words import told


class Pose(NamedTuple):
    """Where Σp is in Σ0."""

    position: Array  # (3,) m
    rotation: Array  # (3, 3)


class Move(ABC):
    """A stretch of a trajectory from the pose where the one before ended.

    It begins and ends at rest, and its acceleration is continuous and vanishes at both ends.
    Raises InputError for fields that do not obey their rules.
    """

    word: ClassVar[str] = ""  # its key in a [[move]] of trajectory files; empty for the poses themselves
    about: ClassVar[str] = ""  # a sentence on its table

    def __post_init__(self) -> None:
        check_fields(self)

    @abstractmethod
    def segments(self, start: Pose) -> list[Segment]:
        """The segments that it goes along, one after the other, from a pose on."""

    def end(self, start: Pose) -> Pose:
        """The pose where it ends."""
        last = self.segments(start)[-1]
        found = along(last.row, last.start + last.span)
        return Pose(found.position, found.rotation)

    __repr__ = told


def entry(
    kind: Kind, words: str, rule: Rule | None = None, *, default: Any = MISSING, shape: tuple[int, ...] = ()
) -> Any:
    """A number or an array of a move, which trajectory files have too; it may be absent where it is None by
    default."""
    form = exact(shape) if shape else scalar
    form = optional(form) if default is None else form
    return field(default=default, metadata=about(form, kind=kind, words=words, rule=rule, shape=shape))
