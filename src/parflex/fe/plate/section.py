"""A plate's section, weak forms and inertia integrals: Kirchhoff's theory with rotary inertia.

Points of it move as (−z ∂w/∂x, −z ∂w/∂y, w).

(D [(1 − ν) ∇∇w:∇∇v + ν Δw Δv], a w v + b ∇w·∇v), a = ρh, b = ρh³/12, D = E h³ / 12 (1 − ν²)
"""

from typing import Any, NamedTuple

import numpy as np
import skfem
from skfem.helpers import dd, ddot, dot, grad, trace

from parflex.base.array import Array
from parflex.base.check import positive
from parflex.robot.material import Material
from parflex.robot.moments import Moments


class Section(NamedTuple):
    """The mass and stiffness of a plate, per area."""

    a: float  # mass, kg/m²
    b: float  # rotary inertia, kg
    D: float  # bending stiffness, N m
    poisson: float


def plate_section(thickness: float, made_of: Material) -> Section:
    """The section of a plate. Raises InputError for a thickness that no plate has."""
    h, E, rho, nu = positive("thickness", thickness), made_of.young, made_of.density, made_of.poisson
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


class PlateFields(NamedTuple):
    """Deflection and slope of the modes at points (2, P)."""

    w: Array  # (N, P)
    slope: Array  # (N, 2, P)


def plate_quadrature(basis: skfem.Basis) -> tuple[Array, Array]:
    """Points (2, Q) and weights (Q,) that integrate products of the shapes exactly."""
    return np.asarray(basis.global_coordinates()).reshape(2, -1), basis.dx.reshape(-1)


def sampled(basis: skfem.Basis, vectors: Array) -> PlateFields:
    """The modes at the quadrature points."""
    modes = vectors.shape[1]
    interpolated = [basis.interpolate(column) for column in vectors.T]
    return PlateFields(
        np.array([np.asarray(f) for f in interpolated]).reshape(modes, basis.dx.size),
        np.array([f.grad for f in interpolated]).reshape(modes, 2, basis.dx.size),
    )


def plate_moments(fields: PlateFields, section: Section, x: Array, dx: Array) -> Moments:
    """The inertia integrals, with a = ρh and b = ρh³/12."""
    a, b, (w, slope) = section.a, section.b, fields
    area, N = float(np.sum(dx)), len(w)
    r = np.concatenate([x, np.zeros_like(x[:1])])
    P0 = a * (r * dx) @ r.T
    P0[2, 2] += b * area
    S, P1, P2 = np.zeros((3, N)), np.zeros((N, 3, 3)), np.zeros((N, N, 3, 3))
    S[2] = a * w @ dx
    P1[:, 2, :] = a * (w * dx) @ r.T
    P1[:, :2, 2] = -b * slope @ dx
    P2[:, :, 2, 2] = a * (w * dx) @ w.T
    P2[:, :, :2, :2] = b * np.einsum("iap,jbp->ijab", slope * dx, slope, optimize=True)
    return Moments(a * area, a * r @ dx, P0, S, P1, P2)
