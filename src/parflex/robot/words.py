"""Numbers and data in a few words, as tables and representations show them."""

from dataclasses import MISSING, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array

LONGEST = 9  # numbers of an array that are shown one by one


def span(values: Array) -> str:
    """One value, or the lowest and the highest."""
    low, high = f"{values.min():.3g}", f"{values.max():.3g}"
    return low if low == high else f"{low} … {high}"


def listed(values: ArrayLike) -> str:
    """(x, y, z), without round-off."""
    return "(" + ", ".join(f"{round(float(value), 9) + 0.0:.4g}" for value in np.asarray(values)) + ")"


def counted(count: int, word: str) -> str:
    """'1 leg', '6 legs'."""
    return f"{count} {word}" + "s" * (count != 1)


def modal(omega: Array) -> str:
    """'10 modes, 9.3 … 41 Hz' of natural frequencies (N,) rad/s; 'rigid' without any."""
    return f"{counted(len(omega), 'mode')}, {span(omega / (2 * np.pi))} Hz" if len(omega) else "rigid"


def frequencies(omega: Array, zeta: Array) -> str:
    """Natural frequencies (N,) rad/s and damping ratios (N,), in a line."""
    if not len(omega):
        return "none, the platform is rigid"
    return f"{len(omega)}, {' '.join(f'{each:.4g}' for each in omega)} rad/s, damping {span(zeta)}"


def told(thing: Any) -> str:
    """A dataclass by those of its fields that are not at their defaults; long arrays by their shapes."""
    shown = []
    for each in fields(thing):
        value = getattr(thing, each.name)
        default = each.default if each.default_factory is MISSING else each.default_factory()
        if default is MISSING or not np.array_equal(value, default):
            shown.append(f"{each.name}={brief(value)}")
    return f"{type(thing).__name__}({', '.join(shown)})"


def brief(value: Any) -> str:
    """A value; of a long array the shape."""
    if not isinstance(value, np.ndarray):
        return repr(value)
    return repr(value.tolist()) if value.size <= LONGEST else f"array of {value.shape}"
