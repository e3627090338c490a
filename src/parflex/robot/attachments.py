"""The nodes of a body that legs hold, given by number or by place."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import exactly
from parflex.base.errors import InputError


def attachment_nodes(nodes: Array, wanted: Sequence[int] | ArrayLike) -> tuple[int, ...]:
    """Node numbers of attachments given as numbers or as points (k, 3)."""
    try:
        array = np.asarray(wanted)
    except ValueError:
        raise InputError("attachments is ragged; give node numbers, or points (k, 3)") from None
    if array.ndim == 1 and (array.dtype.kind in "iu" or array.size == 0):
        return tuple(int(i) for i in array)
    points = exactly("attachments", array, (None, 3))
    size = np.max(np.ptp(nodes, axis=0))
    found = []
    for number, point in enumerate(points):
        distance = np.linalg.norm(nodes - point, axis=1)
        nearest = int(np.argmin(distance))
        if distance[nearest] > 1e-6 * size:
            raise InputError(
                f"attachments[{number}] = {point} is on no node; the nearest, {nearest}, is "
                f"{distance[nearest]:.4g} m away at {nodes[nearest]}: use its number, or, of a plate, "
                f"name the points when it is made: pf.fe.plate_modes(…, points=…)"
            )
        found.append(nearest)
    return tuple(found)
