"""Numbers that carry their derivatives: the mechanics run on them differentiates itself, exactly.

Their values may be floats or symbols, so that derivatives are traced like everything else.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from parflex.base.array import Array


class Dual:
    """A value and its derivatives with respect to d seeds."""

    __slots__ = ("parts", "value")

    def __init__(self, value: Any, parts: Sequence[Any]) -> None:
        self.value, self.parts = value, parts

    def __add__(self, other: Any) -> "Dual":
        if isinstance(other, Dual):
            return Dual(
                self.value + other.value, [a + b for a, b in zip(self.parts, other.parts, strict=True)]
            )
        if isinstance(other, np.ndarray):
            return NotImplemented
        return Dual(self.value + other, self.parts)

    __radd__ = __add__

    def __neg__(self) -> "Dual":
        return Dual(-self.value, [-a for a in self.parts])

    def __sub__(self, other: Any) -> "Dual":
        return self + (-other)

    def __rsub__(self, other: Any) -> "Dual":
        return (-self) + other

    def __mul__(self, other: Any) -> Any:
        if isinstance(other, Dual):
            u, v = self.value, other.value
            return Dual(u * v, [a * v + b * u for a, b in zip(self.parts, other.parts, strict=True)])
        if isinstance(other, np.ndarray):
            return NotImplemented
        if other == 0:
            return 0.0
        return Dual(self.value * other, [a * other for a in self.parts])

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Any:
        if isinstance(other, Dual):
            return self * other._inverse()
        return self * (1.0 / other)

    def __rtruediv__(self, other: Any) -> Any:
        return self._inverse() * other

    def _inverse(self) -> "Dual":
        one = 1.0 / self.value
        return self._chain(one, -(one * one))

    def sqrt(self) -> "Dual":
        root = called("sqrt", self.value)
        return self._chain(root, 0.5 / root)

    def cos(self) -> "Dual":
        return self._chain(called("cos", self.value), -called("sin", self.value))

    def sin(self) -> "Dual":
        return self._chain(called("sin", self.value), called("cos", self.value))

    def arctan2(self, other: Any) -> "Dual":
        x = other if isinstance(other, Dual) else Dual(other, [0.0] * len(self.parts))
        y, square = self.value, self.value * self.value + x.value * x.value
        angle = y.arctan2(x.value) if hasattr(y, "arctan2") else math.atan2(y, x.value)
        left, right = x.value / square, y / square
        return Dual(angle, [a * left - b * right for a, b in zip(self.parts, x.parts, strict=True)])

    def _chain(self, value: Any, slope: Any) -> "Dual":
        return Dual(value, [a * slope for a in self.parts])


def called(name: str, value: Any) -> Any:
    """A function of a float or of a symbol."""
    return getattr(value, name)() if hasattr(value, name) else getattr(math, name)(value)


def jacobian(function: Callable[[Array], Array], x: Array) -> Array:
    """∂function/∂x (…, m, d) of a function (…, d) -> (…, m), floats or symbols."""
    d = x.shape[-1]
    units = np.eye(d).tolist()
    seeded = np.empty(x.shape, dtype=object)
    for place in np.ndindex(x.shape):
        value = x[place]
        seeded[place] = Dual(value if x.dtype == object else float(value), units[place[-1]])
    found = function(seeded)
    none = [0.0] * d
    out = np.empty((*found.shape, d), dtype=object)
    for place in np.ndindex(found.shape):
        entry = found[place]
        out[place] = entry.parts if isinstance(entry, Dual) else none
    return out if x.dtype == object else out.astype(float)
