"""Argyris triangles on a plate: mesh, elements, and the meaning of their unknowns."""

from functools import lru_cache

import numpy as np
import skfem
from scipy import sparse

from parflex.base.array import Array
from parflex.fe.plate.polygon import centroid

KEPT, FINEST = 8, 3  # plates whose elements are kept, and how often halved at most


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


def argyris(corners: Array, refine: int) -> skfem.Basis:
    """The elements about the centroid: their polynomials are ill-conditioned far from their origin.

    Those of the last plates are kept, since they take most of the time that modes take; read-only.
    """
    make = kept_elements if refine <= FINEST else argyris_elements
    return make(tuple(map(tuple, (corners - centroid(corners)).tolist())), refine)


def argyris_elements(corners: tuple[tuple[float, ...], ...], refine: int) -> skfem.Basis:
    """The elements on a fan about the origin, with their arrays read-only."""
    basis = skfem.Basis(fan_mesh(np.array(corners), refine), skfem.ElementTriArgyris(), intorder=10)
    fields = [part for functions in basis.basis for field in functions for part in field if part is not None]
    for array in (basis.mesh.p, basis.mesh.t, basis.dx, *fields):
        array.flags.writeable = False
    return basis


kept_elements = lru_cache(maxsize=KEPT)(argyris_elements)


def node_rows(basis: skfem.Basis, components: dict[int, tuple[int, float]]) -> sparse.csr_array:
    """The matrix (3V, n) of components at the vertices, each a signed nodal unknown (w, w_x, w_y, …)."""
    vertices = np.arange(basis.mesh.nvertices)
    rows = np.concatenate([3 * vertices + component for component in components])
    columns = np.concatenate([basis.dofs.nodal_dofs[kind] for kind, _ in components.values()])
    signs = np.repeat([sign for _, sign in components.values()], len(vertices))
    return sparse.csr_array((signs, (rows, columns)), shape=(3 * len(vertices), basis.N))
