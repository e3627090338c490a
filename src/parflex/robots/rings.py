"""Points, legs and plates about a centre."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from parflex.base.array import Array
from parflex.base.check import integer
from parflex.base.spatial import rotation_about_z
from parflex.robot.body import FlexibleBody

THIRDS = (0, 120, 240)  # degrees


def ring(radius: float, degrees: Sequence[float]) -> Array:
    """Points (n, 2) m on a circle."""
    angle = np.radians(degrees)
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def cut_triangle(radius: float) -> Array:
    """The corners (6, 2) m of a triangle without its tips; its short sides face `THIRDS`."""
    return ring(radius, [middle + aside for middle in THIRDS for aside in (-20, 20)])


def short_sides(corners: Array) -> Array:
    """The middles (3, 2) m of the short sides of a cut triangle."""
    return corners.reshape(3, 2, 2).mean(axis=1)


def standing(radius: float, degrees: float, turn: float = 0.0) -> tuple[Array, Array]:
    """Axes (3, 3) and origin (3,) m of a base frame on a circle in the ground: z up, x at `turn` degrees
    from outwards."""
    axes = rotation_about_z(np.asarray(np.radians(degrees + turn)))
    return axes, np.append(ring(radius, [degrees])[0], 0.0)


def plate(
    corners: Array,
    modes: int,
    damping_ratio: float,
    attachments: Array | None = None,
    **section: Any,
) -> FlexibleBody:
    """A plate held at its corners (n, 2) m or at other nodes (k, 2), Σp where they are given.

    modes = 0 is rigid; `section` is what `fe.plate_modes` asks for: thickness and material.
    """
    from parflex.fe import plate_modes

    computed = plate_modes(corners, n_modes=integer("modes", modes), **section)
    held = None if attachments is None else np.pad(attachments, ((0, 0), (0, 1)))
    return FlexibleBody.from_modes(computed, held, origin=(0.0, 0.0, 0.0), damping_ratio=damping_ratio)
