"""Values that are legal and hardly meant: told with the likely slip, to who listens or as a warning."""

import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.errors import ImplausibleValue
from parflex.base.kinds import Kind

_HEARD: ContextVar[list[str] | None] = ContextVar("heard", default=None)


def doubt(words: str) -> None:
    """Tell of a value that is hardly meant, in a sentence that begins with its name and says what to do."""
    heard = _HEARD.get()
    if heard is None:
        warnings.warn(words, ImplausibleValue, stacklevel=2 + depth())
    else:
        heard.append(words)


@contextmanager
def listening() -> Iterator[list[str]]:
    """Collect the doubts of a block, as one does who knows the line of a file that they are about."""
    heard: list[str] = []
    token = _HEARD.set(heard)
    try:
        yield heard
    finally:
        _HEARD.reset(token)


@contextmanager
def derived() -> Iterator[None]:
    """Doubt nothing in a block whose numbers are computed from given ones, which were doubted themselves."""
    with listening():
        yield


def usual(name: str, value: ArrayLike, kind: Kind) -> None:
    """Doubt a number, or the largest of an array, that is more than machines have of its kind."""
    array = np.asarray(value, dtype=float)
    numbers = array[np.isfinite(array)]
    if numbers.size and np.abs(numbers).max() > kind.most:
        worst = float(numbers[np.abs(numbers).argmax()])
        meant = f'give {worst * kind.factor:.10g} {kind.unit}, in files "{worst:.10g} {kind.slip}"'
        doubt(f"{name} is {worst:.10g} {kind.unit}, {kind.beyond}; if it is in {kind.slip}, {meant}")


def depth() -> int:
    """The number of frames of this library above the caller, so that a warning names the user's line."""
    frame, count = sys._getframe(2), 0
    while frame.f_back is not None and frame.f_globals.get("__name__", "").startswith("parflex."):
        frame, count = frame.f_back, count + 1
    return count
