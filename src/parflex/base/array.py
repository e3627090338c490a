"""The array words that floats and symbols share.

The mechanics is written once, with arrays that are built and never filled, batch axes leading.
The same code runs on float arrays and on object arrays of symbols. Three places know the difference:
the solvers and loops of `unroll` (LAPACK for floats), `spatial.exact_cos_sin`, and the seeds of `dual`.
"""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]  # floats, or an object array of symbols


def stack(parts: Sequence[Any], axis: int = -1) -> Array:
    """Scalars or arrays of equal trailing shape, broadcast together and stacked along a new axis.

    >>> stack([1.0, np.array([2.0, 3.0])])
    array([[1., 2.],
           [1., 3.]])
    >>> stack([])
    array([], dtype=float64)
    """
    if not parts:
        return np.zeros(0)
    return np.stack(np.broadcast_arrays(*parts), axis=axis)


def matrix(rows: Sequence[Sequence[Any]]) -> Array:
    """A matrix (…, r, c) from its entries (…,); (0, 0) of none."""
    if not rows:
        return np.zeros((0, 0))
    return stack([stack(row) for row in rows], axis=-2)


def block(rows: Sequence[Sequence[Array]]) -> Array:
    """A matrix from blocks (…, r, c) whose leading axes are broadcast together."""
    batch = np.broadcast_shapes(*(b.shape[:-2] for row in rows for b in row))
    wide = [[np.broadcast_to(b, batch + b.shape[-2:]) for b in row] for row in rows]
    return np.concatenate([np.concatenate(row, axis=-1) for row in wide], axis=-2)


def join(parts: Sequence[Array]) -> Array:
    """Vectors (…, n_i), leading axes broadcast together, one after the other."""
    batch = np.broadcast_shapes(*(p.shape[:-1] for p in parts))
    return np.concatenate([np.broadcast_to(p, batch + p.shape[-1:]) for p in parts], axis=-1)


def merged(a: Array) -> Array:
    """The last two axes (…, r, c) as one (…, r c)."""
    return a.reshape(a.shape[:-2] + (a.shape[-2] * a.shape[-1],))


def split(flat: Array, shapes: Sequence[tuple[int, ...]]) -> list[Array]:
    """The parts (…, *shape) that lie side by side in the last axis.

    >>> split(np.arange(5.0), [(3,), (1, 2)])
    [array([0., 1., 2.]), array([[3., 4.]])]
    """
    ends = pairwise(np.cumsum([0, *(math.prod(shape) for shape in shapes)]))
    return [
        flat[..., first:last].reshape(flat.shape[:-1] + shape)
        for (first, last), shape in zip(ends, shapes, strict=True)
    ]


def block_diagonal(blocks: Array) -> Array:
    """(…, L, a, b) blocks on the diagonal of a matrix (…, L a, L b)."""
    count, a, b = blocks.shape[-3:]
    spread = blocks[..., :, :, None, :] * np.eye(count)[:, None, :, None]
    return spread.reshape(blocks.shape[:-3] + (count * a, count * b))


def mv(a: Array, x: Array) -> Array:
    """Matrix times vector: (…, r, c), (…, c) -> (…, r)."""
    return np.matmul(a, x[..., None])[..., 0]


def mtv(a: Array, x: Array) -> Array:
    """Transposed matrix times vector: (…, r, c), (…, r) -> (…, c)."""
    return mv(transpose(a), x)


def transpose(a: Array) -> Array:
    """The last two axes exchanged."""
    return np.swapaxes(a, -1, -2)


def dot(a: Array, b: Array) -> Array:
    """Scalar product over the last axis."""
    return np.sum(a * b, axis=-1)


def outer(a: Array, b: Array) -> Array:
    """a bᵀ over the last axis."""
    return a[..., :, None] * b[..., None, :]


def trace(a: Array) -> Array:
    """Sum of the diagonal of 3 × 3 matrices (…, 3, 3)."""
    return a[..., 0, 0] + a[..., 1, 1] + a[..., 2, 2]


def cross(a: Array, b: Array) -> Array:
    """Vector product over the last axis."""
    a1, a2, a3 = a[..., 0], a[..., 1], a[..., 2]
    b1, b2, b3 = b[..., 0], b[..., 1], b[..., 2]
    return stack([a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1])


def skew(a: Array) -> Array:
    """The matrix â with â b = a × b.

    >>> a, b = np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0])
    >>> skew(a) @ b, cross(a, b)
    (array([-3.,  6., -3.]), array([-3.,  6., -3.]))
    """
    x, y, z = a[..., 0], a[..., 1], a[..., 2]
    return matrix([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def without_roundoff(values: Array, scale: float | None = None, tolerance: float = 1e-13) -> Array:
    """The float array with entries below tolerance × scale set to exact zero.

    The scale is what an entry could be, by default the largest of them; a zero that is stored as
    zero costs nothing in compiled code.
    """
    values = np.array(values, dtype=float)
    if scale is None:
        scale = float(np.max(np.abs(values), initial=0.0))
    return np.where(np.abs(values) <= tolerance * scale, 0.0, values)
