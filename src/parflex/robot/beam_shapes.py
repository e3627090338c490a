"""Shapes of a slender bar that is clamped at one end: families of functions of ξ = s/ℓ, made orthonormal."""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array

QUADRATURE = 96  # Gauss points along a bar: exact to round-off for all products of MOST half-waves

_points, _weights = np.polynomial.legendre.leggauss(QUADRATURE)
POINTS, WEIGHTS = 0.5 * (_points + 1.0), 0.5 * _weights  # on 0 … 1


class Family(NamedTuple):
    """Functions of ξ (n, P) with their first and second derivatives."""

    value: Array
    first: Array
    second: Array


def clamped(xi: Array, sines: int, static: bool) -> Family:
    """sin kπξ − kπξ, k = 1 … n, whose values and slopes vanish at ξ = 0; static adds ξ² and ξ³, the shapes
    of a force and of a moment at the end."""
    k = np.pi * np.arange(1, sines + 1)[:, None]
    found = Family(np.sin(k * xi) - k * xi, k * np.cos(k * xi) - k, -(k**2) * np.sin(k * xi))
    if not static:
        return found
    cubic = Family(*(np.stack(rows) for rows in ((xi**2, xi**3), (2 * xi, 3 * xi**2), (0 * xi + 2, 6 * xi))))
    return Family(*(np.concatenate(both) for both in zip(found, cubic, strict=True)))


def held(xi: Array, count: int) -> Family:
    """ξ, of a pull at the end, and sin (k − ½)πξ, of a bar that is free there: they vanish at ξ = 0."""
    k = np.pi * (np.arange(1, count)[:, None] - 0.5)
    sines = Family(np.sin(k * xi), k * np.cos(k * xi), -(k**2) * np.sin(k * xi))
    linear = (xi[None], 0 * xi[None] + 1, 0 * xi[None])
    return Family(*(np.concatenate(both)[:count] for both in zip(linear, sines, strict=True)))


def orthonormal(mass: Array, stiffness: Array) -> tuple[Array, Array]:
    """Combinations T (n, n) of shapes for which Tᵀ Bᵀ B T = 1 and Tᵀ Cᵀ C T = diag ω², and ω (n,), from low
    to high; B (P, n) and C (P', n) are samples of what their energies are squares of.

    By B = Q R and the singular values of C R⁻¹, which does not square the condition of the shapes.
    """
    R = np.linalg.qr(mass, mode="r")
    inverse = np.linalg.inv(R)
    omega, V = np.linalg.svd(stiffness @ inverse, full_matrices=False)[1:]
    T = (inverse @ V.T)[:, ::-1]
    samples = mass @ T
    largest = np.take_along_axis(samples, np.argmax(np.abs(samples), axis=0)[None], axis=0)[0]
    return T * np.where(largest < 0, -1.0, 1.0), omega[::-1]


def sampled(*parts: tuple[float, Array]) -> Array:
    """Rows (P, n) whose sum of squares is Σ c ∫ f² dξ of functions (n, P) at the Gauss points."""
    return np.concatenate([(np.sqrt(c * WEIGHTS) * f).T for c, f in parts])
