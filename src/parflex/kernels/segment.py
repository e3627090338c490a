"""The wanted motion on one stretch of a trajectory, for floats and for symbols."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array, dot, join, mtv, outer, skew, split
from parflex.robot.state import State

ONE = np.eye(3)
STILL = np.zeros(4)
NONE = np.zeros(6)
CONSTANT = np.eye(6)[0]  # the polynomial 1
ROUNDOFF = 1e-12  # m, rad


class Sample(NamedTuple):
    """Wanted motion of Σp: pose in Σ0; twist and acceleration resolved in Σp, as in `State`."""

    position: Array  # (…, 3) m
    rotation: Array  # (…, 3, 3)
    twist: Array  # (…, 6) m/s, rad/s
    acceleration: Array  # (…, 6) m/s², rad/s²

    def state(self, elastic: ArrayLike = 0.0) -> State:
        """The state on the trajectory, with elastic coordinates (…, N) at rest."""
        return State(self.position, self.rotation, self.twist, elastic)


class Segment(NamedTuple):
    """A stretch of a trajectory: the position, and the angle by which Σp is turned about one axis.

    y = (position in Σ0 3, angle 1) = P(τ) + (1 − cos φ(τ)) a + sin φ(τ) b with τ = (t − start) / span,
    where P and φ are polynomials; the orientation is `rotation` turned by the angle about `axis`, a unit
    vector in the axes of `rotation`.
    """

    span: Array  # (…,) s
    rotation: Array  # (…, 3, 3)
    path: Array  # (…, 6, 4), coefficients of P by ascending powers of τ; m, rad
    axis: Array = np.zeros(3)  # (…, 3)
    phase: Array = NONE  # (…, 6), coefficients of φ, rad
    versine: Array = STILL  # (…, 4), a
    sine: Array = STILL  # (…, 4), b
    start: Array = np.zeros(())  # (…,) s

    @property
    def row(self) -> Array:
        """(SEGMENT,), the numbers that `along` reads: 1 / span, as it does not divide, and the others."""
        return np.concatenate([np.ravel(part) for part in self._replace(span=1 / self.span)])

    @property
    def still(self) -> bool:
        """True where it stays in one pose, to round-off."""
        moving = [self.path[1:], self.versine, self.sine]
        return all(np.max(np.abs(part)) < ROUNDOFF for part in moving)


def path(position: Array, way: Array = STILL, pace: Array = NONE) -> Array:
    """(6, 4) of a segment: from a position along a way (line 3, angle 1), by the polynomial `pace` (6,)."""
    return np.outer(CONSTANT, [*position, 0.0]) + np.outer(pace, way)


def resting(position: Array, rotation: Array, span: float = 1.0) -> Segment:
    """The segment that stays in a pose."""
    return Segment(np.asarray(span), rotation, path(position))


SHAPES: tuple[tuple[int, ...], ...] = ((), (3, 3), (6, 4), (3,), (6,), (4,), (4,), ())  # of a segment's parts
SEGMENT = sum(math.prod(shape) for shape in SHAPES)  # numbers that describe a segment


def along(row: Array, time: Array) -> Sample:
    """The wanted motion at times (…,) of segments (…, SEGMENT), floats or symbols; without a branch."""
    rate, base, path, axis, phase, versine, sine, start = split(row, SHAPES)
    y, yd, ydd = coordinates(path, phase, versine, sine, (time - start) * rate)
    angle, rate = y[..., 3:], rate[..., None]
    s, v = np.sin(angle)[..., None], 1 - np.cos(angle)[..., None]
    turn = ONE + s * skew(axis) + v * (outer(axis, axis) - dot(axis, axis)[..., None, None] * ONE)
    rotation = base @ turn
    twist = rate * join([mtv(rotation, yd[..., :3]), yd[..., 3:] * axis])
    acceleration = rate * rate * join([mtv(rotation, ydd[..., :3]), ydd[..., 3:] * axis])
    return Sample(y[..., :3], rotation, twist, acceleration)


def coordinates(path: Array, phase: Array, a: Array, b: Array, tau: Array) -> tuple[Array, Array, Array]:
    """y (…, 4) of a segment at τ (…,), with its first two derivatives by τ."""
    y, yd, ydd = polynomial(path, tau)
    phi, rate, growth = polynomial(phase[..., None], tau)
    cosine, sine = np.cos(phi), np.sin(phi)
    swing = sine * a + cosine * b
    ydd = ydd + growth * swing + rate * rate * (cosine * a - sine * b)
    return y + (1 - cosine) * a + sine * b, yd + rate * swing, ydd


def polynomial(coefficients: Array, tau: Array) -> tuple[Array, Array, Array]:
    """Σ c_k τ^k (…, d) of coefficients (…, n, d) by ascending powers, and its first two derivatives."""
    tau = tau[..., None]
    value, slope, half = (0.0 * (coefficients[..., 0, :] * tau) for _ in range(3))
    for k in reversed(range(coefficients.shape[-2])):  # Horner's rule
        half = half * tau + slope
        slope = slope * tau + value
        value = value * tau + coefficients[..., k, :]
    return value, slope, 2 * half
