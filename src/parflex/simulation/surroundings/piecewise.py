"""Polynomials on the stretches between samples, from splines through the samples or their derivatives."""

import math
from typing import NamedTuple

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from parflex.base.array import Array

THROUGH = (5, 5, 3)  # the degree of a spline through values, first and second derivatives
FEWEST = max(THROUGH) + 1  # samples that determine them
POWERS = np.arange(THROUGH[1] + 2)  # of the polynomials, the highest of those that are integrated
WEIGHTS = np.stack([np.eye(len(POWERS), k=k) for k in range(3)])  # of powers in a value and two derivatives
WEIGHTS[1] *= POWERS
WEIGHTS[2] *= POWERS * (POWERS - 1)


class Piecewise(NamedTuple):
    """Functions of time, on each stretch polynomials of the time since it began."""

    t: Array  # (T,) s, where stretches begin, and the end
    coefficients: Array  # (T − 1, 7, d), by ascending powers

    def at(self, t: Array) -> Array:
        """Values, first and second derivatives (…, 3, d) at times (…,)."""
        stretch = np.clip(np.searchsorted(self.t, t, side="right") - 1, 0, len(self.t) - 2)
        powers = np.asarray(t - self.t[stretch])[..., None] ** POWERS
        found: Array = np.moveaxis(powers @ WEIGHTS, 0, -2) @ self.coefficients[stretch]
        return found

    def __add__(self, other: object) -> "Piecewise":
        """The sum of functions on the same stretches."""
        assert isinstance(other, Piecewise)
        return Piecewise(self.t, self.coefficients + other.coefficients)

    def beside(self, other: "Piecewise") -> "Piecewise":
        """These functions, and behind them others on the same stretches."""
        return Piecewise(self.t, np.concatenate([self.coefficients, other.coefficients], axis=-1))


def through(t: Array, samples: Array, order: int = 0) -> Piecewise:
    """The functions whose derivative of this order (0, 1 or 2) has samples (T, d), by a spline through them.

    Those that are integrated begin at zero.
    """
    spline: BSpline = make_interp_spline(t, samples, THROUGH[order])
    for _ in range(order):
        spline = spline.antiderivative()
    parts = [spline(t[:-1], nu=k) / math.factorial(k) for k in POWERS]
    return Piecewise(t, np.stack(parts, axis=1))
