"""Backends. A new one is a file in this folder and a line in `ALL_BACKENDS`, slowest first."""

from collections.abc import Callable

from parflex.base.errors import InputError
from parflex.compiled.backend import Backend


def _numpy() -> Backend:
    from parflex.compiled.reference import NumpyBackend

    return NumpyBackend()


def _vm() -> Backend:
    from parflex.compiled.vm import VmBackend

    return VmBackend()


def _native() -> Backend:
    from parflex.compiled.native.native import NativeBackend

    return NativeBackend()


ALL_BACKENDS: dict[str, Callable[[], Backend]] = {"numpy": _numpy, "vm": _vm, "native": _native}


def choose(name: str) -> Backend:
    """The backend of that name; "auto" is the fastest there is.

    Raises InputError for an unknown name.
    """
    if name == "auto":
        return fastest()
    if name not in ALL_BACKENDS:
        known = ", ".join(f'"{known}"' for known in ALL_BACKENDS)
        raise InputError(f'backend is {name!r}; this version has {known} and "auto" (the fastest)')
    return ALL_BACKENDS[name]()


def fastest() -> Backend:
    """The fastest backend that this machine has."""
    for make in reversed(ALL_BACKENDS.values()):
        try:
            return make()
        except (ImportError, OSError, RuntimeError):  # a package or a processor that LLVM does not serve
            continue
    raise AssertionError("NumPy is always there")


__all__ = ["ALL_BACKENDS", "Backend", "choose"]
