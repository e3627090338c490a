"""Proportions that a plate is hardly meant to have: a length in another unit."""

import numpy as np

from parflex.base.array import Array
from parflex.base.kinds import LENGTH
from parflex.base.plausible import doubt, usual

THINNEST, THICKEST = 1e-4, 0.5  # thickness of a plate, of its size


def check_proportions(name: str, outline: Array, thickness: float, most: float = THICKEST) -> None:
    """Doubt an outline (n, 2) m that no machine has, and a thickness m that is out of proportion to it."""
    size = float(np.max(np.ptp(outline, axis=0)))
    usual(name, size, LENGTH)
    if not THINNEST * size <= thickness <= most * size:
        meant = thickness * (1e-3 if thickness > size else 1e3)
        likely = THINNEST * size <= meant <= most * size
        hint = f'did you mean "{1e3 * meant:.6g} mm"?' if likely else "is its unit right?"
        doubt(f"thickness is {thickness:.6g} m on a plate of {size:.6g} m; {hint}")
