"""The RUS leg: a motor turns a crank, on which a rod hangs by a universal joint."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from parflex.base import kinds
from parflex.base.held import Given
from parflex.robot.bar import Bar
from parflex.robot.fields import given, part
from parflex.robot.leg import Joint, Tip
from parflex.robot.strut import Drive
from parflex.robots.legs.base import LegKind, bar_link, length_of, towards


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class RUS(Drive, LegKind):
    """A crank and a rod; the platform holds the rod by a spherical joint.

    `axis` (3,) in Σ0i is the motor's. Where the joint value is zero the crank is level, in the plane of x
    and y, across the axis; for the axis −y it is along x, and a growing angle lifts it.
    """

    word: ClassVar[str] = "RUS"
    crank: Bar = part(Bar, "the bar from the motor's axis; its length is that to the rod's joint")
    rod: Bar = part(Bar, "the bar from the crank; its length is that between its joints")
    axis: Given = given(
        kinds.NUMBER, "of the motor, in the leg's frame", default=(0.0, -1.0, 0.0), shape=(3,)
    )

    @property
    def joints(self) -> tuple[Joint, ...]:
        """The crank along x1; the cross, of no mass; the rod along x3."""
        return (
            Joint(0, **towards(self.axis, "RUS.axis"), **self.of_joint, **bar_link(self.crank, (1, 0, 0))),
            Joint(1, sigma=0, d=length_of(self.crank, "crank")),
            Joint(2, sigma=0, alpha=np.pi / 2, **bar_link(self.rod, (1, 0, 0))),
        )

    @property
    def tips(self) -> tuple[Tip, ...]:
        """The end of the rod."""
        return (Tip(3, (length_of(self.rod, "rod"), 0, 0)),)
