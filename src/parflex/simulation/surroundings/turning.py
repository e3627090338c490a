"""Turning about several axes: rotation vectors, angular velocities and what leads from one to the other."""

import math
from math import factorial

import numpy as np
from scipy.spatial.transform import Rotation

from parflex.base.array import Array, cross, dot, mv, skew
from parflex.base.errors import InputError
from parflex.base.spatial import rotation_from_vector

TERMS = 10  # of series for angles below one
SERIES = np.array(  # of A, B and their derivatives by φ²
    [
        [(-1) ** k / factorial(2 * k + 2), (-1) ** k / factorial(2 * k + 3)]
        + [(-1) ** (k + 1) * (k + 1) / factorial(2 * k + n) for n in (4, 5)]
        for k in range(TERMS)
    ]
)
GAUSS = (0.5 - math.sqrt(3) / 6, 0.5 + math.sqrt(3) / 6)  # points of a step
MOST = 3.0  # rad, about several axes: beyond half a turn a rotation vector is another one


def rotations(theta: Array) -> Array:
    """R (…, 3, 3) of rotation vectors (…, 3)."""
    if theta.ndim == 1:
        return rotation_from_vector(theta)
    found: Array = Rotation.from_rotvec(theta.reshape(-1, 3)).as_matrix()
    return found.reshape(*theta.shape, 3)


def angular(theta: Array, rate: Array, growth: Array) -> tuple[Array, Array]:
    """ω and ω̇ (…, 3), in the axes in which a rotation vector θ (…, 3) with these two derivatives is given.

    ω = θ̇ + A θ × θ̇ + B θ × (θ × θ̇), with A = (1 − cos φ)/φ², B = (φ − sin φ)/φ³ and φ = |θ|.
    """
    A, B, A_s, B_s = (each[..., None] for each in shares(dot(theta, theta)))
    faster, hat = 2.0 * dot(theta, rate)[..., None], skew(theta)  # d/dt φ²
    once, again = mv(hat, rate), mv(hat, growth)
    twice = mv(hat, once)
    changing = faster * (A_s * once + B_s * twice) + B * cross(rate, once)
    return rate + A * once + B * twice, growth + A * again + B * mv(hat, again) + changing


def shares(s: Array) -> tuple[Array, Array, Array, Array]:
    """A and B of `angular` at φ² = s (…,), and their derivatives by s; below one from their series."""
    small, large = np.minimum(s, 1.0), np.maximum(s, 1.0)
    powers = small[..., None] ** np.arange(TERMS)
    phi = np.sqrt(large)
    S, C = np.sin(phi) / phi, np.cos(phi)
    A, B = (1 - C) / large, (1 - S) / large
    closed = A, B, (0.5 * S - A) / large, (-0.5 * (C - S) / large - B) / large
    series = np.moveaxis(powers @ SERIES, -1, 0)
    A, B, A_s, B_s = (np.where(s < 1.0, *pair) for pair in zip(series, closed, strict=True))
    return A, B, A_s, B_s


def turned(t: Array, first: Array, second: Array) -> Array:
    """The rotation vectors (T, 3) at times (T,) of a turning from rest in the world's axes, by its angular
    velocities (T − 1, 3) at the two Gauss points of each step: Magnus's expansion of fourth order.

    Raises InputError, with the time, for a turn of more than 3 rad.
    """
    h = np.diff(t)[:, None]
    steps = 0.5 * h * (first + second) - math.sqrt(3) / 12 * h * h * cross(first, second)
    found, whole = [np.zeros(3)], Rotation.identity()
    for step, time in zip(Rotation.from_rotvec(steps), t[1:], strict=True):
        whole = step * whole
        found.append(whole.as_rotvec())
        if np.linalg.norm(found[-1]) > MOST:
            raise InputError(
                f"BaseSamples turn by more than {MOST:g} rad about several axes, at t = {time:.6g} s; give "
                f"the rotation itself, as rotation vectors"
            )
    return np.stack(found)
