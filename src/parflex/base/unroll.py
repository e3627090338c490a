"""Solvers and loops that run on floats by LAPACK and on symbols unrolled."""

import math
from collections.abc import Callable, Iterator, Sequence
from contextvars import ContextVar
from functools import partial
from typing import Any, Protocol

import numpy as np

from parflex.base.array import Array, block, dot, matrix, mv, stack, transpose
from parflex.base.dual import called

DENSE = 2000  # entries of a table from which on a loop over it is shorter than straight-line code


FEW = 4  # right-hand sides that are solved for one by one


def contract(q: Array, tensor: Array, lead: int = 0) -> Array:
    """Σ_k q_k tensor[k]: (…, N), (N, *shape) -> (…, *shape); the tensor may have leading axes."""
    if lead:
        first, count, shape = tensor.shape[:lead], tensor.shape[lead], tensor.shape[lead + 1 :]
        flat = np.matmul(q[..., None, :], tensor.reshape((*first, count, math.prod(shape))))[..., 0, :]
        return flat.reshape(flat.shape[:-1] + shape)
    shape = tensor.shape[1:]
    table = tensor.reshape(len(tensor), math.prod(shape))
    used = np.flatnonzero(np.any(table != 0, axis=0))
    if q.dtype != object or np.count_nonzero(table) < DENSE:
        flat = np.matmul(q[..., None, :], table)[..., 0, :]
        return flat.reshape(q.shape[:-1] + shape)

    def weighted(row: Array, q: Array) -> Array:
        return np.sum(row * q[..., None, :], axis=-1, keepdims=True)

    flat = np.zeros(q.shape[:-1] + table.shape[1:], dtype=object)
    flat[..., used] = each(weighted, [transpose(table[:, used])], [q])[..., 0]
    return flat.reshape(q.shape[:-1] + shape)


def each(function: Callable[..., Any], rows: Sequence[Array], shared: Sequence[Array] = ()) -> Any:
    """function(*rows, *shared) for rows (…, R, n_i), each of which it treats alike and by itself.

    The function gives an array (…, R, *shape), or a tree of them in tuples and lists, with all leading axes.
    While symbols are traced, the recorder in `looping` may trace it for one row, as the body of a loop.
    """
    loop = recorder(*rows, *shared)
    single = all(math.prod(a.shape[:-2]) == 1 for a in rows)  # otherwise these are rows of rows
    if loop is None or not single or rows[0].shape[-2] < 2:
        return function(*rows, *shared)
    return loop(function, rows, shared)


def leaves(tree: Any) -> list[Array]:
    """The arrays of a tree, from left to right; None stands for no array."""
    if tree is None:
        return []
    return [tree] if isinstance(tree, np.ndarray) else [leaf for branch in tree for leaf in leaves(branch)]


def regrown(tree: Any, found: Iterator[Array]) -> Any:
    """A tree of the same form with other arrays."""
    if tree is None:
        return None
    if isinstance(tree, np.ndarray):
        return next(found)
    branches = [regrown(branch, found) for branch in tree]
    if hasattr(tree, "_fields"):
        return type(tree)(*branches)
    return type(tree)(branches)


class Loops(Protocol):
    """A recorder traces a function for one of many rows."""

    lanes: int  # rows that share an instruction

    def __call__(
        self, function: Callable[..., Any], rows: Sequence[Array], shared: Sequence[Array]
    ) -> Any: ...


looping: ContextVar[Loops | None] = ContextVar("looping", default=None)


def recorder(*arrays: Array) -> Loops | None:
    """The recorder of loops, where one listens and some of the arrays are of symbols."""
    return looping.get() if any(a.dtype == object for a in arrays) else None


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
    """The factor of a symmetric positive definite a that `factored_solve` takes: of symbols, a = L D Lᵀ,
    with L below the diagonal and D on it; of floats a itself, which LAPACK factors."""
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
    """The factor of a matrix of symbols, as of `factored`, with the rows of a block of `size` treated
    alike."""
    blocks = [slice(i, i + size) for i in range(0, a.shape[-1], size)]
    part = {(i, j): a[..., p, q] for i, p in enumerate(blocks) for j, q in enumerate(blocks) if j <= i}
    for j in range(len(blocks)):
        part[j, j] = factored(part[j, j])
        scaled = {}  # blocks of L D
        for i in range(j + 1, len(blocks)):
            both = each(below, [part[i, j]], [part[j, j]])
            scaled[i], part[i, j] = both[..., :size], both[..., size:]
        for i in range(j + 1, len(blocks)):
            for k in range(j + 1, i + 1):
                part[i, k] = each(without, [part[i, k], part[i, j]], [scaled[k]])
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
    """The difference rows − lower scaledᵀ."""
    return rows - lower @ transpose(scaled)


def factored_solve(factor: Array, b: Array) -> Array:
    """x with a x = b, for the factor of a: (…, n, n), (…, n, c) -> (…, n, c).

    Floats among symbols, of what does not depend on the state, are factored as symbols are.
    """
    if factor.dtype != object and b.dtype != object:
        return lapack_solve(factor, b)
    if factor.dtype != object:
        factor = factored(factor.astype(object))
    if b.shape[-1] < FEW:
        return substituted(factor, b)
    return transpose(each(lambda b, F: transpose(substituted(F, transpose(b))), [transpose(b)], [factor]))


def substituted(factor: Array, b: Array) -> Array:
    """x with a x = b for the factor of a matrix of symbols."""
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


def root(a: Array) -> Array:
    """The square roots of floats, or of symbols among which there may be constants."""
    return np.asarray(np.frompyfunc(partial(called, "sqrt"), 1, 1)(a) if a.dtype == object else np.sqrt(a))


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
        length = root(dot(v, v))
        columns.append(v / length[..., None])
        y.append(rhs / length)
    return mv(stack(columns), stack(y))
