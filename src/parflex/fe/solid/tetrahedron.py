"""The element: shape functions of the ten-node tetrahedron, their gradients, and quadrature."""

from typing import NamedTuple

import numpy as np
import skfem
from skfem.quadrature import get_quadrature

from parflex.base.array import Array


class Points(NamedTuple):
    """Reference points: weights (Q,), shape functions (Q, 10) and their derivatives (Q, 10, 3)."""

    weights: Array
    values: Array
    slopes: Array


def at(X: Array, weights: Array | None = None) -> Points:
    """Shape functions at reference coordinates (3, Q)."""
    element = skfem.ElementTetP2()
    values, slopes = zip(*(element.lbasis(X, i) for i in range(10)), strict=True)
    ones = np.ones(X.shape[1])
    return Points(
        ones if weights is None else weights,
        np.stack([value + 0.0 * ones for value in values], axis=-1),
        np.stack([np.broadcast_to(slope, X.shape).T for slope in slopes], axis=1),
    )


def quadrature(order: int) -> Points:
    """Points that integrate polynomials of that order."""
    return at(*get_quadrature(skfem.ElementTetP2, order))


def vertices_and_middles() -> Points:
    """The element's own ten nodes."""
    return at(skfem.ElementTetP2.doflocs.T)


def jacobians(x: Array, points: Points) -> Array:
    """∂x/∂X (E, Q, 3, 3) of elements with nodes x (E, 10, 3)."""
    return np.einsum("eia,qib->eqab", x, points.slopes, optimize=True)


def gradients(x: Array, points: Points) -> tuple[Array, Array]:
    """∇N_i (E, Q, 10, 3) and the volumes dV (E, Q)."""
    J = jacobians(x, points)
    inverse = np.linalg.inv(J)
    return np.einsum("qib,eqba->eqia", points.slopes, inverse, optimize=True), np.linalg.det(
        J
    ) * points.weights
