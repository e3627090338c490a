"""Machine code kept on disk: one file per kernel, whole or not at all, checked before it is run."""

import hashlib
import io
import os
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.base.writing import replacing

VARIABLE = "PARFLEX_CACHE"  # a folder to use instead of the user's; empty for none
LIMIT = 500e6  # bytes; what was not used for longest goes first


class Entry(NamedTuple):
    """Object code, and the outputs that it gave for a probe when it was compiled."""

    code: bytes
    inputs: list[Array]
    outputs: list[Array]


def folder() -> Path | None:
    """The folder that entries are kept in; None where there is no place for one."""
    chosen = os.environ.get(VARIABLE)
    if chosen is not None:
        return Path(chosen) if chosen else None
    base = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA")
    try:
        return Path(base or Path.home() / ".cache") / "parflex"
    except RuntimeError:
        return None


def load(key: str) -> Entry | None:
    """The entry of that key; None where there is none that is the user's own and intact."""
    place = folder()
    if place is None:
        return None
    try:
        path = place / f"{key}.bin"
        if hasattr(os, "getuid") and path.stat().st_uid != os.getuid():
            return None
        data = path.read_bytes()
        os.utime(path)
    except OSError:
        return None
    if hashlib.sha256(data[32:]).digest() != data[:32]:
        return None
    with np.load(io.BytesIO(data[32:])) as held:
        count = int(held["inputs"])
        arrays = [held[f"a{i}"] for i in range(len(held.files) - 2)]
        return Entry(held["code"].tobytes(), arrays[:count], arrays[count:])


def save(key: str, entry: Entry) -> None:
    """Keep an entry where that is possible."""
    place = folder()
    if place is None:
        return
    held: dict[str, Any] = {f"a{i}": a for i, a in enumerate((*entry.inputs, *entry.outputs))}
    held |= {"code": np.frombuffer(entry.code, dtype=np.uint8), "inputs": len(entry.inputs)}
    stream = io.BytesIO()
    np.savez(stream, **held)
    data = stream.getvalue()
    try:
        with replacing(place / f"{key}.bin") as part:
            part.write_bytes(hashlib.sha256(data).digest() + data)
        trim(place)
    except (InputError, OSError):  # no place, or another process at the same work
        return


def trim(place: Path) -> None:
    """Remove the entries that were not used for longest, down to the limit."""
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
