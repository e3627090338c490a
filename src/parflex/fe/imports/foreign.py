"""Files of other programs: read whole, or refused in one sentence that says what is wrong with them."""

from codecs import BOM_UTF8
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

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
    """The contents of a file, without the byte order mark that some editors put before UTF-8.

    Raises InputError where it cannot be read.
    """
    try:
        return path.read_bytes().removeprefix(BOM_UTF8)
    except (OSError, ValueError) as error:  # ValueError: a name with a NUL
        raise InputError(f"{kind} {path} cannot be read: {getattr(error, 'strerror', error)}") from None


@contextmanager
def unmarked(path: Path) -> Iterator[Path]:
    """A file for readers that open it themselves: a copy of it where it begins with a byte order mark."""
    data = path.read_bytes()
    if not data.startswith(BOM_UTF8):
        yield path
        return
    with TemporaryDirectory() as folder:
        copy = Path(folder) / path.name
        copy.write_bytes(data.removeprefix(BOM_UTF8))
        yield copy


def encoding_of(path: Path) -> str:
    """The encoding of a text file: UTF-8 where a byte order mark says so, else one that takes all bytes."""
    with path.open("rb") as file:
        return "utf-8-sig" if file.read(3) == BOM_UTF8 else "latin-1"


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
