"""Isotropic materials, and the solids that are made of them."""

from dataclasses import dataclass
from typing import NamedTuple

from parflex.base.array import Array
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
        """The moduli λ and μ, Pa."""
        E, nu = self.young, self.poisson
        return E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))


class Solid(NamedTuple):
    """The data that stresses are computed from: elements (E, 10) of node numbers, the part (E,) that each
    belongs to, and a material for all parts or one for each."""

    elements: Array
    parts: Array
    materials: tuple[Material, ...]

    def by_element(self, values: Array) -> Array:
        """The rows (E, …) of a table (1 or more, …) of values for each material."""
        return values[self.parts if len(values) > 1 else 0 * self.parts]
