"""A move round a circle, entered and left smoothly."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from parflex.base import kinds
from parflex.base.array import Array, cross
from parflex.base.check import POSITIVE
from parflex.base.errors import InputError
from parflex.base.held import Given, Held
from parflex.kernels.segment import CONSTANT, Segment, resting
from parflex.robot.words import listed
from parflex.simulation.moves.move import Move, Pose, entry

STEADY = np.array([0.0, 1.0, 0.0, 0.0, 0.0, 0.0])
ENTERING = np.array([0.0, 0.0, 0.0, 1.0, -0.5, 0.0])  # ∫ 3 τ² − 2 τ³, the growing rate
SHORT = 1e-12  # of the time that the turns take: round-off
ALIGNED = 1e-6  # sine of the angle between directions that are one
X, Y, NEAR = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]), 0.9  # cosine between a normal and x


@dataclass(frozen=True, eq=False, repr=False)
class Circle(Move):
    """Go round a circle of `radius` m through the pose, `turns` times at `frequency` turns per second (Hz).

    The circle is right-handed about `normal` (3,), and its centre is seen from the start in the direction
    `centre` (3,), of which the part in the circle's plane counts: by default the world's x, or y where x is
    the normal. Both are directions in the world. The orientation stays. The rate grows from rest over `ramp`
    seconds, by default a period, as 3 τ² − 2 τ³, and falls likewise in the end; between the two it is
    constant. All takes turns / frequency + ramp seconds.

    Raises InputError for a radius, a frequency, turns or a ramp that is not positive, a normal of length
    zero, a centre along the normal, and a ramp that is longer than the turns take.
    """

    word = "circle"
    about = "Round a circle through the pose, entered and left smoothly."

    radius: float = entry(kinds.LENGTH, "of the circle", POSITIVE)
    frequency: float = entry(kinds.FREQUENCY, "turns per second", POSITIVE)
    turns: float = entry(kinds.NUMBER, "how often it goes round", POSITIVE, default=1.0)
    normal: Given = entry(
        kinds.NUMBER, "direction in the world about which it turns", default=(0.0, 0.0, 1.0), shape=(3,)
    )
    centre: Held[ArrayLike | None, Array | None] = entry(
        kinds.NUMBER,
        "direction in the world from the start to the centre; by default x",
        default=None,
        shape=(3,),
    )
    ramp: Held[float | None, float] = entry(
        kinds.TIME, "time in which it comes to its frequency; by default a period", POSITIVE, default=None
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.ramp is None:
            object.__setattr__(self, "ramp", min(1.0, self.turns) / self.frequency)
        lap = self.turns / self.frequency
        if self.ramp > lap * (1 + SHORT):
            raise InputError(
                f"Circle.ramp is {self.ramp:.6g} s, longer than turns / frequency, {lap:.6g} s; give a "
                f"shorter one, or more turns"
            )
        self._directions()

    @property
    def duration(self) -> float:
        """s, with both ramps."""
        return self.turns / self.frequency + self.ramp

    def segments(self, start: Pose) -> list[Segment]:
        inward, ahead = (np.array([*(self.radius * way), 0.0]) for way in self._directions())
        steady = self.turns / self.frequency - self.ramp
        gained = np.pi * self.frequency * self.ramp  # in a ramp
        last = 2 * np.pi * self.turns - gained
        phases = [
            (self.ramp, 2 * gained * ENTERING),
            (steady, gained * CONSTANT + 2 * np.pi * self.frequency * steady * STEADY),
            (self.ramp, last * CONSTANT + 2 * gained * (STEADY - ENTERING)),
        ]
        still = resting(*start)
        return [
            still._replace(span=np.asarray(span), phase=phase, versine=inward, sine=ahead)
            for span, phase in phases
            if span > SHORT * self.duration
        ]

    def _directions(self) -> tuple[Array, Array]:
        """Unit vectors from the start to the centre and ahead."""
        length = np.linalg.norm(self.normal)
        if length == 0:
            raise InputError("Circle.normal is zero; give a direction, such as (0, 0, 1)")
        normal = self.normal / length
        centre = self.centre
        if centre is None:
            centre = X if abs(normal[0]) < NEAR else Y
        across = centre - (centre @ normal) * normal
        size = np.linalg.norm(across)
        if size <= ALIGNED * np.linalg.norm(centre):
            raise InputError(
                f"Circle.centre is {listed(centre)}, and the normal {listed(self.normal)}; give a direction "
                f"across the normal"
            )
        return across / size, cross(across / size, normal)
