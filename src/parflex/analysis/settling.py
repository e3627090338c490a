"""A bend that causes itself: a fixed point of stiff springs, or Newton's method where they are soft."""

from collections.abc import Callable

import numpy as np

from parflex.base.array import Array
from parflex.base.check import index_of
from parflex.base.errors import NotConverged

Excess = Callable[[Array], Array]  # by how much a bend (…, n) exceeds that which it causes

SETTLED = 1e-13  # of the bend: a change that is round-off
ENOUGH = 1e-10  # of the bend: what may be left where nothing lessens it
STEPS = 20
STEP = 1e-6  # of the scale, for differences
HALVINGS = 12


def settled(excess: Excess, y: Array, scale: Array) -> Array:
    """The bend y (…, n) without excess, from one near it; scale (n,) is the size of a large one.

    Raises NotConverged where none is found.
    """
    left = excess(y)
    for _ in range(STEPS):
        if np.all(size(left) <= SETTLED * size(y)):
            return y
        nearer = y - left
        rest = excess(nearer)
        if not np.all((size(rest) <= 0.5 * size(left)) | (size(left) <= SETTLED * size(y))):
            nearer, rest = newton(excess, y, left, scale)
        if np.all(size(rest) >= size(left)):
            break
        y, left = nearer, rest
    bad = ~(size(left) <= ENOUGH * size(y))
    if np.any(bad):
        raise NotConverged(
            f"state{index_of(bad)}: no bend of the legs was found that balances the forces, the legs buckle "
            f"or nearly so; stiffen them, ask for less acceleration, or give State.leg_elastic near the bend"
        )
    return y


def newton(excess: Excess, y: Array, left: Array, scale: Array) -> tuple[Array, Array]:
    """A step of Newton's method, for each state of a batch halved until it lessens the excess; and what is
    left."""
    h = STEP * scale
    steps = np.expand_dims(np.diag(h), tuple(range(1, y.ndim)))
    slopes = np.moveaxis((excess(y + steps) - left), 0, -1) / h
    known = np.all(np.isfinite(slopes), axis=(-2, -1), keepdims=True)
    step = np.linalg.pinv(np.where(known, slopes, 0.0)) @ np.where(known, left[..., None], 0.0)
    part = np.ones((*y.shape[:-1], 1))
    for _ in range(HALVINGS):
        nearer = y - part * step[..., 0]
        rest = excess(nearer)
        worse = ~(size(rest) < size(left))[..., None]
        if not np.any(worse):
            break
        part = np.where(worse, part / 2, part)
    return np.where(worse, y, nearer), np.where(worse, left, rest)


def size(y: Array) -> Array:
    """The largest entry (…,); infinite where one is not a number."""
    return np.max(np.nan_to_num(np.abs(y), nan=np.inf), axis=-1, initial=0.0)
