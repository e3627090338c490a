"""Outlines: convex polygons, checked, and their centres."""

import numpy as np
from numpy.typing import ArrayLike

from parflex.array import Array
from parflex.check import exactly
from parflex.errors import InputError


def convex_polygon(polygon: ArrayLike) -> Array:
    """The corners (n, 2), anticlockwise; the first stays first."""
    corners = exactly("polygon", polygon, (None, 2))
    if len(corners) < 3:
        raise InputError(f"polygon has {len(corners)} corners; a plate needs at least 3")
    edges = np.roll(corners, -1, axis=0) - corners
    turns = edges[:, 0] * np.roll(edges[:, 1], -1) - edges[:, 1] * np.roll(edges[:, 0], -1)
    length = np.linalg.norm(edges, axis=1)
    if np.any(length == 0):
        raise InputError(f"polygon: corner {int(np.argmin(length))} is given twice in a row")
    sine = turns / (length * np.roll(length, -1))
    if not (np.all(sine > 1e-9) or np.all(sine < -1e-9)):
        sense = np.sign(np.sum(turns))
        worst = (int(np.argmin(sine * sense)) + 1) % len(corners)
        raise InputError(
            f"polygon is not convex at corner {worst}, {corners[worst]}; give the corners of a "
            f"convex outline in order, without points on straight edges"
        )
    dots = np.sum(edges * np.roll(edges, -1, axis=0), axis=1)
    angles = abs(np.sum(np.arctan2(turns, dots)))
    if abs(angles - 2 * np.pi) > 1e-6:
        raise InputError("polygon crosses itself; give the corners in order around the outline")
    return corners if turns[0] > 0 else np.roll(corners[::-1], 1, axis=0)


def centroid(corners: Array) -> Array:
    """The centre (2,) of a polygon's area."""
    near = corners - corners[0]
    x, y = near.T
    weights = x * np.roll(y, -1) - y * np.roll(x, -1)
    return corners[0] + (weights @ (near + np.roll(near, -1, axis=0))) / (3 * np.sum(weights))
