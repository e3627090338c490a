"""Proportions that a plate is hardly meant to have: a length in another unit."""

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.base.kinds import LENGTH
from parflex.base.plausible import doubt, usual

THINNEST, THICKEST = 1e-4, 0.5  # thickness of a plate, of its size
FLAT = 1 / 120  # of a solid plate: elements of some 35,000 unknowns cannot bend in a thinner one


def check_proportions(name: str, outline: Array, thickness: float, most: float = THICKEST) -> None:
    """Doubt an outline (n, 2) m that no machine has, or else a thickness m out of proportion to it."""
    size = float(np.max(np.ptp(outline, axis=0)))
    usual(name, float(f"{size:.6g}"), LENGTH)
    if size <= LENGTH.most and not THINNEST * size <= thickness <= most * size:
        meant = thickness * (1e-3 if thickness > size else 1e3)
        likely = THINNEST * size <= meant <= most * size
        hint = f'did you mean "{1e3 * meant:.6g} mm"?' if likely else "is its unit right?"
        doubt(f"thickness is {thickness:.6g} m on a plate of {size:.6g} m; {hint}")


def check_flat(size: float, thickness: float) -> None:
    """Doubt a solid plate of a size m that is too thin for solid elements; raise InputError where there is
    no mesh of it."""
    if thickness < THINNEST * size:
        raise InputError(
            f"thickness is {thickness:.6g} m on a plate of {size:.6g} m, too thin for any mesh of solid "
            f"elements; give both in the same unit, in files with it"
        )
    if thickness < FLAT * size:
        doubt(
            f"thickness is {thickness:.6g} m on a plate of {size:.6g} m, too thin for the elements of a "
            f"solid, whose frequencies come out too high; make it a thin plate (a polygon; pf.fe.circle has "
            f"the corners of a round one)"
        )
