"""A small solid plate that several test files share."""

from functools import cache

import numpy as np
from skfem import MeshTet

import parflex as pf

SIZE = (0.6, 0.4, 0.02)
MATERIAL = pf.fe.Material(7e10, 0.3, 2700.0)
JOINTS = np.array([(x, y, 0.0) for x, y in ((-0.3, -0.2), (0.3, -0.2), (0.3, 0.2), (-0.3, 0.2))])
TOOL = (0.0, 0.0, 0.01)
RADIUS = 0.035


@cache
def plate() -> pf.fe.FreeBody:
    """An aluminium rectangle, one layer of elements, nodes on its middle plane."""
    cells = (12, 8, 1)
    mesh = MeshTet.init_tensor(*(np.linspace(-s / 2, s / 2, n + 1) for s, n in zip(SIZE, cells, strict=True)))
    return pf.fe.solid_body(pf.fe.solid_mesh(mesh.p.T, mesh.t.T), MATERIAL)


@cache
def modes() -> pf.Modes:
    """Nine free–free modes and attachment modes at the corners and the tool."""
    return pf.fe.FreeFreeWithAttachment(9, JOINTS, TOOL, RADIUS).modes(plate())
