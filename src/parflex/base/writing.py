"""Files that are written whole or not at all."""

import os
import secrets
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import IO

from parflex.base.errors import InputError

try:
    import fcntl
except ImportError:  # on Windows, where a file that is open cannot be removed
    fcntl = None  # type: ignore[assignment]

PART = ".part"
WRITTEN: dict[Path, None] = {}  # what this process has written, in order
KINDS = {
    stat.S_ISDIR: "a folder",
    stat.S_ISCHR: "a device",
    stat.S_ISBLK: "a device",
    stat.S_ISFIFO: "a pipe",
    stat.S_ISSOCK: "a socket",
}


@contextmanager
def replacing(target: Path) -> Iterator[IO[bytes]]:
    """A file beside `target` that takes its place when the block ends without an error.

    Folders are made where they are missing, links are followed, and what is replaced hands its permissions
    on. What a process that was killed left of the same target is removed.

    Raises InputError where the file cannot be written: no space, no right to, a device or a pipe.
    """
    name: Path | None = None
    try:
        place = Path(os.path.realpath(target))
        mode = mode_of(place)
        place.parent.mkdir(parents=True, exist_ok=True)
        sweep(place.parent, f".{place.name}.")
        name, part = begun(place, 0o666 if mode is None else 0o600)
        with part:
            yield part
            part.flush()
            if mode is not None:
                os.chmod(name, mode)
            os.fsync(part.fileno())
            if fcntl is None:
                part.close()
            os.replace(name, place)
            WRITTEN[target] = None
    except (OSError, ValueError) as error:  # ValueError: a name with a NUL, a surrogate
        if isinstance(error, InputError):
            raise
        number = getattr(error, "errno", None)
        reason = os.strerror(number) if number else str(error)
        raise InputError(f"{target} was not written: {reason}; what was there is untouched") from None
    finally:
        if name is not None:
            name.unlink(missing_ok=True)


def mode_of(place: Path) -> int | None:
    """The permissions of the file that is there, None where there is none.

    Raises OSError where it is no file, or may not be written to.
    """
    try:
        found = os.lstat(place).st_mode
    except FileNotFoundError:
        return None
    for is_kind, words in KINDS.items():
        if is_kind(found):
            raise OSError(f"it is {words}")
    if not stat.S_ISREG(found):
        raise OSError("it is a link that leads to itself")
    if not os.access(place, os.W_OK):
        raise PermissionError("it may not be written to")
    return stat.S_IMODE(found) & 0o777


def begun(place: Path, mode: int) -> tuple[Path, IO[bytes]]:
    """A new file beside `place`, open, and locked for as long as it is open."""
    while True:
        name = place.with_name(f".{place.name}.{secrets.token_hex(6)}{PART}")
        part = open(name, "xb", opener=partial(os.open, mode=mode))  # noqa: SIM115
        with suppress(OSError):  # a disk without locks: nobody sweeps there
            if fcntl is not None:
                fcntl.flock(part, fcntl.LOCK_EX)
        if name.exists():
            return name, part
        part.close()  # taken for a left one, between its making and its lock


def sweep(folder: Path, prefix: str = ".") -> None:
    """Remove the parts that no process holds: those of processes that were killed."""
    with os.scandir(folder) as entries:
        names = [each.path for each in entries if each.name.startswith(prefix) and each.name.endswith(PART)]
    for name in names:
        with suppress(OSError):
            if fcntl is None:
                os.unlink(name)
                continue
            with open(name, "rb", opener=unfollowed) as left:
                fcntl.flock(left, fcntl.LOCK_EX | fcntl.LOCK_NB)
                os.unlink(name)


def unfollowed(name: str, flags: int) -> int:
    """The descriptor of a file that is no link, and does not make one wait."""
    return os.open(name, flags | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0))
