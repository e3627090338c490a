"""A straight bar of a leg: its mass and inertia, given as numbers or by its dimensions."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from parflex.base import kinds
from parflex.base.check import NOT_NEGATIVE, POSITIVE
from parflex.base.errors import InputError
from parflex.base.held import MaybeGiven
from parflex.robot.fields import check_fields, given
from parflex.robot.words import told

NO_BODY = "it is no body's: the first cannot be more than twice the second"


@dataclass(frozen=True, eq=False)
class Bar:
    """A straight bar that begins at a joint of a leg, round or slender, SI units.

    Its mass (kg), the distance `com` (m) of its centre of mass from its joint, and its inertia (2,) kg m²
    about the centre of mass, along its axis and across it; or its dimensions: outer and inner diameter,
    length (m), and its density (kg/m³) or mass. The centre of mass of a straight bar is by default in its
    middle; one of a mass and a length alone is slender.

    Raises InputError for what is missing, said twice, or no body's.

    >>> along, across = Bar(outer=0.01, length=0.05, mass=0.1).inertia_at_com
    >>> round(along, 9), round(across, 9)
    (1.25e-06, 2.1458e-05)
    """

    mass: float | None = given(kinds.MASS, "in kg", POSITIVE, default=None)
    com: float | None = given(
        kinds.LENGTH, "distance of the centre of mass from the bar's joint", default=None
    )
    inertia: MaybeGiven = given(
        kinds.INERTIA,
        "about the centre of mass: along the bar's axis, and across it",
        NOT_NEGATIVE,
        default=None,
        shape=(2,),
    )
    outer: float | None = given(kinds.LENGTH, "outer diameter", POSITIVE, default=None)
    inner: float | None = given(kinds.LENGTH, "inner diameter of a tube", NOT_NEGATIVE, default=None)
    length: float | None = given(kinds.LENGTH, "from its joint to its other end", POSITIVE, default=None)
    density: float | None = given(kinds.DENSITY, "instead of mass", POSITIVE, default=None)

    def __post_init__(self) -> None:
        check_fields(self)
        if self.inner is not None and self.outer is None:
            raise InputError(f"Bar.inner is {self.inner}, without outer; give the outer diameter, too")
        if self.inner is not None and not self.inner < (self.outer or 0.0):
            raise InputError(f"Bar.inner is {self.inner}; it must be less than outer, which is {self.outer}")
        if self.mass is not None and self.density is not None:
            raise InputError(f"Bar.density is {self.density}, beside mass; keep one of them")
        if self.mass is None and None in (self.density, self.outer, self.length):
            raise InputError("Bar.mass is missing; give it, or all of outer, length and density")
        if self.length is None and (self.com is None or self.inertia is None):
            missing = "com" if self.com is None else "inertia"
            raise InputError(
                f"Bar.{missing} is missing; give com and inertia, or the length of a straight bar"
            )
        along, across = self.inertia_at_com
        if along > 2 * across * (1 + 1e-9):
            raise InputError(f"Bar.inertia is {[along, across]}, along and across; {NO_BODY}")

    __repr__ = told

    @cached_property
    def kilograms(self) -> float:
        """The mass, kg."""
        outer, inner = self.diameters
        volume = np.pi * (outer**2 - inner**2) / 4 * (self.length or 0.0)
        return (self.density or 0.0) * volume if self.mass is None else self.mass

    @cached_property
    def centre(self) -> float:
        """The distance of the centre of mass from the bar's joint, m."""
        return self.com if self.com is not None else (self.length or 0.0) / 2

    @cached_property
    def inertia_at_com(self) -> tuple[float, float]:
        """The inertia about the centre of mass along and across, kg m²: m (d_o² + d_i²)/8, and of that half
        and m ℓ²/12."""
        if self.inertia is not None:
            return float(self.inertia[0]), float(self.inertia[1])
        outer, inner = self.diameters
        round_, length = (outer**2 + inner**2) / 8, self.length or 0.0
        return self.kilograms * round_, self.kilograms * (round_ / 2 + length**2 / 12)

    @cached_property
    def diameters(self) -> tuple[float, float]:
        """Outer and inner diameter, m; zero where they are not given."""
        return self.outer or 0.0, self.inner or 0.0
