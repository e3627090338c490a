"""Systems of units of finite-element files, which hold numbers alone."""

from dataclasses import dataclass

from parflex.base.errors import InputError
from parflex.fe.units import FOOT, INCH

POUND_FORCE = 4.4482216152605  # N, by definition

DENSITY = (0.2, 3e4)  # kg/m³, from foam to osmium with room to spare
STIFFEST = 2e12  # N/m², beyond diamond
LIGHTEST = 2.5e5  # E / ρ² of light materials (honeycomb, balsa) stays below, m⁵/(kg s²)
SOFTEST = ((2500.0, 1e9), (1700.0, 1e8), (0.0, 2e6))  # least E of what is denser: metals, PTFE, rubber


@dataclass(frozen=True)
class Units:
    """One unit of length in m, of mass in kg, of time in s; those of all else follow."""

    name: str
    length: float
    mass: float
    time: float = 1.0

    @property
    def density(self) -> float:
        """kg/m³."""
        return self.mass / self.length**3

    @property
    def pressure(self) -> float:
        """N/m²."""
        return self.mass / (self.length * self.time**2)

    @property
    def stiffness(self) -> float:
        """N/m."""
        return self.mass / self.time**2

    @property
    def inertia(self) -> float:
        """kg m²."""
        return self.mass * self.length**2


SYSTEMS = {
    system.name: system
    for system in (
        Units("SI", 1.0, 1.0),
        Units("mm-tonne-s", 1e-3, 1e3),
        Units("mm-kg-ms", 1e-3, 1.0, 1e-3),
        Units("mm-kg-s", 1e-3, 1.0),
        Units("cm-g-s", 1e-2, 1e-3),
        Units("in-lbf", INCH, POUND_FORCE / INCH),
        Units("ft-lbf", FOOT, POUND_FORCE / FOOT),
    )
}


def units_named(name: str) -> Units:
    """The system of units of a file; raises InputError for a name that is missing or unknown."""
    known = ", ".join(f'"{system}"' for system in SYSTEMS)
    if not name:
        raise InputError(f"units is not given; the file does not hold its units: choose one of {known}")
    if name not in SYSTEMS:
        raise InputError(f"units is {name!r}; choose one of {known}")
    return SYSTEMS[name]


def check_material(name: str, density: float, modulus: float | None, units: Units) -> None:
    """Raise InputError where a density or modulus, in the file's units, is that of no material.

    A density of zero is none.
    """
    if density == 0 or material_fits(density, modulus, units):
        return
    made = f"{density * units.density:.3g} kg/m³"
    if modulus is not None:
        made += f" and {modulus * units.pressure:.3g} N/m²"
    likely = [other.name for other in SYSTEMS.values() if material_fits(density, modulus, other)]
    advice = " or ".join(f'"{other}"' for other in likely)
    hint = f"did you mean {advice}?" if likely else f"look at the density of {name} (weight for mass?)"
    raise InputError(f'units is "{units.name}", which makes {name} one of {made}, which nothing has; {hint}')


def material_fits(density: float, modulus: float | None, units: Units) -> bool:
    """True where something has this density and stiffness."""
    rho = density * units.density
    if not DENSITY[0] <= rho <= DENSITY[1]:
        return False
    if modulus is None:
        return True
    E = modulus * units.pressure
    least = next(modulus for density, modulus in SOFTEST if rho >= density)
    return least <= E <= min(STIFFEST, LIGHTEST * rho**2)
