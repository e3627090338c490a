"""Faces of a body: the nodes of the smooth part of its surface on which a point lies.

A face ends where the surface turns by more than `SHARP`, as at the edges of a drawing: the end of a tube, the
wall of a bore. A point inside a ring lies on the face in whose plane it is.
"""

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from parflex.base.array import Array, dot
from parflex.base.errors import InputError

SHARP = np.cos(np.radians(30.0))  # of the angle between neighbouring triangles
TIED = 1e-3  # of the body's size: distances from a point that are equal


def face_at(r: Array, triangles: Array, name: str, point: Array) -> Array:
    """The nodes, of those at r (K, 3), of the face of triangles (T, 3) on which a point (3,) m lies, within
    its outline or in its hole.

    Raises InputError where the body has no surface, and where the point lies on no face.
    """
    if not len(triangles):
        raise InputError(
            f"{name} names a face, but the body has no surface, only nodes; give ids, the numbers of the "
            f"nodes of the frame and of each interface, or radius, within which they are"
        )
    corners = r[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    near = distances(corners, normals, point)
    size = float(np.max(np.ptp(r, axis=0)))
    tied = np.flatnonzero(near <= np.min(near) + TIED * size)
    above = np.abs(dot(normals[tied], point - corners[tied, 0]))
    first = int(tied[np.argmin(above)])
    parts = smooth_parts(triangles, normals)
    nodes = np.unique(triangles[parts == parts[first]])
    low, high = (edge(r[nodes], axis=0) for edge in (np.min, np.max))
    off = float(np.linalg.norm(point - np.clip(point, low, high)))
    if off > TIED * size:
        raise InputError(
            f"{name} at {point} m is nowhere on the part: the nearest face, of {len(nodes)} nodes, begins "
            f"{off:.4g} m away; move it onto a face or into a hole, or give a radius that reaches the part"
        )
    return nodes


def distances(corners: Array, normals: Array, point: Array) -> Array:
    """The distances (T,) m of a point from triangles (T, 3, 3) of unit normals (T, 3)."""
    height = dot(normals, point - corners[:, 0])
    foot = point - height[:, None] * normals
    inside, edges = np.ones(len(corners), dtype=bool), []
    for k in range(3):
        a, along = corners[:, k], corners[:, (k + 1) % 3] - corners[:, k]
        inside &= dot(np.cross(along, foot - a), normals) >= 0.0
        part = np.clip(dot(point - a, along) / np.maximum(dot(along, along), 1e-300), 0.0, 1.0)
        edges.append(np.linalg.norm(point - a - part[:, None] * along, axis=1))
    return np.where(inside, np.abs(height), np.min(edges, axis=0))


def smooth_parts(triangles: Array, normals: Array) -> Array:
    """The number (T,) of the smooth part that each triangle belongs to."""
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    owner = np.repeat(np.arange(len(triangles)), 3)
    order = np.lexsort(edges.T)
    edges, owner = edges[order], owner[order]
    shared = np.flatnonzero(np.all(edges[1:] == edges[:-1], axis=1))
    a, b = owner[shared], owner[shared + 1]
    flat = dot(normals[a], normals[b]) >= SHARP
    count = len(triangles)
    links = sparse.coo_array((np.ones(np.sum(flat)), (a[flat], b[flat])), shape=(count, count))
    return np.asarray(connected_components(links, directed=False)[1])
