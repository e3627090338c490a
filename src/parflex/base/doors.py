"""Doors upwards: what a lower folder offers and a higher one does, known by a name alone.

`parflex` itself registers them; what is behind a door is loaded when the door is first opened.
"""

from collections.abc import Callable
from importlib import import_module
from typing import Any

_PLACES: dict[str, str] = {}


def register(door: str, place: str) -> None:
    """Put a function, 'package.module:function', behind a door."""
    _PLACES[door] = place


def opened(door: str) -> Callable[..., Any]:
    """The function behind a door."""
    module, _, function = _PLACES[door].partition(":")
    found: Callable[..., Any] = getattr(import_module(module), function)
    return found
