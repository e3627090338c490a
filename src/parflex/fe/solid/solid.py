"""A free solid: K and M of second-order tetrahedra, linear isotropic elasticity.

∫ (λ div u div v + 2 μ ε(u):ε(v)) dV,   ∫ ρ u·v dV
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy import sparse

from parflex.base.array import Array
from parflex.base.check import all_of_type, of_type
from parflex.base.errors import InputError
from parflex.fe.body.free_body import FreeBody, Sparse
from parflex.fe.body.material import Material
from parflex.fe.body.nodal import body_of_matrices
from parflex.fe.solid.mesh import EDGES, SolidMesh
from parflex.fe.solid.tetrahedron import gradients, quadrature
from parflex.robot.modes import Solid

STRAIGHT, CURVED = (2, 4), (4, 8)  # orders of quadrature of K and M
HEAVIEST, LARGEST, SMALLEST = 20e3, 20.0, 5e-3  # kg, m: beyond them a unit is likely to be wrong


def solid_body(mesh: SolidMesh, material: Material | Sequence[Material], any_size: bool = False) -> FreeBody:
    """The free body of a mesh, one material for all or one for each part.

    Raises InputError for a part without material, and, unless `any_size`, for a body lighter and
    smaller or heavier and larger than platforms are: its unit is likely to be wrong.
    """
    of_type("mesh", mesh, SolidMesh)
    materials = (material,) if isinstance(material, Material) else all_of_type("material", material, Material)
    parts = 1 + int(np.max(mesh.parts))
    if len(materials) not in (1, parts):
        raise InputError(f"material has {len(materials)} entries, the mesh {parts} parts; give one for each")
    table = np.array([(*m.lame, m.density) for m in materials])
    lam, mu, rho = table[np.minimum(mesh.parts, len(materials) - 1)].T
    m = scalar_mass(mesh, rho)
    if not any_size:
        check_size(mesh, float(m.sum()))
    body = body_of_matrices(
        mesh.nodes,
        stiffness(mesh, lam, mu),
        sparse.kron(m, np.eye(3), format="csr"),
        triangles=mesh.triangles,
        source=f"solid, {len(mesh.elements)} second-order tetrahedra, {3 * len(mesh.nodes)} unknowns",
        notes=mesh.notes,
    )
    return replace(body, solid=Solid(mesh.elements, mesh.parts, materials))


def check_size(mesh: SolidMesh, mass: float) -> None:
    """Raise InputError for what is no platform's size or mass."""
    size = float(np.max(np.ptp(mesh.nodes, axis=0)))
    if mass > HEAVIEST or not SMALLEST < size < LARGEST:
        raise InputError(
            f"the body is {size:.4g} m across and weighs {mass:.4g} kg: is its unit of length right? Give "
            f"the unit of the file, or any_size=True if it is so"
        )


def orders(mesh: SolidMesh) -> tuple[int, int]:
    """Of the quadrature of K and M: exact for straight elements, M for curved ones too."""
    x = mesh.nodes[mesh.elements]
    bow = np.max(np.abs(x[:, 4:] - 0.5 * (x[:, EDGES[:, 0]] + x[:, EDGES[:, 1]])))
    return STRAIGHT if bow < 1e-9 * np.max(np.ptp(mesh.nodes, axis=0)) else CURVED


def stiffness(mesh: SolidMesh, lam: Array, mu: Array) -> Sparse:
    """K (3K, 3K)."""
    G, dV = gradients(mesh.nodes[mesh.elements], quadrature(orders(mesh)[0]))
    E, Q = dV.shape
    flat = G.reshape(E, Q, 30)
    H = np.matmul(np.swapaxes(flat * dV[..., None], 1, 2), flat).reshape(E, 10, 3, 10, 3)
    shear = np.einsum("eicjc->eij", H)
    blocks = lam[:, None, None, None, None] * H + mu[:, None, None, None, None] * np.swapaxes(H, 2, 4)
    for a in range(3):
        blocks[:, :, a, :, a] += mu[:, None, None] * shear
    rows = (3 * mesh.elements[:, :, None] + np.arange(3)).reshape(E, 30)
    return gathered(rows, blocks.reshape(E, 30, 30), 3 * len(mesh.nodes))


def scalar_mass(mesh: SolidMesh, rho: Array) -> Sparse:
    """m_ij = ∫ ρ N_i N_j dV (K, K)."""
    points = quadrature(orders(mesh)[1])
    _, dV = gradients(mesh.nodes[mesh.elements], points)
    blocks = np.einsum("eq,qi,qj->eij", rho[:, None] * dV, points.values, points.values, optimize=True)
    return gathered(mesh.elements, blocks, len(mesh.nodes))


def gathered(rows: Array, blocks: Array, count: int) -> Sparse:
    """The sparse sum of element matrices (E, k, k) over their rows (E, k)."""
    k = rows.shape[1]
    i, j = np.repeat(rows, k, axis=1).ravel(), np.tile(rows, (1, k)).ravel()
    return sparse.coo_array((blocks.ravel(), (i, j)), shape=(count, count)).tocsr()
