"""Rotations and quaternions. Quaternions are (w, x, y, z)."""

import math

import numpy as np

from parflex.base.array import Array, dot, matrix, skew, stack


def rotation_from_quaternion(quaternion: Array) -> Array:
    """R (…, 3, 3) of a quaternion (…, 4) of any length but zero.

    >>> rotation_from_quaternion(np.array([0.0, 0.0, 0.0, 1.0]))  # half a turn about z
    array([[-1.,  0.,  0.],
           [ 0., -1.,  0.],
           [ 0.,  0.,  1.]])
    """
    n = quaternion / np.sqrt(np.sum(quaternion * quaternion, axis=-1))[..., None]
    w, x, y, z = n[..., 0], n[..., 1], n[..., 2], n[..., 3]
    return matrix(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )


def off_orthonormal(R: Array) -> float:
    """The largest entry of RᵀR − 1 for one matrix (3, 3); infinite where it is left-handed."""
    (a, b, c), (d, e, f), (g, h, i) = R.tolist()
    if a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) < 0:
        return math.inf
    return max(
        abs(a * a + d * d + g * g - 1.0),
        abs(b * b + e * e + h * h - 1.0),
        abs(c * c + f * f + i * i - 1.0),
        abs(a * b + d * e + g * h),
        abs(a * c + d * f + g * i),
        abs(b * c + e * f + h * i),
    )


def quaternion_from_rotation(R: Array) -> Array:
    """The quaternion (…, 4) of rotation matrices (…, 3, 3), its largest entry positive."""
    if R.ndim == 2 and off_orthonormal(R) < 1e-12:
        return quaternion_of_one(R)
    from scipy.spatial.transform import Rotation

    found: Array = Rotation.from_matrix(R.reshape(-1, 3, 3)).as_quat(scalar_first=True)
    return found.reshape(R.shape[:-2] + (4,))


def quaternion_of_one(R: Array) -> Array:
    """The quaternion of one orthonormal matrix, by SciPy's formula, a hundred times as quick."""
    (a, b, c), (d, e, f), (g, h, i) = R.tolist()
    trace = a + e + i
    largest = max(a, e, i, trace)
    if largest == trace:
        q = (1.0 + trace, h - f, c - g, d - b)
    elif largest == a:
        q = (h - f, 1.0 - trace + 2.0 * a, d + b, g + c)
    elif largest == e:
        q = (c - g, d + b, 1.0 - trace + 2.0 * e, h + f)
    else:
        q = (d - b, g + c, h + f, 1.0 - trace + 2.0 * i)
    length = math.hypot(*q)
    return np.array([part / length for part in q])


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


def rotation_from_vector(vector: Array) -> Array:
    """R (3, 3) of a rotation vector (3,) rad, for one rotation, without SciPy, which takes a while to load.

    >>> rotation_from_vector(np.array([0.0, 0.0, np.pi / 2])).round(15)
    array([[ 0., -1.,  0.],
           [ 1.,  0.,  0.],
           [ 0.,  0.,  1.]])
    """
    angle = float(np.linalg.norm(vector))
    axis = vector / angle if angle else vector
    return rotation_from_quaternion(np.append(math.cos(angle / 2), math.sin(angle / 2) * axis))


def vector_from_rotation(R: Array) -> Array:
    """The rotation vector (3,) rad, at most half a turn, of one matrix."""
    quaternion = quaternion_of_one(R)
    w, xyz = quaternion[0], quaternion[1:]
    size = float(np.linalg.norm(xyz))
    return 2 * math.atan2(size, abs(w)) * math.copysign(1.0, w) * xyz / size if size else np.zeros(3)


def cayley(a: Array, maps: Array) -> tuple[Array, Array]:
    """Cay(a) = (1 − â/2)⁻¹ (1 + â/2) (…, 3, 3) of a vector (…, 3) that changes by maps (…, 3, N) times rates,
    and what takes these to its angular velocity (…, 3, N); rational."""
    hat, share = skew(a), (1.0 / (1.0 + 0.25 * dot(a, a)))[..., None, None]
    return np.eye(3) + share * (hat + 0.5 * (hat @ hat)), share * (maps + 0.5 * (hat @ maps))


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
    """The angle in [−π, π), rad.

    >>> float(np.rad2deg(within_half_a_turn(np.deg2rad(270.0))))
    -90.0
    """
    return np.remainder(angle + np.pi, 2 * np.pi) - np.pi


def axial(X: Array) -> Array:
    """(X_32 − X_23, X_13 − X_31, X_21 − X_12): for X = ∫ a bᵀ this is ∫ b × a."""
    return stack(
        [
            X[..., 2, 1] - X[..., 1, 2],
            X[..., 0, 2] - X[..., 2, 0],
            X[..., 1, 0] - X[..., 0, 1],
        ]
    )
