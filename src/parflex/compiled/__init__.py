"""Backends. A new one is a file in this folder and a line in `ALL_BACKENDS`, slowest first."""

from collections.abc import Callable

from parflex.compiled.backend import Backend
from parflex.errors import InputError


def _numpy() -> Backend:
    from parflex.compiled.reference import NumpyBackend

    return NumpyBackend()


def _vm() -> Backend:
    from parflex.compiled.vm import VmBackend

    return VmBackend()


ALL_BACKENDS: dict[str, Callable[[], Backend]] = {"numpy": _numpy, "vm": _vm}


def choose(name: str) -> Backend:
    """The backend of that name; "auto" is the fastest there is.

    Raises InputError for an unknown name.
    """
    if name == "auto":
        return list(ALL_BACKENDS.values())[-1]()
    if name not in ALL_BACKENDS:
        known = ", ".join(f'"{known}"' for known in ALL_BACKENDS)
        raise InputError(f'backend is {name!r}; this version has {known} and "auto" (the fastest)')
    return ALL_BACKENDS[name]()


__all__ = ["ALL_BACKENDS", "Backend", "choose"]
