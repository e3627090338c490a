"""A straight bar of a leg: its mass and inertia, given as numbers or by its dimensions."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from parflex.base import kinds
from parflex.base.check import NOT_NEGATIVE, POSITIVE
from parflex.base.errors import InputError
from parflex.base.held import Given, MaybeGiven
from parflex.robot.beam import Beam
from parflex.robot.fields import check_fields, count, flag, given, ratios
from parflex.robot.words import told

NO_BODY = "it is no body's: the first cannot be more than twice the second"


@dataclass(frozen=True, eq=False)
class Bar:
    """A straight bar that begins at a joint of a leg, round or slender, SI units.

    Its mass (kg), the distance `com` (m) of its centre of mass from its joint, and its inertia (2,) kg m²
    about the centre of mass, along its axis and across it; or its dimensions: outer and inner diameter,
    length (m), and its density (kg/m³) or mass. The centre of mass of a straight bar is by default in its
    middle; one of a mass and a length alone is slender.

    One with `young`, Young's modulus in Pa, is flexible: with `bending` shapes in each of two planes, `axial`
    and `torsion` ones, which needs `poisson`, and those of `static`, as in `beam`. It then has dimensions.

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
    young: float | None = given(kinds.PRESSURE, "Young's modulus of one that bends", POSITIVE, default=None)
    poisson: float | None = given(kinds.NUMBER, "Poisson's ratio, for torsion", default=None)
    bending: int | None = count("shapes in each of two planes; with young by default 1", default=None)
    axial: int = count("shapes along it")
    torsion: int = count("shapes about it")
    static: bool = flag("add the bending shapes of a force and a moment at the end", default=False)
    damping_ratio: Given = ratios("one for all its modes, or one for each")

    def __post_init__(self) -> None:
        check_fields(self)
        if self.flexible:
            check_flexible(self)
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
        if self.flexible:
            beam_of(self, (0.0, 0.0, 1.0))  # raises
        along, across = self.inertia_at_com
        if along > 2 * across * (1 + 1e-9):
            raise InputError(f"Bar.inertia is {[along, across]}, along and across; {NO_BODY}")

    __repr__ = told

    @property
    def flexible(self) -> bool:
        """True where it bends, stretches or twists."""
        shapes = (self.bending, self.axial, self.torsion, self.static)
        return any(shapes) or (self.young is not None and self.bending is None)

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


def check_flexible(bar: Bar) -> None:
    """Raise InputError where a bar that bends lacks dimensions or moduli, or has numbers of a rigid one."""
    for name in ("com", "inertia"):
        if getattr(bar, name) is not None:
            raise InputError(
                f"Bar.{name} is given, but a bar that bends has that of its dimensions; leave it out, or "
                f"young and the shapes"
            )
    for name, words in (("outer", "diameter"), ("length", "length"), ("young", "modulus")):
        if getattr(bar, name) is None:
            raise InputError(
                f"Bar.{name} is missing; a bar that bends needs outer, length and young: give its {words}"
            )
    if bar.torsion and bar.poisson is None:
        raise InputError(f"Bar.poisson is missing, but torsion is {bar.torsion}; give Poisson's ratio")


def beam_of(bar: Bar, along: ArrayLike) -> Beam:
    """The beam that a flexible bar is, from its joint along a unit vector (3,)."""
    assert bar.length is not None
    assert bar.young is not None
    outer, inner = bar.diameters
    volume = np.pi * (outer**2 - inner**2) / 4 * bar.length
    return Beam(
        end=bar.length * np.asarray(along, dtype=float),
        outer=outer,
        inner=inner,
        young=bar.young,
        poisson=bar.poisson or 0.0,  # which acts in torsion alone
        density=bar.kilograms / volume if bar.density is None else bar.density,
        bending=1 if bar.bending is None else bar.bending,
        axial=bar.axial,
        torsion=bar.torsion,
        static=bar.static,
        damping_ratio=bar.damping_ratio,
    )
