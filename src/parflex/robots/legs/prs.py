"""The PRS leg: a motor moves a carriage on a rail, on which a rod hangs by a hinge."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from parflex.base import kinds
from parflex.base.held import Given
from parflex.robot.fields import given
from parflex.robot.leg import Joint, Tip
from parflex.robots.legs.base import LegKind, bar_link, length_of, towards
from parflex.robots.legs.rail import RAIL, Railed


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class PRS(Railed, LegKind):
    """A carriage of mass `carriage` kg and a rod; the platform holds the rod by a spherical joint.

    `rail` (3,) in Σ0i is the direction in which the joint value grows, from the origin. The hinge lies
    across it: along y for an upright rail, so that the leg moves in the plane of x and z.
    """

    word: ClassVar[str] = "PRS"
    rail: Given = given(kinds.NUMBER, RAIL, default=(0.0, 0.0, 1.0), shape=(3,))

    @property
    def joints(self) -> tuple[Joint, ...]:
        """The carriage along its rail; the rod along x2."""
        return (
            Joint(0, **towards(self.rail, "PRS.rail"), **self.of_joint, M=self.carriage),
            Joint(1, sigma=0, alpha=-np.pi / 2, **bar_link(self.rod, (1, 0, 0))),
        )

    @property
    def tips(self) -> tuple[Tip, ...]:
        """The end of the rod."""
        return (Tip(2, (length_of(self.rod, "rod"), 0, 0)),)
