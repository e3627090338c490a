"""The arm of a Delta: a motor turns it, and two parallel rods hang on it by universal joints."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from parflex.base import kinds
from parflex.base.check import POSITIVE
from parflex.base.held import Given
from parflex.robot.bar import Bar
from parflex.robot.fields import given, part
from parflex.robot.leg import Joint, Tip
from parflex.robot.strut import Drive
from parflex.robots.legs.base import LegKind, bar_link, length_of, towards


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class DeltaArm(Drive, LegKind):
    """An arm and two rods, `spacing` m apart along its axis; two spherical joints on the platform.

    `axis` (3,) in Σ0i is the motor's. Where the joint value is zero the arm is level, in the plane of x and
    y, across the axis; for the axis y it is along x, and a growing angle lowers it. The first of the two
    attachments is that of the rod at −`spacing`/2 along the axis.
    """

    word: ClassVar[str] = "Delta"
    arm: Bar = part(Bar, "the bar from the motor's axis; its length is that to the rods' joints")
    rod: Bar = part(Bar, "the bar from the arm, twice; its length is that between its joints")
    spacing: float = given(kinds.LENGTH, "the distance between the two rods", POSITIVE)
    axis: Given = given(kinds.NUMBER, "of the motor, in the leg's frame", default=(0.0, 1.0, 0.0), shape=(3,))

    @property
    def joints(self) -> tuple[Joint, ...]:
        """The arm along x1; twice a cross of no mass and a rod along its x."""
        rod, out = bar_link(self.rod, (1, 0, 0)), length_of(self.arm, "arm")
        return (
            Joint(0, **towards(self.axis, "DeltaArm.axis"), **self.of_joint, **bar_link(self.arm, (1, 0, 0))),
            Joint(1, sigma=0, d=out, r=-self.spacing / 2),
            Joint(2, sigma=0, alpha=np.pi / 2, **rod),
            Joint(1, sigma=0, d=out, r=self.spacing / 2),
            Joint(4, sigma=0, alpha=np.pi / 2, **rod),
        )

    @property
    def tips(self) -> tuple[Tip, ...]:
        """The ends of the rods."""
        end = (length_of(self.rod, "rod"), 0, 0)
        return Tip(3, end), Tip(5, end)
