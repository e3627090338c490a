"""Argyris triangles on a plate: elements, and the meaning of their unknowns."""

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
import skfem
from scipy import sparse

from parflex.base.array import Array
from parflex.fe.plate.mesh import plate_mesh
from parflex.fe.plate.polygon import centroid

NONE = np.zeros((0, 2))
KEPT, FINEST = 8, 3  # plates whose elements are kept, and how often halved at most


Points = tuple[tuple[float, ...], ...]


class About(NamedTuple):
    """A mapping of triangles whose places are told from each one's own centre."""

    mapping: Any

    @property
    def mesh(self) -> skfem.MeshTri:
        """The triangles."""
        return self.mapping.mesh

    def F(self, X: Array, tind: Array) -> Array:
        """The places (2, t, q) of points of the reference triangle."""
        centre = np.mean(self.mesh.p[:, self.mesh.t[:, tind]], axis=1)
        return np.asarray(self.mapping.F(X, tind=tind) - centre[:, :, None])


class Argyris(skfem.ElementTriArgyris):  # type: ignore[misc]
    """The Argyris element, its polynomials about each triangle's centre: about another origin they lose
    digits, all of them in small triangles."""

    def gdof(self, F: Any, w: dict[str, Array], i: int) -> Any:
        centre = np.mean(w["v"], axis=0)
        return super().gdof(F, w | {"v": w["v"] - centre, "e": w["e"] - centre}, i)

    def gbasis(self, mapping: Any, X: Array, i: int, tind: Array | None = None) -> Any:
        chosen = np.arange(mapping.mesh.t.shape[1]) if tind is None else tind
        return super().gbasis(About(mapping), X, i, chosen)


def argyris(corners: Array, refine: int, points: Array = NONE) -> skfem.Basis:
    """The elements about the centroid, with nodes at points (k, 2): their polynomials are ill-conditioned
    far from their origin.

    Those of the last plates are kept, since they take most of the time that modes take; read-only.
    """
    make = kept_elements if refine <= FINEST else argyris_elements
    near, held = (tuple(map(tuple, (places - centroid(corners)).tolist())) for places in (corners, points))
    return make(near, refine, held)


def argyris_elements(corners: Points, refine: int, points: Points) -> skfem.Basis:
    """The elements on a plate about the origin, with their arrays read-only."""
    mesh = plate_mesh(np.array(corners), refine, np.reshape(np.array(points, dtype=float), (-1, 2)))
    basis = skfem.Basis(mesh, Argyris(), intorder=10)
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
