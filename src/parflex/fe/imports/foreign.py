"""Files of other programs: read whole, or refused in one sentence that says what is wrong with them."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError

BEYOND = 1e30  # what no coordinate, displacement, mass or ω² reaches, in any unit
SAME = 1e-4  # relative difference up to which a number that a file holds twice is the same
LONGEST = 100  # characters of another library's words


def briefly(error: Exception) -> str:
    """The first line of an error's text, shortened."""
    first = next(iter(str(error).splitlines()), "")
    return first if len(first) <= LONGEST else first[: LONGEST - 1] + "…"


def read(kind: str, path: Path) -> bytes:
    """The contents of a file; raises InputError where it cannot be read."""
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"{kind} {path} cannot be read: {error.strerror or error}") from None


def lines_of(kind: str, path: Path) -> list[str]:
    """The lines of a text file, one at least."""
    return read(kind, path).decode("latin-1").splitlines() or [""]


def rows_of(ids: Array, wanted: Array, sentence: str) -> Array:
    """The rows, from 0, that nodes by number (of any shape) have among ids (K,).

    Raises InputError for one that is not there; "{}" in the sentence stands for its number.
    """
    missing = wanted[~np.isin(wanted, ids)]
    if len(missing):
        raise InputError(sentence.replace("{}", f"{missing[0]:.0f}"))
    order = np.argsort(ids)
    return order[np.searchsorted(ids, wanted, sorter=order)]


@contextmanager
def refusing(sentence: str, *kinds: type[Exception]) -> Iterator[None]:
    """Turn the errors of those kinds that a reader raises for a damaged file into an InputError.

    "{}" in the sentence stands for the reader's own words.
    """
    try:
        yield
    except InputError:
        raise
    except kinds as error:
        raise InputError(sentence.replace("{}", briefly(error))) from None
