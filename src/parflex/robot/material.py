"""An isotropic material."""

from dataclasses import dataclass

from parflex.base.check import positive, scalar
from parflex.base.errors import InputError
from parflex.base.plausible import doubt

YOUNG, DENSITY = (5e8, 1.3e12), (100.0, 23e3)  # Pa, kg/m³: between plastics and diamond, foams and osmium
PSI, LB_IN3 = 6894.757, 27679.9  # Pa, kg/m³


@dataclass(frozen=True)
class Material:
    """Young's modulus Pa, Poisson's ratio, density kg/m³; its name and the source of its numbers, if they
    have one."""

    young: float
    poisson: float
    density: float
    name: str = ""
    source: str = ""

    def __post_init__(self) -> None:
        positive("Material.young", self.young)
        positive("Material.density", self.density)
        if not -1 < scalar("Material.poisson", self.poisson) < 0.5:
            raise InputError(f"Material.poisson is {self.poisson}; it must lie between -1 and 0.5")
        unusual("young", self.young, "Pa", YOUNG, (("GPa", 1e9), ("MPa", 1e6), ("psi", PSI)))
        units = (("g/cm^3", 1e3), ("kg/mm^3", 1e9), ("t/mm^3", 1e12), ("lb/in^3", LB_IN3), ("g/m^3", 1e-3))
        unusual("density", self.density, "kg/m^3", DENSITY, units)
        if self.poisson < 0:
            doubt(f"poisson is {self.poisson}, as of foams alone; did you mean {-self.poisson}?")

    @property
    def lame(self) -> tuple[float, float]:
        """The moduli λ and μ, Pa."""
        E, nu = self.young, self.poisson
        return E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))

    def __str__(self) -> str:
        numbers = f"E = {self.young:.6g} N/m², ν = {self.poisson:.6g}, ρ = {self.density:.6g} kg/m³"
        source = f" ({self.source})" if self.source else ""
        return f"{self.name}: {numbers}{source}" if self.name else numbers


def unusual(
    name: str,
    value: float,
    unit: str,
    usual: tuple[float, float],
    slips: tuple[tuple[str, float], ...],
) -> None:
    """Doubt a number that no material of machines has; a slip is a unit that it may be in."""
    least, most = usual
    if not least <= value <= most:
        meant = [slip for slip, factor in slips if least <= value * factor <= most]
        hint = f'did you mean "{value:.6g} {meant[0]}"?' if meant else "is its unit right?"
        beyond = "less" if value < least else "more"
        doubt(f"{name} is {value:.6g} {unit}, {beyond} than any material of machines has; {hint}")
