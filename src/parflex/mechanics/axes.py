"""The axes of flexible links as points to draw: from a link's frame to the joint or the tip on it."""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.robot.body import FlexibleBody

POINTS = 8  # between the ends of an axis
ALIKE = 1e-6  # of an axis' length: nodes that are abreast


class Axis(NamedTuple):
    """Points (n, 3) m on the line from a link's frame to an attachment, and how they move, (n, 3, N)."""

    places: Array
    shapes: Array


def axis_of(body: FlexibleBody, attachment: int) -> Axis:
    """The points abreast of nodes that divide the line as evenly as the nodes allow.

    A point moves as the nodes abreast of it do in the mean, which is what an axis does between the nodes
    around it. Few nodes give the same point again; without nodes on the way the axis is a cubic.
    """
    end = body.attachment_points[attachment]
    wanted = np.arange(1, POINTS + 1) / (POINTS + 1)
    part = body.nodes @ end / (end @ end)  # of the way along the line
    inner = part[(part > ALIKE) & (part < 1 - ALIKE)]
    if not inner.size:
        return Axis(wanted[:, None] * end, cubic(body, attachment, wanted))
    found = inner[np.argmin(np.abs(inner - wanted[:, None]), axis=1)]
    abreast = (np.abs(part - found[:, None]) <= ALIKE).astype(float)
    means = abreast / abreast.sum(axis=1, keepdims=True)
    return Axis(found[:, None] * end, np.einsum("pk,nka->pan", means, body.shapes))


def cubic(body: FlexibleBody, attachment: int, part: Array) -> Array:
    """Shapes (n, 3, N) of a beam that is clamped at the frame and moved and turned at the attachment only."""
    end, x = body.attachment_points[attachment], part[:, None, None]
    turned = np.cross(body.attachment_turns[attachment], end, axis=0)
    return np.asarray((3 * x**2 - 2 * x**3) * body.attachment_shapes[attachment] + (x**3 - x**2) * turned)
