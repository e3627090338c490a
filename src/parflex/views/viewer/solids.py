"""Unit solids for the parts of a robot."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array

SIDES = 16


class Solid(NamedTuple):
    """Vertices and outward normals (n, 3), triangles (t, 3)."""

    vertices: Array
    normals: Array
    triangles: Array


def cylinder() -> Solid:
    """A closed cylinder of radius 1 from z = 0 to 1."""
    return lathe([(0, 0), (1, 0), (1, 1), (0, 1)])


def cone() -> Solid:
    """A cone of radius 1 at z = 0, with its point at z = 1."""
    return lathe([(0, 0), (1, 0), (0, 1)])


def drum() -> Solid:
    """A closed cylinder of radius 1 from z = −1 to 1."""
    return lathe([(0, -1), (1, -1), (1, 1), (0, 1)])


def ball() -> Solid:
    """A ball of radius 1 about the origin; a point on it is its own normal."""
    polar = np.linspace(-np.pi / 2, np.pi / 2, 12)
    made = lathe([(float(np.cos(a)), float(np.sin(a))) for a in polar])
    return made._replace(normals=made.vertices)


def tube(rings: int) -> Solid:
    """An open tube of rings that the page puts along a curve, here of radius 1 about z from 0 to 1."""
    angle = np.arange(SIDES) * 2 * np.pi / SIDES
    circle = np.stack([np.cos(angle), np.sin(angle), np.zeros(SIDES)], axis=-1)
    heights = np.linspace(0, 1, rings)[:, None, None] * np.array([0.0, 0.0, 1.0])
    i, following = np.arange(SIDES), (np.arange(SIDES) + 1) % SIDES
    band = np.concatenate(
        [np.stack([i, following, i + SIDES], -1), np.stack([following, following + SIDES, i + SIDES], -1)]
    )
    faces = np.concatenate([band + SIDES * ring for ring in range(rings - 1)])
    return Solid((circle + heights).reshape(-1, 3), np.tile(circle, (rings, 1)), faces)


def lathe(profile: list[tuple[float, float]]) -> Solid:
    """The surface that (radius, height) points, from below to above, draw as they turn about z, with an
    edge at each."""
    bands = [band(*ends) for ends in pairwise(profile)]
    step = 2 * (SIDES + 1)
    i = np.arange(SIDES)
    faces = np.concatenate(
        [np.stack([i, i + 1, i + SIDES + 1], -1), np.stack([i + 1, i + SIDES + 2, i + SIDES + 1], -1)]
    )
    return Solid(
        np.concatenate([points for points, _ in bands]),
        np.concatenate([normals for _, normals in bands]),
        np.concatenate([faces + step * k for k in range(len(bands))]),
    )


def band(low: tuple[float, float], high: tuple[float, float]) -> tuple[Array, Array]:
    """Points and normals (2 (sides + 1), 3) of one edge of a profile as it turns."""
    (r0, z0), (r1, z1) = low, high
    length = np.hypot(r1 - r0, z1 - z0)
    normal = ring((z1 - z0) / length, (r0 - r1) / length)
    return np.concatenate([ring(r0, z0), ring(r1, z1)]), np.concatenate([normal, normal])


def ring(radius: float, height: float) -> Array:
    """Points (sides + 1, 3) on a circle about z, the first one again at the end."""
    angle = np.linspace(0, 2 * np.pi, SIDES + 1)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full_like(angle, height)], axis=-1)
