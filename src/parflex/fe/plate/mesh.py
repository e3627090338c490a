"""Triangles on a plate: a fan about its centroid, finer and with nodes where joints are."""

import numpy as np
import skfem
from scipy.spatial import Delaunay

from parflex.base.array import Array
from parflex.fe.plate.polygon import centroid, feet

SAME = 1e-6  # of the plate's size: a point so close to a node is that node, to an edge lies on it
SMALLEST = 1e-3  # of the size: edge of an element made finer for a point
NOTHING = 1e-12  # of the size squared: area of a triangle along an edge, by round-off
CLEAR = 0.5  # of the edges about a point: what other nodes keep away from it


def unknowns(corners: int, refine: int) -> int:
    """The number of Argyris unknowns of the fan: 6 per node and 1 per edge."""
    triangles = corners * 4**refine
    edges = (3 * triangles + corners * 2**refine) // 2
    return 6 * (1 + edges - triangles) + edges


def fan_mesh(corners: Array, refine: int) -> skfem.MeshTri:
    """The triangles from the centroid (node 0) to the edges, each refined into four `refine` times."""
    n = len(corners)
    points = np.vstack([centroid(corners), corners]).T
    i = np.arange(n)
    return skfem.MeshTri(points, np.stack([0 * i, 1 + i, 1 + (i + 1) % n])).refined(refine)


def plate_mesh(corners: Array, refine: int, points: Array) -> skfem.MeshTri:
    """The fan with nodes at points (k, 2) of the plate too; nodes 0 … n stay centroid and corners.

    Where all of them are nodes of the fan it is the fan. Else elements about each new point are made
    smaller, to its distance from other points, corners and edges, nodes close to it give way, and the
    rest is triangulated anew (Delaunay).
    """
    mesh = fan_mesh(corners, refine)
    size = float(np.max(np.ptp(corners, axis=0)))
    if not len(apart_from(mesh.p.T, points, SAME * size)):
        return mesh
    fixed = mesh.p.T[: 1 + len(corners)]
    new = apart_from(fixed, np.unique(on_edges(corners, points, SAME * size), axis=0), SAME * size)
    room = np.maximum(rooms(corners, new, SAME * size), SMALLEST * size)
    mesh = finer_at(mesh, new, room)
    near = np.array([np.min(local_edges(mesh, point)) for point in new])
    others = mesh.p.T[len(fixed) :]
    apart = np.linalg.norm(others[:, None] - new, axis=-1)
    return triangulated(np.vstack([fixed, new, others[np.all(apart > CLEAR * near, axis=1)]]), size)


def apart_from(nodes: Array, points: Array, same: float) -> Array:
    """The points (k, 2) that are none of the nodes (V, 2)."""
    return points[np.all(np.linalg.norm(points[:, None] - nodes, axis=-1) > same, axis=1)]


def on_edges(corners: Array, points: Array, same: float) -> Array:
    """The points, those on an edge to within `same` moved onto it."""
    foot, distance = feet(corners, points)
    nearest = np.argmin(distance, axis=1)[:, None]
    close = np.take_along_axis(distance, nearest, axis=1) <= same
    return np.where(close, np.take_along_axis(foot, nearest[..., None], axis=1)[:, 0], points)


def rooms(corners: Array, points: Array, same: float) -> Array:
    """The distance (k,) of each point from the next fixed node, point, or edge that it does not lie on."""
    fixed = np.vstack([centroid(corners), corners])
    to_fixed = np.min(np.linalg.norm(points[:, None] - fixed, axis=-1), axis=1)
    between = np.linalg.norm(points[:, None] - points, axis=-1) + np.diag(np.full(len(points), np.inf))
    to_edges = feet(corners, points)[1]
    beside = np.min(np.where(to_edges > same, to_edges, np.inf), axis=1)
    return np.min([to_fixed, np.min(between, axis=1), beside], axis=0)


def finer_at(mesh: skfem.MeshTri, points: Array, room: Array) -> skfem.MeshTri:
    """The mesh with its elements about each point halved until their edges are no longer than twice its
    room."""
    while True:
        marked = [
            cells[local_edges(mesh, point, cells) > 2 * free]
            for point, free in zip(points, room, strict=True)
            for cells in [cells_at(mesh, point)]
        ]
        coarse = np.unique(np.concatenate(marked))
        if not len(coarse):
            return mesh
        mesh = mesh.refined(coarse)


def cells_at(mesh: skfem.MeshTri, point: Array) -> Array:
    """The numbers of the elements that hold a point or touch one that does."""
    x = mesh.p[:, mesh.t]
    a, b = x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]
    s = point[:, None] - x[:, 0]
    area = a[0] * b[1] - a[1] * b[0]
    u, v = (s[0] * b[1] - s[1] * b[0]) / area, (a[0] * s[1] - a[1] * s[0]) / area
    holds = np.min([u, v, 1 - u - v], axis=0)
    return np.flatnonzero(holds > max(np.max(holds), 0.0) - 1e-6)


def local_edges(mesh: skfem.MeshTri, point: Array, cells: Array | None = None) -> Array:
    """The longest edge (e,) of each of the elements at a point."""
    x = mesh.p[:, mesh.t[:, cells_at(mesh, point) if cells is None else cells]]
    return np.asarray(np.max(np.linalg.norm(x - np.roll(x, 1, axis=1), axis=0), axis=0))


def triangulated(nodes: Array, size: float) -> skfem.MeshTri:
    """The Delaunay triangles of nodes (V, 2) of a convex plate, without those of no area along its edges."""
    cells = Delaunay(nodes).simplices
    a, b = nodes[cells[:, 1]] - nodes[cells[:, 0]], nodes[cells[:, 2]] - nodes[cells[:, 0]]
    area = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    return skfem.MeshTri(nodes.T.copy(), cells[area > NOTHING * size**2].T.copy())
