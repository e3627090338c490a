"""Rigid links from dimensions and materials: M, MS and I of a `Joint`, about the link frame's origin."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from parflex.base.array import Array

Link = dict[str, Any]  # M kg, MS (3,) kg m, I (3, 3) kg m², in the axes of the link frame


def tube(
    density: float, radius: float, start: Sequence[float], end: Sequence[float], bore: float = 0
) -> Link:
    """A round tube between two points (3,) m, of outer radius and bore radius m; kg/m³.

    With e along it: I_c = ½ m (R² + r²) e eᵀ + m (3 (R² + r²) + ℓ²)/12 (1 − e eᵀ).
    """
    along = np.subtract(end, start)
    length = float(np.linalg.norm(along))
    m = density * np.pi * (radius**2 - bore**2) * length
    round_, ee = radius**2 + bore**2, np.outer(along, along) / length**2
    inertia = m * round_ / 2 * ee + m * (3 * round_ + length**2) / 12 * (np.eye(3) - ee)
    return link(m, np.add(start, end) / 2, inertia)


def box(density: float, size: Sequence[float], centre: Sequence[float] = (0, 0, 0)) -> Link:
    """A block of sides `size` (3,) m along the axes of the frame: I_c = m/12 (|s|² 1 − diag s²); kg/m³."""
    s = np.square(size)
    m = density * float(np.prod(size))
    return link(m, np.asarray(centre, dtype=float), m / 12 * (np.sum(s) * np.eye(3) - np.diag(s)))


def link(m: float, centre: Array, inertia_at_centre: Array) -> Link:
    """A body of mass m kg with its centre of mass at `centre` (3,) m: I = I_c + m (|c|² 1 − c cᵀ)."""
    c = np.asarray(centre)
    return {"M": m, "MS": m * c, "I": inertia_at_centre + m * (c @ c * np.eye(3) - np.outer(c, c))}


def together(*links: Link) -> Link:
    """Links of one frame as one link."""
    return {name: sum(part[name] for part in links) for name in ("M", "MS", "I")}
