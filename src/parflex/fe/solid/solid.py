"""A free solid: K and M of second-order tetrahedra, linear isotropic elasticity.

∫ (λ div u div v + 2 μ ε(u):ε(v)) dV,   ∫ ρ u·v dV
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy import sparse

from parflex.base.array import Array
from parflex.base.check import of_type
from parflex.base.errors import InputError
from parflex.fe.body.elements import TET10, Elements, gradients, mass_matrix, sum_of_elements
from parflex.fe.body.free_body import FreeBody
from parflex.fe.body.integrals import Sparse
from parflex.fe.body.nodal import body_of_matrices
from parflex.fe.body.solid import Solid
from parflex.fe.solid.mesh import EDGES, SolidMesh
from parflex.robot.material import Material
from parflex.robot.materials import chosen

STRAIGHT, CURVED = (2, 4), (4, 8)  # degrees of quadrature of K and M
HEAVIEST, LARGEST, SMALLEST = 20e3, 20.0, 5e-3  # kg, m: beyond them a unit is likely to be wrong


def solid_body(
    mesh: SolidMesh, material: Material | str | Sequence[Material | str], any_size: bool = False
) -> FreeBody:
    """The free body of a mesh, one material for all or one for each part, by name or by its numbers.

    Raises InputError for a part without material, a name that it does not know, and, unless `any_size`, for
    a body lighter and smaller or heavier and larger than platforms are: its unit is likely to be wrong.
    """
    of_type("mesh", mesh, SolidMesh)
    materials = tuple(map(chosen, material if isinstance(material, (list, tuple)) else [material]))
    parts = 1 + int(np.max(mesh.parts))
    if len(materials) not in (1, parts):
        raise InputError(f"material has {len(materials)} entries, the mesh {parts} parts; give one for each")
    solid = Solid(mesh.elements, mesh.parts, materials)
    lam, mu, rho = solid.by_element(np.array([(*m.lame, m.density) for m in materials])).T
    of_K, of_M = exact_degrees(mesh)
    m = mass_matrix(mesh.nodes, [Elements("tet10", mesh.elements, rho)], degrees={"tet10": of_M})
    if not any_size:
        check_unit(mesh, float(m.sum()))
    body = body_of_matrices(
        mesh.nodes,
        stiffness(mesh, lam, mu, of_K),
        sparse.kron(m, np.eye(3), format="csr"),
        triangles=mesh.triangles,
        source=f"solid, {len(mesh.elements)} second-order tetrahedra, {3 * len(mesh.nodes)} unknowns",
        notes=mesh.notes,
    )
    return replace(body, solid=solid, materials=materials)


def check_unit(mesh: SolidMesh, mass: float) -> None:
    """Raise InputError for a size or mass that no platform has."""
    size = float(np.max(np.ptp(mesh.nodes, axis=0)))
    if mass > HEAVIEST or not SMALLEST < size < LARGEST:
        raise InputError(
            f"the body is {size:.4g} m across and weighs {mass:.4g} kg: is its unit of length right? Give "
            f"the unit of the file, or any_size=True if it is so"
        )


def exact_degrees(mesh: SolidMesh) -> tuple[int, int]:
    """The degrees of quadrature of K and M: exact for straight elements, M for curved ones too."""
    x = mesh.nodes[mesh.elements]
    bow = np.max(np.abs(x[:, 4:] - 0.5 * (x[:, EDGES[:, 0]] + x[:, EDGES[:, 1]])))
    return STRAIGHT if bow < 1e-9 * np.max(np.ptp(mesh.nodes, axis=0)) else CURVED


def stiffness(mesh: SolidMesh, lam: Array, mu: Array, degree: int) -> Sparse:
    """The stiffness K (3K, 3K), of moduli λ and μ (E,)."""
    _, slopes, weights = TET10.tabulated(degree)
    G, volume = gradients(mesh.nodes[mesh.elements], slopes)
    E, Q = volume.shape
    flat = G.reshape(E, Q, 30)
    H = np.matmul(np.swapaxes(flat * (volume * weights)[..., None], 1, 2), flat).reshape(E, 10, 3, 10, 3)
    shear = np.einsum("eicjc->eij", H)
    blocks = lam[:, None, None, None, None] * H + mu[:, None, None, None, None] * np.swapaxes(H, 2, 4)
    for a in range(3):
        blocks[:, :, a, :, a] += mu[:, None, None] * shear
    rows = (3 * mesh.elements[:, :, None] + np.arange(3)).reshape(E, 30)
    return sum_of_elements(rows, blocks.reshape(E, 30, 30), 3 * len(mesh.nodes))
