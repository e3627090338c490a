"""The array words that floats and symbols share.

The mechanics is written once, with arrays that are built and never filled, batch axes leading.
The same code runs on float arrays and on object arrays of symbols; only the solvers below know
the difference: LAPACK for floats, unrolled loops for symbols.
"""

import math
from collections.abc import Callable, Sequence
from contextvars import ContextVar
from itertools import pairwise
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]  # floats, or an object array of symbols
DENSE = 2000  # entries of a table from which on a loop over it is shorter than straight-line code
FEW = 4  # right-hand sides that are solved for one by one
Given = Any  # a field that takes anything array-like and holds a checked float array


def stack(parts: Sequence[Any], axis: int = -1) -> Array:
    """Scalars or arrays of equal trailing shape, broadcast together and stacked along a new axis."""
    return np.stack(np.broadcast_arrays(*parts), axis=axis)


def matrix(rows: Sequence[Sequence[Any]]) -> Array:
    """A matrix (…, r, c) from its entries (…,)."""
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
    """The parts (…, *shape) that lie side by side in the last axis."""
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
    """The matrix â with â b = a × b."""
    x, y, z = a[..., 0], a[..., 1], a[..., 2]
    return matrix([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def contract(q: Array, tensor: Array) -> Array:
    """Σ_k q_k tensor[k]: (…, N), (N, *shape) -> (…, *shape)."""
    shape = tensor.shape[1:]
    table = tensor.reshape(len(tensor), math.prod(shape))
    used = np.flatnonzero(np.any(table != 0, axis=0))
    if q.dtype != object or np.count_nonzero(table) < DENSE:
        flat = np.matmul(q[..., None, :], table)[..., 0, :]
        return flat.reshape(q.shape[:-1] + shape)

    def weighted(row: Array, q: Array) -> Array:
        return np.sum(row * q[..., None, :], axis=-1, keepdims=True)

    flat = np.zeros(q.shape[:-1] + table.shape[1:], dtype=object)
    flat[..., used] = for_each(weighted, [transpose(table[:, used])], [q])[..., 0]
    return flat.reshape(q.shape[:-1] + shape)


def for_each(function: Callable[..., Array], rows: Sequence[Array], shared: Sequence[Array] = ()) -> Array:
    """function(*rows, *shared) (…, R, m) for rows (…, R, n_i), each of which it treats alike, by itself.

    While symbols are traced whoever is in `looping` may trace it for one row, as the body of a loop.
    """
    loop = recorder(*rows, *shared)
    single = all(math.prod(a.shape[:-2]) == 1 for a in rows)  # otherwise these are rows of rows
    if loop is None or not single or rows[0].shape[-2] < 2:
        return function(*rows, *shared)
    return loop(function, rows, shared)


class Loops(Protocol):
    """Traces a function for one of many rows."""

    lanes: int  # rows that share an instruction

    def __call__(
        self, function: Callable[..., Array], rows: Sequence[Array], shared: Sequence[Array]
    ) -> Array: ...


looping: ContextVar[Loops | None] = ContextVar("looping", default=None)


def recorder(*arrays: Array) -> Loops | None:
    """Who records loops over arrays, of which some are of symbols."""
    return looping.get() if any(a.dtype == object for a in arrays) else None


def without_roundoff(values: Array, scale: float | None = None, tolerance: float = 1e-13) -> Array:
    """The float array with entries below tolerance × scale set to exact zero.

    The scale is what an entry could be, by default the largest of them; a zero that is stored as
    zero costs nothing in compiled code.
    """
    values = np.array(values, dtype=float)
    if scale is None:
        scale = float(np.max(np.abs(values), initial=0.0))
    return np.where(np.abs(values) <= tolerance * scale, 0.0, values)


def lapack_solve(a: Array, b: Array) -> Array:
    """x with a x = b for floats; not a number where a is singular, whatever else is in the batch."""
    try:
        return np.linalg.solve(a, b)
    except np.linalg.LinAlgError:
        bad = ~(np.abs(np.linalg.det(a)) > 0)[..., None, None]
        return np.where(bad, np.nan, np.linalg.solve(np.where(bad, np.eye(a.shape[-1]), a), b))


def solve_definite(a: Array, b: Array, step: int = 1) -> Array:
    """x with a x = b for a symmetric positive definite: (…, n, n), (…, n, c) -> (…, n, c).

    Rows that lie `step` apart may be treated alike.
    """
    loop, n = recorder(a), a.shape[-1]
    if loop is None or loop.lanes == 1 or n < 2 * step:
        return factored_solve(factored(a), b)
    order = np.arange(n).reshape(n // step, step).T.reshape(-1)
    factor = factored_in_blocks(a[..., order, :][..., order], n // step)
    return factored_solve(factor, b[..., order, :])[..., np.argsort(order), :]


def factored(a: Array) -> Array:
    """What `factored_solve` reads of a symmetric positive definite a: of symbols, a = L D Lᵀ, with L
    below the diagonal and D on it; of floats a itself, which LAPACK factors."""
    if a.dtype != object:
        return a
    n = a.shape[-1]
    scaled: dict[tuple[int, int], Array] = {}  # entries of L D
    lower: dict[tuple[int, int], Array] = {}  # entries of L, each divided once
    for j in range(n):
        for i in range(j, n):
            entry = a[..., i, j]
            for k in range(j):
                entry = entry - lower[i, k] * scaled[j, k]
            scaled[i, j] = entry
            lower[i, j] = entry / scaled[j, j]
    rows = [[scaled[i, i] if i == j else lower[max(i, j), min(i, j)] for j in range(n)] for i in range(n)]
    return matrix(rows) if n else a


def factored_in_blocks(a: Array, size: int) -> Array:
    """`factored`, of symbols, the rows of a block of `size` treated alike."""
    blocks = [slice(i, i + size) for i in range(0, a.shape[-1], size)]
    part = {(i, j): a[..., p, q] for i, p in enumerate(blocks) for j, q in enumerate(blocks) if j <= i}
    for j in range(len(blocks)):
        part[j, j] = factored(part[j, j])
        scaled = {}  # blocks of L D
        for i in range(j + 1, len(blocks)):
            both = for_each(below, [part[i, j]], [part[j, j]])
            scaled[i], part[i, j] = both[..., :size], both[..., size:]
        for i in range(j + 1, len(blocks)):
            for k in range(j + 1, i + 1):
                part[i, k] = for_each(without, [part[i, k], part[i, j]], [scaled[k]])
    order = range(len(blocks))
    return block([[part[i, j] if j <= i else transpose(part[j, i]) for j in order] for i in order])


def below(rows: Array, pivot: Array) -> Array:
    """Rows (…, R, c) of a matrix below a factored pivot (…, c, c): those of L D and those of L."""
    scaled: list[Array] = []
    for j in range(rows.shape[-1]):
        entry = rows[..., j]
        for k in range(j):
            entry = entry - scaled[k] * pivot[..., j, k, None]
        scaled.append(entry)
    return stack([*scaled, *(entry / pivot[..., j, j, None] for j, entry in enumerate(scaled))])


def without(rows: Array, lower: Array, scaled: Array) -> Array:
    """rows − lower scaledᵀ."""
    return rows - lower @ transpose(scaled)


def factored_solve(factor: Array, b: Array) -> Array:
    """x with a x = b, for the factor of a: (…, n, n), (…, n, c) -> (…, n, c)."""
    if factor.dtype != object:
        return lapack_solve(factor, b)
    if b.shape[-1] < FEW:
        return substituted(factor, b)
    return transpose(for_each(lambda b, F: transpose(substituted(F, transpose(b))), [transpose(b)], [factor]))


def substituted(factor: Array, b: Array) -> Array:
    """`factored_solve`, of symbols."""
    n = factor.shape[-1]
    x: list[Array] = []
    for i in range(n):
        row = b[..., i, :]
        for k in range(i):
            row = row - factor[..., i, k, None] * x[k]
        x.append(row)
    for i in reversed(range(n)):
        row = x[i] / factor[..., i, i, None]
        for k in range(i + 1, n):
            row = row - factor[..., k, i, None] * x[k]
        x[i] = row
    return stack(x, axis=-2) if x else b


def solve_least_norm(a: Array, b: Array) -> Array:
    """The shortest x with a x = b, rows of a independent: (…, o, m), (…, o) -> (…, m), o ≤ m.

    By QR of aᵀ, which for a square matrix is a stable solution without pivoting.
    """
    if a.dtype != object:
        q, r = np.linalg.qr(transpose(a))
        return mv(q, lapack_solve(transpose(r), b[..., None])[..., 0])
    columns: list[Array] = []
    y: list[Array] = []
    for i in range(a.shape[-2]):
        v, rhs = a[..., i, :], b[..., i]
        for unit, known in zip(columns, y, strict=True):
            projection = dot(unit, v)
            v = v - projection[..., None] * unit
            rhs = rhs - projection * known
        length = np.sqrt(dot(v, v))
        columns.append(v / length[..., None])
        y.append(rhs / length)
    return mv(stack(columns), stack(y))
