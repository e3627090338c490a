"""Points of a plate where legs hold it or wrenches act: anywhere on it, in its middle plane."""

from typing import Any

import numpy as np

from parflex.base.array import Array
from parflex.base.check import exactly
from parflex.base.errors import InputError
from parflex.fe.plate.mesh import SAME
from parflex.fe.plate.polygon import outside


def in_space(points: Any, name: str = "points") -> Array:
    """Points (k, 3) m, given as they are or as (k, 2) in the plane z = 0.

    Raises InputError for anything else.
    """
    try:
        flat = np.shape(points)[-1:] == (2,)
    except ValueError:
        raise InputError(f"{name} is ragged; give points of two or three coordinates") from None
    found = exactly(name, points, (None, 2 if flat else 3))
    return np.pad(found, ((0, 0), (0, 1))) if flat else found


def places_of(given: Any) -> Any:
    """Coordinates as they are; None where nodes are named by number, or nothing is."""
    return None if given is None or are_numbers(given) else given


def are_numbers(given: Any) -> bool:
    """True where nodes are named by number."""
    entries = np.ravel(np.asarray(given, dtype=object))
    return len(entries) > 0 and all(isinstance(entry, int | np.integer) for entry in entries)


def on_plate(corners: Array, points: Array, name: str) -> Array:
    """Points (k, 2) of a plate (n, 2), of points (k, 3) m; `name` has a place for their number, from 1.

    Raises InputError for one that is off the plate, with its distance.
    """
    size = float(np.max(np.ptp(corners, axis=0)))
    beside, above = outside(corners, points[:, :2]), points[:, 2]
    for number, (point, off, up) in enumerate(zip(points, beside, above, strict=True), 1):
        where = f"{name.format(number)} at ({', '.join(f'{x:.6g}' for x in point)})"
        if off > SAME * size:
            raise InputError(
                f"{where} is off the plate, {off:.4g} m from its edge; move it onto the plate, or correct "
                f"the outline"
            )
        if abs(up) > SAME * size:
            raise InputError(
                f"{where} is off the plate, {abs(up):.4g} m from its middle plane; hold a thin plate at "
                f"z = 0, or make it a solid"
            )
    return points[:, :2]
