"""Machine code kept on disk: one file per kernel, whole or not at all, checked before it is run."""

import hashlib
import io
import os
import stat
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.base.writing import replacing, sweep

VARIABLE = "PARFLEX_CACHE"  # a folder to use instead of the user's; empty for none
LIMIT = 500e6  # bytes; what was not used for longest goes first


class Entry(NamedTuple):
    """Object code, and the outputs that it gave for a probe when it was compiled."""

    code: bytes
    inputs: list[Array]
    outputs: list[Array]


def folder() -> Path | None:
    """The folder that entries are kept in; None where there is no place for one.

    A path that is not absolute would be another in each folder that the user works in, some of them not his.
    """
    chosen = os.environ.get(VARIABLE)
    if chosen is not None:
        if chosen and not os.path.isabs(chosen):
            warnings.warn(f"{VARIABLE} is {chosen!r}; give an absolute path: no code is kept", stacklevel=2)
        return Path(chosen) if os.path.isabs(chosen) else None
    bases = (os.environ.get(name, "") for name in ("XDG_CACHE_HOME", "LOCALAPPDATA"))
    try:
        base = next(filter(os.path.isabs, bases), None)
        return Path(base or Path.home() / ".cache") / "parflex"
    except RuntimeError:
        return None


def load(key: str) -> Entry | None:
    """The entry of that key; None where there is none that is the user's own and intact.

    What is checked is what is read: folder and file are opened, and judged by their descriptors.
    """
    place = folder()
    if place is None:
        return None
    name = f"{key}.bin"
    try:
        if not CHECKED:
            data = (place / name).read_bytes()
            os.utime(place / name)
        else:
            with own(place, os.O_DIRECTORY) as held, own(name, os.O_NONBLOCK, held) as file:
                with open(file, "rb", closefd=False) as stream:
                    data = stream.read()
                os.utime(file)
    except OSError:
        return None
    return entry_of(key, data)


def holds(key: str) -> bool:
    """True where there is a file for the entry of that key; `load` tells whether it is one."""
    place = folder()
    try:
        return place is not None and (place / f"{key}.bin").is_file()
    except OSError:
        return False


CHECKED = hasattr(os, "getuid")  # on Windows the folder is the user's by itself


@contextmanager
def own(path: Path | str, flags: int, folder: int | None = None) -> Iterator[int]:
    """The descriptor of a file, no link, that is the user's own and that nobody else can write.

    Raises OSError for any other.
    """
    handle = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_CLOEXEC | flags, dir_fd=folder)
    try:
        found = os.fstat(handle)
        if found.st_uid != os.getuid() or found.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
            raise PermissionError(f"{path} is another user's, or others can write to it")
        yield handle
    finally:
        os.close(handle)


def entry_of(key: str, data: bytes) -> Entry | None:
    """The entry in the bytes of a file; None where they are of another key, or damaged."""
    if sealed(key, data[32:]) != data:
        return None
    with np.load(io.BytesIO(data[32:])) as held:
        count = int(held["inputs"])
        arrays = [held[f"a{i}"] for i in range(len(held.files) - 2)]
        return Entry(held["code"].tobytes(), arrays[:count], arrays[count:])


def sealed(key: str, data: bytes) -> bytes:
    """The data behind a digest of them and of their key."""
    return hashlib.sha256(key.encode() + data).digest() + data


def save(key: str, entry: Entry) -> None:
    """Keep an entry where that is possible."""
    place = folder()
    if place is None:
        return
    held: dict[str, Any] = {f"a{i}": a for i, a in enumerate((*entry.inputs, *entry.outputs))}
    held |= {"code": np.frombuffer(entry.code, dtype=np.uint8), "inputs": len(entry.inputs)}
    stream = io.BytesIO()
    np.savez(stream, **held)
    try:
        made(place)
        with replacing(place / f"{key}.bin") as part:
            part.write(sealed(key, stream.getvalue()))
        trim(place)
    except (InputError, OSError):  # no place, or another process at the same work
        return


def made(place: Path) -> None:
    """Make the folder, for the user alone; one that others can write to is said not to be used.

    Raises OSError where there is no such folder then.
    """
    place.parent.mkdir(parents=True, exist_ok=True)
    place.mkdir(mode=0o700, exist_ok=True)
    if not CHECKED:
        return
    try:
        with own(place, os.O_DIRECTORY):
            return
    except OSError as error:
        warnings.warn(
            f"{error}: no code is kept there; chmod 700 {place}, or name a folder of your own by {VARIABLE}",
            stacklevel=2,
        )
        raise


def trim(place: Path) -> None:
    """Remove what processes that were killed left, and the entries not used for longest, to the limit."""
    sweep(place)
    known = [(path.stat(), path) for path in place.glob("*.bin")]
    excess = sum(found.st_size for found, _ in known) - LIMIT
    for found, path in sorted(known, key=lambda item: item[0].st_mtime):
        if excess <= 0:
            return
        path.unlink()
        excess -= found.st_size


def key_of(*parts: object) -> str:
    """A name that the parts, and this version of the code, determine."""
    digest = hashlib.sha256(source_digest())
    for part in parts:
        feed(digest, part)
    return digest.hexdigest()


def feed(digest: Any, part: object) -> None:
    """Put a value into a digest: an array, a number, a text, or a collection of them."""
    if isinstance(part, np.ndarray):
        digest.update(f"{part.shape}{part.dtype}".encode() + np.ascontiguousarray(part).tobytes())
    elif isinstance(part, (tuple, list)):
        digest.update(f"({len(part)}".encode())
        for item in part:
            feed(digest, item)
    elif hasattr(part, "__dataclass_fields__"):
        digest.update(type(part).__name__.encode())
        for name in part.__dataclass_fields__:
            feed(digest, getattr(part, name))
    elif part is None or isinstance(part, (str, bytes, int, float, np.generic)):
        digest.update(repr(part).encode())
    else:
        raise TypeError(f"{type(part).__name__} has no digest")


@cache
def source_digest() -> bytes:
    """A digest of all modules of parflex: other code may make other models."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.parent.rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.digest()
