"""A move that stays where it is."""

from dataclasses import dataclass

from parflex.base import kinds
from parflex.base.check import POSITIVE
from parflex.kernels.segment import Segment, resting
from parflex.simulation.moves.move import Move, Pose, entry


@dataclass(frozen=True, eq=False, repr=False)
class Hold(Move):
    """Rest in the pose for `duration` seconds.

    Raises InputError for a duration that is not positive.
    """

    word = "hold"
    about = "Rest in the pose."

    duration: float = entry(kinds.TIME, "how long it rests", POSITIVE)

    def segments(self, start: Pose) -> list[Segment]:
        return [resting(*start, self.duration)]
