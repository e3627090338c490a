"""Isoparametric elements of other programs: what they weigh, and their surface.

m_ij = ∫ N_i N_j dm, over a volume, a surface or a line; nodes in the order of Nastran, which the frd
files of CalculiX share.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
from scipy import sparse
from skfem.quadrature import get_quadrature
from skfem.refdom import Refdom, RefHex, RefLine, RefQuad, RefTet, RefTri, RefWedge

from parflex.array import Array
from parflex.fe.free_body import Sparse

TRIANGLE = ((0, 0), (1, 0), (0, 1))
QUAD = ((0, 0), (1, 0), (1, 1), (0, 1))
BRICK_FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
PRISM_FACES = ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5))
TETRA_FACES = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3))
BRICK_EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 5), (2, 6), (3, 7), (4, 5), (5, 6), (6, 7), (7, 4))
PRISM_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 4), (2, 5), (3, 4), (4, 5), (5, 3))
TETRA_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))


@dataclass(frozen=True)
class Element:
    """Corners, the edges with a node in the middle, monomials of the shape functions, faces."""

    reference: type[Refdom]
    corners: tuple[tuple[int, ...], ...]
    edges: tuple[tuple[int, int], ...]
    powers: tuple[tuple[int, ...], ...]
    faces: tuple[tuple[int, ...], ...] = ()

    @cached_property
    def points(self) -> Array:
        """The nodes' reference coordinates (n, d)."""
        corners = np.array(self.corners, dtype=float)
        middles = [corners[list(edge)].mean(axis=0) for edge in self.edges]
        return np.vstack([corners, *middles])

    @cached_property
    def tabulated(self) -> tuple[Array, Array, Array]:
        """N (n, Q), ∂N/∂ξ (n, d, Q) and weights (Q,) at points that integrate N_i N_j."""
        at, weights = quadrature(self.reference)
        to_shapes = np.linalg.inv(monomials(self.powers, self.points.T)).T
        d = len(at)
        slopes = [to_shapes @ monomials(self.powers, at, axis).T for axis in range(d)]
        return to_shapes @ monomials(self.powers, at).T, np.stack(slopes, axis=1), weights

    def masses(self, places: Array, density: Array) -> Array:
        """∫ N_i N_j dm (E, n, n) of elements at places (E, n, 3), of a density (E,) per measure."""
        N, slopes, weights = self.tabulated
        J = np.einsum("idq,eia->eqad", slopes, places)
        measure = np.sqrt(np.maximum(np.linalg.det(np.swapaxes(J, -1, -2) @ J), 0.0))
        return np.einsum("iq,jq,eq,e->eij", N, N, measure * weights, density, optimize=True)

    def measures(self, places: Array) -> Array:
        """Volume, area or length (E,)."""
        return np.sum(self.masses(places, np.ones(len(places))), axis=(1, 2))


def quadrature(reference: type[Refdom]) -> tuple[Array, Array]:
    """Points (d, Q) and weights (Q,), exact to degree 8 at least."""
    if reference is not RefWedge:
        return get_quadrature(reference, 8)
    (flat, areas), (along, lengths) = get_quadrature(RefTri, 8), get_quadrature(RefLine, 8)
    points = [np.repeat(flat, len(lengths), axis=1), np.tile(along, len(areas))]
    return np.vstack(points), np.repeat(areas, len(lengths)) * np.tile(lengths, len(areas))


def monomials(powers: tuple[tuple[int, ...], ...], at: Array, slope: int | None = None) -> Array:
    """ξ^a η^b ζ^c (P, n) at points (d, P), or their derivatives along one axis."""
    columns = []
    for power in powers:
        factor, lowered = 1.0, list(power)
        if slope is not None:
            factor, lowered[slope] = float(power[slope]), max(power[slope] - 1, 0)
        columns.append(factor * np.prod([x**p for x, p in zip(at, lowered, strict=True)], axis=0))
    return np.stack([column * np.ones_like(at[0]) for column in columns], axis=-1)


def complete(dimension: int, degree: int) -> tuple[tuple[int, ...], ...]:
    """Exponents of all monomials up to a degree."""
    return tuple(p for p in product(range(degree + 1), repeat=dimension) if sum(p) <= degree)


def serendipity(dimension: int) -> tuple[tuple[int, ...], ...]:
    """Exponents whose part of second degree or more in single variables is at most a square."""
    every = product(range(3), repeat=dimension)
    return tuple(p for p in every if sum(q for q in p if q > 1) <= 2)


