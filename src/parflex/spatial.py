"""Rotations and quaternions. Quaternions are (w, x, y, z)."""

import numpy as np

from parflex.array import Array, matrix, stack


def rotation_from_quaternion(quaternion: Array) -> Array:
    """R (…, 3, 3) of a quaternion (…, 4) of any length but zero."""
    n = quaternion / np.sqrt(np.sum(quaternion * quaternion, axis=-1))[..., None]
    w, x, y, z = n[..., 0], n[..., 1], n[..., 2], n[..., 3]
    return matrix(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )


def quaternion_rate(quaternion: Array, omega: Array) -> Array:
    """d/dt of the quaternion for the angular velocity ω in body axes: ½ q ⊗ (0, ω)."""
    w, x, y, z = (quaternion[..., i] for i in range(4))
    a, b, c = (0.5 * omega[..., i] for i in range(3))
    return stack(
        [
            -x * a - y * b - z * c,
            w * a + y * c - z * b,
            w * b + z * a - x * c,
            w * c + x * b - y * a,
        ]
    )


def rotation_about_z(angle: Array) -> Array:
    """Rot(z, angle), (…, 3, 3)."""
    c, s = exact_cos_sin(angle)
    return matrix([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def exact_cos_sin(angle: Array) -> tuple[Array, Array]:
    """cos and sin of constant angles, with the round-off at multiples of π/2 removed.

    Among constants there may be symbols, of numbers that are known at run time only.
    """
    if angle.dtype == object:
        return np.frompyfunc(np.cos, 1, 1)(angle), np.frompyfunc(np.sin, 1, 1)(angle)
    c, s = np.cos(angle), np.sin(angle)
    return np.where(np.abs(c) < 1e-15, 0.0, c), np.where(np.abs(s) < 1e-15, 0.0, s)


def within_half_a_turn(angle: Array) -> Array:
    """The angle in [−π, π), rad."""
    return np.remainder(angle + np.pi, 2 * np.pi) - np.pi
