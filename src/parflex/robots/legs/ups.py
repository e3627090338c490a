"""The UPS leg: a strut on a universal joint."""

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
class UPS(Strut, LegKind):
    """A strut on a universal joint whose cross has no mass; the platform holds it by a spherical joint.

    `axis` (3,) in Σ0i is the axis of the universal joint that is fixed to the base: the leg must not lie
    along it.
    """

    word: ClassVar[str] = "UPS"
    axis: Given = given(
        kinds.NUMBER,
        "of the universal joint on the base, in the leg's frame",
        default=(0.0, 1.0, 0.0),
        shape=(3,),
    )

    @property
    def joints(self) -> tuple[Joint, ...]:
        """The cross; the cylinder along −y2; the rod along z3 (`rod_link`)."""
        return (
            Joint(0, sigma=0, **towards(self.axis, "UPS.axis")),
            Joint(1, sigma=0, alpha=np.pi / 2, **bar_link(self.cylinder, (0, -1, 0))),
            Joint(2, alpha=np.pi / 2, **self.of_joint, **rod_link(self.rod)),
        )

    @property
    def tips(self) -> tuple[Tip, ...]:
        """The end of the rod."""
        return (Tip(3, rod_end(self.rod)),)
