"""The scalar that traces the mechanics: a carrier around `casadi.SX` that folds 0 and 1."""

from typing import Union

import casadi
import numpy as np

from parflex.base.array import Array

OP_ADD, OP_SUB, OP_MUL, OP_DIV = casadi.OP_ADD, casadi.OP_SUB, casadi.OP_MUL, casadi.OP_DIV
OP_NEG, OP_SQRT, OP_COS, OP_SIN = casadi.OP_NEG, casadi.OP_SQRT, casadi.OP_COS, casadi.OP_SIN
OP_ATAN2 = casadi.OP_ATAN2
unary, binary = casadi.SX.unary, casadi.SX.binary  # five times as quick as the operators

Number = Union["Symbol", float]
NUMBER = (float, int, np.number)


class Symbol:
    """A scalar expression. Constants stay Python floats, so that what is known is never stored."""

    __slots__ = ("x",)

    def __init__(self, x: casadi.SX) -> None:
        self.x = x

    def __add__(self, other: Number) -> "Symbol":
        if isinstance(other, Symbol):
            return Symbol(binary(OP_ADD, self.x, other.x))
        if not isinstance(other, NUMBER):
            return NotImplemented
        return self if other == 0 else Symbol(binary(OP_ADD, self.x, float(other)))

    __radd__ = __add__

    def __neg__(self) -> "Symbol":
        return Symbol(unary(OP_NEG, self.x))

    def __sub__(self, other: Number) -> "Symbol":
        if isinstance(other, Symbol):
            return Symbol(binary(OP_SUB, self.x, other.x))
        if not isinstance(other, NUMBER):
            return NotImplemented
        return self if other == 0 else Symbol(binary(OP_SUB, self.x, float(other)))

    def __rsub__(self, other: float) -> "Symbol":
        return -self if other == 0 else Symbol(binary(OP_SUB, float(other), self.x))

    def __mul__(self, other: Number) -> Number:
        if isinstance(other, Symbol):
            return Symbol(binary(OP_MUL, self.x, other.x))
        if not isinstance(other, NUMBER):
            return NotImplemented
        if other == 0:
            return 0.0
        if other in (1, -1):
            return self if other == 1 else -self
        return Symbol(binary(OP_MUL, self.x, float(other)))

    __rmul__ = __mul__

    def __truediv__(self, other: Number) -> Number:
        if isinstance(other, Symbol):
            return Symbol(binary(OP_DIV, self.x, other.x))
        if not isinstance(other, NUMBER):
            return NotImplemented
        return self if other == 1 else Symbol(binary(OP_DIV, self.x, float(other)))

    def __rtruediv__(self, other: float) -> Number:
        return 0.0 if other == 0 else Symbol(binary(OP_DIV, float(other), self.x))

    def sqrt(self) -> "Symbol":
        return Symbol(unary(OP_SQRT, self.x))

    def cos(self) -> "Symbol":
        return Symbol(unary(OP_COS, self.x))

    def sin(self) -> "Symbol":
        return Symbol(unary(OP_SIN, self.x))

    def arctan2(self, other: Number) -> "Symbol":
        return Symbol(binary(OP_ATAN2, self.x, expression(other)))


def expression(value: Number) -> casadi.SX:
    """The CasADi expression of a symbol or constant."""
    return value.x if isinstance(value, Symbol) else casadi.SX(float(value))


def symbols(name: str, size: int) -> tuple[casadi.SX, Array]:
    """A symbolic input vector, for CasADi and as an array for the mechanics."""
    vector = casadi.SX.sym(name, size)
    array = np.empty(size, dtype=object)
    array[:] = [Symbol(x) for x in vector.elements()]
    return vector, array


def vector(array: Array) -> casadi.SX:
    """An array of symbols and constants as one CasADi column."""
    flat = [expression(value) for value in np.asarray(array, dtype=object).reshape(-1)]
    return casadi.vertcat(*flat) if flat else casadi.SX(0, 1)
