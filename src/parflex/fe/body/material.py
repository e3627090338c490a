"""What a solid is made of."""

from dataclasses import dataclass

from parflex.base.check import positive, scalar
from parflex.base.errors import InputError


@dataclass(frozen=True)
class Material:
    """Young's modulus Pa, Poisson's ratio, density kg/m³."""

    young: float
    poisson: float
    density: float

    def __post_init__(self) -> None:
        positive("Material.young", self.young)
        positive("Material.density", self.density)
        if not -1 < scalar("Material.poisson", self.poisson) < 0.5:
            raise InputError(f"Material.poisson is {self.poisson}; it must lie between -1 and 0.5")

    @property
    def lame(self) -> tuple[float, float]:
        """λ and μ, Pa."""
        E, nu = self.young, self.poisson
        return E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
