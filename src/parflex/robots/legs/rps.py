"""The RPS leg: a strut on a hinge, which keeps it in a plane."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from parflex.base import kinds
from parflex.base.held import Given
from parflex.robot.fields import given
from parflex.robot.leg import Joint, Tip
from parflex.robot.strut import Strut
from parflex.robots.legs.base import LegKind, bar_link, rod_end, rod_link, towards


@dataclass(frozen=True, eq=False, repr=False)
class RPS(Strut, LegKind):
    """A strut on a hinge; the platform holds it by a spherical joint.

    `axis` (3,) in Σ0i is that of the hinge: the strut moves in the plane across it.
    """

    word: ClassVar[str] = "RPS"
    axis: Given = given(
        kinds.NUMBER, "of the hinge on the base, in the leg's frame", default=(0.0, 1.0, 0.0), shape=(3,)
    )

    @property
    def joints(self) -> tuple[Joint, ...]:
        """The cylinder along −y1; the rod along z2 (`rod_link`)."""
        return (
            Joint(0, sigma=0, **towards(self.axis, "RPS.axis"), **bar_link(self.cylinder, (0, -1, 0))),
            Joint(1, alpha=np.pi / 2, **self.of_joint, **rod_link(self.rod)),
        )

    @property
    def tips(self) -> tuple[Tip, ...]:
        """The end of the rod."""
        return (Tip(2, rod_end(self.rod)),)