def times(flat: tuple[tuple[int, ...], ...], along: int) -> tuple[tuple[int, ...], ...]:
    """Exponents of products with 1, ζ, … ζ^along."""
    return tuple((*p, z) for p in flat for z in range(along + 1))


def stacked(flat: tuple[tuple[int, int], ...]) -> tuple[tuple[int, ...], ...]:
    """A base at ζ = 0 and a lid at ζ = 1."""
    return tuple((*p, z) for z in (0, 1) for p in flat)


SPAN = ((0,), (1,))
TETRA = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
PRISM_15 = times(complete(2, 2), 1) + tuple((*p, 2) for p in complete(2, 1))
TRIANGLE_EDGES, QUAD_EDGES = TETRA_EDGES[:3], BRICK_EDGES[:4]
FLAT_3, FLAT_4 = ((0, 1, 2),), ((0, 1, 2, 3),)

ELEMENTS = {
    "line2": Element(RefLine, SPAN, (), complete(1, 1)),
    "tri3": Element(RefTri, TRIANGLE, (), complete(2, 1), FLAT_3),
    "tri6": Element(RefTri, TRIANGLE, TRIANGLE_EDGES, complete(2, 2), FLAT_3),
    "quad4": Element(RefQuad, QUAD, (), times(complete(1, 1), 1), FLAT_4),
    "quad8": Element(RefQuad, QUAD, QUAD_EDGES, serendipity(2), FLAT_4),
    "tet4": Element(RefTet, TETRA, (), complete(3, 1), TETRA_FACES),
    "tet10": Element(RefTet, TETRA, TETRA_EDGES, complete(3, 2), TETRA_FACES),
    "wedge6": Element(RefWedge, stacked(TRIANGLE), (), times(complete(2, 1), 1), PRISM_FACES),
    "wedge15": Element(RefWedge, stacked(TRIANGLE), PRISM_EDGES, PRISM_15, PRISM_FACES),
    "hex8": Element(RefHex, stacked(QUAD), (), times(times(complete(1, 1), 1), 1), BRICK_FACES),
    "hex20": Element(RefHex, stacked(QUAD), BRICK_EDGES, serendipity(3), BRICK_FACES),
}


@dataclass(frozen=True, eq=False)
class Elements:
    """Elements of one kind: node numbers (E, n) from 0, and density (E,) per measure, SI."""

    kind: str
    nodes: Array
    density: Array


def mass_matrix(places: Array, parts: Iterable[Elements], lumped: bool) -> Sparse:
    """m (K, K) of nodes (K, 3): consistent, or its rows summed on the diagonal."""
    total = sparse.csr_array((len(places), len(places)))
    for part in parts:
        blocks = ELEMENTS[part.kind].masses(places[part.nodes], part.density)
        n = part.nodes.shape[1]
        rows, columns = np.repeat(part.nodes, n, axis=1), np.tile(part.nodes, (1, n))
        flat = (blocks.ravel(), (rows.ravel(), columns.ravel()))
        total = total + sparse.coo_array(flat, shape=total.shape).tocsr()
    return sparse.diags_array(np.asarray(total.sum(axis=1)).ravel()).tocsr() if lumped else total


def surface(parts: Iterable[Elements]) -> Array:
    """Triangles (T, 3) of shells, and of the faces of solids that have no neighbour."""
    found = [np.zeros((0, 3), dtype=int)]
    lone: dict[tuple[int, ...], list[tuple[int, ...]]] = {}
    for part in parts:
        element = ELEMENTS[part.kind]
        shell = len(element.faces) == 1
        for face in element.faces:
            corners = part.nodes[:, list(face)]
            if shell:
                found.append(triangles(corners))
                continue
            for key, row in zip(map(tuple, np.sort(corners, axis=1)), corners, strict=True):
                lone.setdefault(key, []).append(tuple(row))
    outer = [rows[0] for rows in lone.values() if len(rows) == 1]
    for n in (3, 4):
        faces = [row for row in outer if len(row) == n]
        if faces:
            found.append(triangles(np.array(faces)))
    return np.concatenate(found)


def triangles(faces: Array) -> Array:
    """Faces (F, 3 or 4) cut into triangles."""
    fans = [faces[:, [0, k, k + 1]] for k in range(1, faces.shape[1] - 1)]
    return np.concatenate(fans)
