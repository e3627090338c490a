"""Rectangular blocks of steel, meshed with tetrahedra."""

import numpy as np
from skfem import MeshTet

import parflex as pf

STEEL = pf.fe.Material(2.1e11, 0.3, 7850.0)


def box(size, cells) -> pf.fe.SolidMesh:
    """A block about the origin, in cells of six tetrahedra."""
    mesh = MeshTet.init_tensor(*(np.linspace(-s / 2, s / 2, n + 1) for s, n in zip(size, cells, strict=True)))
    return pf.fe.solid_mesh(mesh.p.T, mesh.t.T)


def two_blocks(gap: float) -> tuple[np.ndarray, np.ndarray]:
    """Corner meshes side by side."""
    one = box((0.1, 0.1, 0.1), (1, 1, 1))
    r = one.nodes[: 1 + one.elements[:, :4].max()]
    cells = one.elements[:, :4]
    return np.vstack([r, r + [0.1 + gap, 0, 0]]), np.vstack([cells, cells + len(r)])
