"""Packages that are not needed for all of parflex."""

from importlib import import_module
from typing import Any

from parflex.base.errors import InputError


def extra(module: str, words: str) -> Any:
    """A module of a package that may be absent; raises InputError with those words where it is."""
    try:
        return import_module(module)
    except ImportError:
        raise InputError(words) from None
