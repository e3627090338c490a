"""Isoparametric elements: their shape functions and masses.

m_ij = ∫ N_i N_j dm, over a volume, a surface or a line; nodes in the order of Nastran, which the frd
files of CalculiX share; of tetrahedra also VTK, meshio and scikit-fem.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import NamedTuple

import numpy as np
from scipy import sparse
from skfem.quadrature import get_quadrature
from skfem.refdom import Refdom, RefHex, RefLine, RefQuad, RefTet, RefTri, RefWedge

from parflex.base.array import Array
from parflex.fe.body.integrals import Sparse

BATCH = 2000  # elements integrated at once
EXACT = 8  # degree that integrates N_i N_j of all of them, where edges are straight

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
        return np.vstack([corners, *(corners[list(edge)].mean(axis=0) for edge in self.edges)])

    @cached_property
    def sides(self) -> tuple[tuple[int, ...], ...]:
        """The nodes in the middle of each face's edges; empty where there are none."""
        place = {frozenset(edge): len(self.corners) + k for k, edge in enumerate(self.edges)}
        around = [zip(face, (*face[1:], face[0]), strict=True) for face in self.faces]
        return tuple(tuple(place[frozenset(edge)] for edge in edges if place) for edges in around)

    @cached_property
    def to_shapes(self) -> Array:
        """The coefficients (n, n) of the shape functions in the monomials."""
        return np.linalg.inv(monomials(self.powers, self.points.T)).T

    def at(self, X: Array) -> tuple[Array, Array]:
        """N (n, Q) and ∂N/∂ξ (n, d, Q) at reference coordinates (d, Q)."""
        slopes = [self.to_shapes @ monomials(self.powers, X, axis).T for axis in range(len(X))]
        return self.to_shapes @ monomials(self.powers, X).T, np.stack(slopes, axis=1)

    def tabulated(self, degree: int) -> tuple[Array, Array, Array]:
        """N (n, Q), ∂N/∂ξ (n, d, Q) and weights (Q,) at the points of a rule of quadrature."""
        X, weights = quadrature(self.reference, degree)
        return (*self.at(X), weights)

    def masses(self, places: Array, density: Array, degree: int = EXACT) -> Array:
        """∫ N_i N_j dm (E, n, n) of elements at places (E, n, 3), of a density (E,) per measure."""
        N, slopes, weights = self.tabulated(degree)
        blocks = []
        for first in range(0, len(places), BATCH):
            some = slice(first, first + BATCH)
            J = jacobians(places[some], slopes)
            measure = np.sqrt(np.maximum(np.linalg.det(np.swapaxes(J, -1, -2) @ J), 0.0))
            blocks.append(np.einsum("iq,jq,eq,e->eij", N, N, measure * weights, density[some], optimize=True))
        return np.concatenate(blocks)


def jacobians(x: Array, slopes: Array) -> Array:
    """∂x/∂ξ (E, Q, 3, d) of elements with nodes at x (E, n, 3), of slopes ∂N/∂ξ (n, d, Q)."""
    return np.einsum("eia,idq->eqad", x, slopes, optimize=True)


def gradients(x: Array, slopes: Array) -> tuple[Array, Array]:
    """∇N (E, Q, n, 3) and det ∂x/∂ξ (E, Q) of solid elements with nodes at x (E, n, 3)."""
    J = jacobians(x, slopes)
    return np.einsum("idq,eqda->eqia", slopes, np.linalg.inv(J), optimize=True), np.linalg.det(J)


def quadrature(reference: type[Refdom], degree: int) -> tuple[Array, Array]:
    """Points (d, Q) and weights (Q,), exact to a degree, in each direction of a brick; 0 is the centroid.

    A prism has the rule of a line of that degree, times that of a triangle of three less.
    """
    if degree == 0:
        points, weights = get_quadrature(reference, 1)
        return (points @ weights / np.sum(weights))[:, None], np.sum(weights, keepdims=True)
    if reference is not RefWedge:
        return get_quadrature(reference, degree)
    (flat, areas), (along, lengths) = quadrature(RefTri, max(degree - 3, 0)), get_quadrature(RefLine, degree)
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
    return tuple(p for p in product(range(3), repeat=dimension) if sum(q for q in p if q > 1) <= 2)


def times(flat: tuple[tuple[int, ...], ...], along: int) -> tuple[tuple[int, ...], ...]:
    """Exponents of products with 1, ζ, … ζ^along."""
    return tuple((*p, z) for p in flat for z in range(along + 1))


def base_and_lid(flat: tuple[tuple[int, int], ...]) -> tuple[tuple[int, ...], ...]:
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
    "wedge6": Element(RefWedge, base_and_lid(TRIANGLE), (), times(complete(2, 1), 1), PRISM_FACES),
    "wedge15": Element(RefWedge, base_and_lid(TRIANGLE), PRISM_EDGES, PRISM_15, PRISM_FACES),
    "hex8": Element(RefHex, base_and_lid(QUAD), (), times(times(complete(1, 1), 1), 1), BRICK_FACES),
    "hex20": Element(RefHex, base_and_lid(QUAD), BRICK_EDGES, serendipity(3), BRICK_FACES),
}


TET10 = ELEMENTS["tet10"]


class Elements(NamedTuple):
    """Elements of one kind: node numbers (E, n) from 0, and density (E,) per measure, SI."""

    kind: str
    nodes: Array
    density: Array


def mass_matrix(
    places: Array, parts: Iterable[Elements], lumped: bool = False, degrees: Mapping[str, int] | None = None
) -> Sparse:
    """The matrix m (K, K) of nodes (K, 3): consistent, or its rows summed on the diagonal.

    degrees are those of the quadrature of each kind of element, by default exact.
    """
    total = sparse.csr_array((len(places), len(places)))
    for part in parts:
        degree = EXACT if degrees is None else degrees[part.kind]
        blocks = ELEMENTS[part.kind].masses(places[part.nodes], part.density, degree)
        total = total + sum_of_elements(part.nodes, blocks, len(places))
    return sparse.diags_array(np.asarray(total.sum(axis=1)).ravel()).tocsr() if lumped else total


def sum_of_elements(rows: Array, blocks: Array, count: int) -> Sparse:
    """The sparse sum (count, count) of element matrices (E, k, k) over their rows (E, k)."""
    k = rows.shape[1]
    i, j = np.repeat(rows, k, axis=1).ravel(), np.tile(rows, (1, k)).ravel()
    return sparse.coo_array((blocks.ravel(), (i, j)), shape=(count, count)).tocsr()
