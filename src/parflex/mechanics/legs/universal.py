"""Universal joints: two axes that cross at right angles, and the angles that turn one vector into another."""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, stack

ONE = np.ones(())


class Angles(NamedTuple):
    """(cos, sin) of both angles of a universal joint, and the outward part of what it turns."""

    first: tuple[Array, Array]
    second: tuple[Array, Array]
    outward: Array  # (…, L), across the first axis and the second


def universal(u: Array, way: Array, side: Array, size: Array = ONE) -> Angles:
    """The angles with u = Rot(z, first) Rot(x, side π/2) Rot(z, second) w, w = size · way, for |u| = |w| and
    side ±1 (L,).

    The solution is the one whose outward part is positive.
    """
    across, rise = side * (size * way[..., 2]), side * u[..., 2]
    outward = np.sqrt(u[..., 0] * u[..., 0] + u[..., 1] * u[..., 1] - across * across)
    ratio = across / outward
    level = outward * (1.0 + ratio * ratio)  # zeros among the parts of the way cost nothing in compiled code
    first = ((u[..., 0] - u[..., 1] * ratio) / level, (u[..., 1] + u[..., 0] * ratio) / level)
    far, high, reach = outward / size, rise / size, way[..., 0] * way[..., 0] + way[..., 1] * way[..., 1]
    second = (
        (way[..., 0] * far + way[..., 1] * high) / reach,
        (way[..., 0] * high - way[..., 1] * far) / reach,
    )
    return Angles(first, second, outward)


def in_outward_axes(v: Array, first: tuple[Array, Array], side: Array) -> tuple[Array, Array, Array]:
    """The parts of a vector (…, L, 3) outward, along the first axis, and along the second."""
    c, s = first
    outward = c * v[..., 0] + s * v[..., 1]
    return outward, v[..., 2], side * (s * v[..., 0] - c * v[..., 1])


def turned(x: Array, c: Array, s: Array) -> Array:
    """Rot(z, angle) x for the (cos, sin) of an angle."""
    return stack([c * x[..., 0] - s * x[..., 1], s * x[..., 0] + c * x[..., 1], x[..., 2]])
