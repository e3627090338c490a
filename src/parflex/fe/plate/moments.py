"""The inertia integrals of a plate that moves as (−z ∂w/∂x, −z ∂w/∂y, w)."""

from typing import NamedTuple

import numpy as np
import skfem

from parflex.base.array import Array
from parflex.fe.plate.section import Section
from parflex.robot.moments import Moments


class PlateFields(NamedTuple):
    """Deflection and slope of the modes at points (2, P)."""

    w: Array  # (N, P)
    slope: Array  # (N, 2, P)


def quadrature(basis: skfem.Basis) -> tuple[Array, Array]:
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
