"""A carriage that a motor moves on a rail, with a rod that hangs on it: what PUS and PRS legs share."""

from dataclasses import dataclass
from typing import ClassVar

from parflex.base import kinds
from parflex.base.check import NOT_NEGATIVE
from parflex.robot.bar import Bar
from parflex.robot.fields import given, part
from parflex.robot.strut import Drive

RAIL = "direction of the rail, in the leg's frame"


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Railed(Drive):
    """A carriage of mass `carriage` kg that slides, and a rod."""

    sigma: ClassVar[int] = 1
    carriage: float = given(kinds.MASS, "the mass of the carriage", NOT_NEGATIVE)
    rod: Bar = part(Bar, "the bar from the carriage; its length is that between its joints")
