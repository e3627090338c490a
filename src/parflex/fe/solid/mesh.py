"""Meshes of second-order tetrahedra, checked: faults are mended or refused, in words."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from parflex.base.array import Array
from parflex.base.check import exactly, whole_numbers
from parflex.base.errors import InputError
from parflex.fe.body.elements import TET10, TETRA_EDGES, jacobians
from parflex.fe.body.surface import surface

EDGES = np.array(TETRA_EDGES)  # with a node in the middle, which follow the corners
MIRRORED = [1, 0, 2, 3, 4, 6, 5, 8, 7, 9]  # an element seen from the other side

FLAT = 1e-9  # volume below which an element has none, of its longest edge cubed
COINCIDENT = 1e-9  # distance of nodes that are one, of the body's size


class Folded(InputError):
    """An element is folded by its curved edges."""


@dataclass(frozen=True, eq=False)
class SolidMesh:
    """Tetrahedra with ten nodes: nodes (K, 3) m, elements (E, 10) node numbers (corners, then the middles
    of the edges 01 12 20 03 13 23), and the part (E,) from 0 that each belongs to, for its material.

    Built by `solid_mesh`, which checks it.
    """

    nodes: Array
    elements: Array
    parts: Array
    notes: tuple[str, ...] = ()

    @cached_property
    def size(self) -> float:
        """The median edge, m."""
        return float(np.median(edge_lengths(self.nodes, self.elements)))

    @cached_property
    def triangles(self) -> Array:
        """The surface as flat triangles (T, 3)."""
        return surface([("tet10", self.elements)])


def edge_lengths(r: Array, cells: Array) -> Array:
    """The lengths (E, 6) m of the edges between corners."""
    return np.linalg.norm(r[cells[:, EDGES[:, 0]]] - r[cells[:, EDGES[:, 1]]], axis=-1)


def solid_mesh(
    nodes: ArrayLike, elements: ArrayLike, parts: ArrayLike | None = None, notes: tuple[str, ...] = ()
) -> SolidMesh:
    """A checked mesh of tetrahedra, nodes (K, 3) m, elements (E, 4) or (E, 10), parts (E,) from 0.

    Inverted elements are turned, coincident nodes joined, nodes on no element left out, and the notes
    say so. Raises InputError for elements without volume, folded ones, and parts that do not touch.
    """
    r = exactly("nodes", nodes, (None, 3))
    cells = whole_numbers("elements", elements, (None, None))
    if cells.shape[1] not in (4, 10) or len(cells) == 0:
        raise InputError(f"elements has shape {cells.shape}; expected node numbers (E, 4) or (E, 10)")
    if cells.max() >= len(r):
        raise InputError(f"elements names node {cells.max()}; the mesh has nodes 0 … {len(r) - 1}")
    part = np.zeros(len(cells), dtype=int) if parts is None else whole_numbers("parts", parts, (len(cells),))
    r, cells, joined = without_doubles(r, cells)
    cells, turned = upright(r, cells)
    if cells.shape[1] == 4:
        r, cells = with_middles(r, cells)
    one_piece(r, cells)
    unfolded(r, cells)
    return SolidMesh(r, cells, part, (*notes, *joined, *turned))


def without_doubles(r: Array, cells: Array) -> tuple[Array, Array, tuple[str, ...]]:
    """Coincident nodes joined, unused ones left out."""
    used = np.unique(cells)
    size = float(np.max(np.ptp(r[used], axis=0)))
    pairs = cKDTree(r[used]).query_pairs(COINCIDENT * size, output_type="ndarray")
    count = len(used)
    touching = sparse.coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    groups, group = connected_components(touching, directed=False)
    first = np.unique(group, return_index=True)[1]
    new = np.full(len(r), -1)
    new[used] = np.argsort(np.argsort(first))[group]
    joined = (f"{count - groups} coincident nodes were joined",) * (groups < count)
    idle = (f"{len(r) - count} nodes on no element were left out",) * (count < len(r))
    return r[used[np.sort(first)]], new[cells], (*joined, *idle)


def upright(r: Array, cells: Array) -> tuple[Array, tuple[str, ...]]:
    """Elements of positive volume. Raises InputError where one has none."""
    corner = r[cells[:, :4]]
    volume = np.linalg.det(corner[:, 1:] - corner[:, :1]) / 6.0
    flat = np.flatnonzero(np.abs(volume) <= FLAT * np.max(edge_lengths(r, cells), axis=1) ** 3)
    if len(flat):
        raise InputError(
            f"element {flat[0]} has no volume (corners {corner[flat[0]].tolist()}), and {len(flat) - 1} "
            f"more; remove such elements, or mesh the body again"
        )
    inverted = volume < 0
    if not np.any(inverted):
        return cells, ()
    cells = np.where(inverted[:, None], cells[:, MIRRORED[: cells.shape[1]]], cells)
    return cells, (f"{np.sum(inverted)} inverted elements were turned",)


def with_middles(r: Array, cells: Array) -> tuple[Array, Array]:
    """Nodes in the middle of straight edges."""
    ends, edge = np.unique(np.sort(cells[:, EDGES].reshape(-1, 2), axis=1), axis=0, return_inverse=True)
    middles = 0.5 * (r[ends[:, 0]] + r[ends[:, 1]])
    return np.vstack([r, middles]), np.hstack([cells, len(r) + edge.reshape(len(cells), 6)])


def one_piece(r: Array, cells: Array) -> None:
    """Raise InputError where parts share no node."""
    count = len(r)
    links = sparse.coo_array(
        (np.ones(3 * len(cells)), (np.repeat(cells[:, 0], 3), cells[:, 1:4].ravel())), shape=(count, count)
    )
    _, group = connected_components(links, directed=False)
    names = np.unique(group[cells[:, 0]])
    if len(names) == 1:
        return
    first = group[cells[:, 0]] == names[0]
    one, rest = (r[np.unique(cells[chosen, :4])] for chosen in (first, ~first))
    gap = float(np.min(cKDTree(one).query(rest)[0]))
    raise InputError(
        f"the mesh has {len(names)} parts that do not touch, {gap:.3g} m apart at their nearest nodes; a "
        f"body is one piece: join them, or mesh their common faces alike"
    )


def unfolded(r: Array, cells: Array) -> None:
    """Raise InputError where curved edges fold an element."""
    worst = np.min(np.linalg.det(jacobians(r[cells], TET10.at(TET10.points.T)[1])), axis=1)
    if np.any(worst <= 0):
        raise Folded(
            f"element {int(np.argmin(worst))} is folded by its curved edges; mesh finer there, or with "
            f"straight edges"
        )
