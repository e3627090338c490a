"""The section of a plate, and the weak forms of Kirchhoff's theory with rotary inertia.

(D [(1 − ν) ∇∇w:∇∇v + ν Δw Δv], a w v + b ∇w·∇v), a = ρh, b = ρh³/12, D = E h³ / 12 (1 − ν²)
"""

from typing import Any, NamedTuple

import skfem
from skfem.helpers import dd, ddot, dot, grad, trace

from parflex.base.check import positive, scalar
from parflex.base.errors import InputError


class Section(NamedTuple):
    """The mass and stiffness of a plate, per area."""

    a: float  # mass, kg/m²
    b: float  # rotary inertia, kg
    D: float  # bending stiffness, N m
    poisson: float


def plate_section(thickness: float, young: float, poisson: float, density: float) -> Section:
    """The section of a plate. Raises InputError for values that no plate has."""
    h, E = positive("thickness", thickness), positive("young", young)
    rho, nu = positive("density", density), scalar("poisson", poisson)
    if not -1 < nu < 0.5:
        raise InputError(f"poisson is {nu}; it must lie between -1 and 0.5")
    return Section(rho * h, rho * h**3 / 12, E * h**3 / (12 * (1 - nu**2)), nu)


def rigid_load(section: Section, c: float, c_x: float, c_y: float) -> skfem.LinearForm:
    """The form a w v + b ∇w·∇v of w = c + c_x x + c_y y."""

    @skfem.LinearForm
    def load(v: Any, at: Any) -> Any:
        w = c + c_x * at.x[0] + c_y * at.x[1]
        return section.a * w * v + section.b * (c_x * grad(v)[0] + c_y * grad(v)[1])

    return load


def bending_form(section: Section) -> skfem.BilinearForm:
    """The form D [(1 − ν) ∇∇w:∇∇v + ν Δw Δv]."""

    @skfem.BilinearForm
    def bending(u: Any, v: Any, _: Any) -> Any:
        nu = section.poisson
        return section.D * ((1 - nu) * ddot(dd(u), dd(v)) + nu * trace(dd(u)) * trace(dd(v)))

    return bending


def inertia_form(section: Section) -> skfem.BilinearForm:
    """The form a w v + b ∇w·∇v."""

    @skfem.BilinearForm
    def inertia(u: Any, v: Any, _: Any) -> Any:
        return section.a * u * v + section.b * dot(grad(u), grad(v))

    return inertia
