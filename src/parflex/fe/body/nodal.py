"""A free body from matrices over nodal displacements: the solid's own, or those of another program."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse
from scipy.linalg import eigh

from parflex.base.array import Array, skew
from parflex.base.check import exactly, whole_numbers
from parflex.base.errors import InputError
from parflex.fe.body.free_body import FreeBody
from parflex.fe.body.integrals import Sparse, by_node, nodal_moments, rigid_fields

FREE = 1e-3  # stiffness against rigid motions, of the first elastic mode's, at most
ALIKE = 1e-6  # the mass matrix, in the three directions
BELOW = 1e-3  # the shift, of an estimate of the first elastic ω²


def body_of_matrices(
    nodes: ArrayLike,
    stiffness: Sparse,
    mass: Sparse,
    unknowns: ArrayLike | None = None,
    triangles: ArrayLike | None = None,
    corners: Sequence[int] = (),
    source: str = "stiffness and mass matrices",
    notes: Sequence[str] = (),
) -> FreeBody:
    """A free body from K and M (3K, 3K), sparse, over the displacements of its nodes (K, 3) m.

    unknowns (3K, 2) holds node and component (0, 1, 2) of each row, both from 0; by default x, y, z of
    node after node. triangles (T, 3) are a surface to draw. SI units.

    Raises InputError for matrices that do not fit the nodes or are not symmetric, for a mass matrix
    that is not the same in the three directions, and for a stiffness that resists rigid motions.
    """
    r = exactly("nodes", nodes, (None, 3))
    order = row_order(len(r), unknowns)
    K, M = (ordered(name, X, order) for name, X in (("stiffness", stiffness), ("mass", mass)))
    scalar = scalar_mass(M)
    shift = BELOW * first_elastic(r, K, M)
    return FreeBody(
        nodes=r,
        stiffness=K,
        mass=M,
        displacement=sparse.eye_array(3 * len(r), format="csr"),
        rotation=turns(r, K),
        patches=True,
        rigid=rigid_motions(r - np.asarray(scalar @ r).sum(axis=0) / scalar.sum()),
        moments=lambda vectors: nodal_moments(r, scalar, by_node(vectors)),
        shift=shift,
        triangles=np.zeros((0, 3), dtype=int)
        if triangles is None
        else whole_numbers("triangles", triangles, (None, 3)),
        corners=tuple(whole_numbers("corners", corners).tolist()),
        source=source,
        notes=tuple(notes),
    )


def row_order(nodes: int, unknowns: ArrayLike | None) -> Array:
    """The row of x, y, z of node after node; (3K,)."""
    if unknowns is None:
        return np.arange(3 * nodes)
    table = whole_numbers("unknowns", unknowns, (None, 2))  # node, component
    if np.any(table[:, 1] > 2):
        raise InputError(
            "unknowns has rotations (components above 2); only models whose nodes move without turning have "
            "integrals here: use solid elements, or import the modes instead of the matrices"
        )
    if np.any(table[:, 0] >= nodes):
        raise InputError(f"unknowns names a node or component that there is not; nodes are 0 … {nodes - 1}")
    found = 3 * table[:, 0] + table[:, 1]
    if len(found) != 3 * nodes or len(np.unique(found)) != 3 * nodes:
        missing = np.setdiff1d(np.arange(3 * nodes), found)
        words = f"node {missing[0] // 3} has no component {missing[0] % 3}" if len(missing) else "some twice"
        raise InputError(
            f"unknowns has {len(found)} rows for {nodes} nodes, {words}; a free body has the three "
            f"displacements of each node as unknowns: remove constraints, and nodes that are on no element"
        )
    return np.argsort(found)


def ordered(name: str, matrix: Sparse, order: Array) -> Sparse:
    """The matrix in the nodes' order, symmetric."""
    given = sparse.csr_array(matrix if sparse.issparse(matrix) else exactly(name, matrix, (None, None)))
    if given.shape != (len(order), len(order)):
        raise InputError(f"{name} has shape {given.shape}; the nodes make it {(len(order), len(order))}")
    if given.dtype.kind not in "biuf" or not np.all(np.isfinite(given.data)):
        raise InputError(f"{name} has entries that are no finite real numbers")
    largest = np.max(np.abs(given.data), initial=0.0)
    if abs(given - given.T).max() > 1e-6 * largest:
        raise InputError(f"{name} is not symmetric; give the whole matrix, not one triangle of it")
    return (0.5 * (given + given.T))[order][:, order].tocsr()


def scalar_mass(M: Sparse) -> Sparse:
    """The matrix m (K, K) of M = m ⊗ 1. Raises InputError where M is no such product."""
    along = [M[axis::3, axis::3] for axis in range(3)]
    largest = np.max(np.abs(M.data), initial=0.0)
    apart = max(abs(along[0] - other).max() for other in along[1:])
    across = max(abs(M[a::3, b::3]).max() for a, b in ((0, 1), (0, 2), (1, 2)))
    if max(apart, across) > ALIKE * largest:
        raise InputError(
            "mass is not the same in the three directions, so that it is no mass of solid elements; give the "
            "consistent or lumped mass of a model without mass scaling, rotations or condensation"
        )
    return along[0].tocsr()


def rigid_motions(r: Array) -> Array:
    """The rigid displacements (3K, 6): unit translations along the axes, rotations about them."""
    return rigid_fields(r).reshape(6, -1).T


def turns(r: Array, K: Sparse) -> Sparse:
    """The rotation at each node (3K, 3K): the mean one of the nodes it shares elements with.

    θ_i = J_i⁻¹ Σ_j s_j × u_j, J_i = Σ_j (|s_j|² 1 − s_j s_jᵀ), s_j from the centre of those nodes.
    """
    count = len(r)
    blocks = K.tobsr((3, 3))
    i, j = np.repeat(np.arange(count), np.diff(blocks.indptr)), blocks.indices
    near = np.bincount(i, minlength=count)
    centre = np.stack([np.bincount(i, r[j, axis], count) / near for axis in range(3)], axis=1)
    s = r[j] - centre[i]
    second = np.add.reduceat(s[:, :, None] * s[:, None, :], blocks.indptr[:-1], axis=0)
    J = np.trace(second, axis1=1, axis2=2)[:, None, None] * np.eye(3) - second
    turning = np.linalg.pinv(J, rcond=1e-9)[i] @ skew(s)
    return sparse.bsr_array((turning, j, blocks.indptr), shape=(3 * count, 3 * count)).tocsr()


def first_elastic(r: Array, K: Sparse, M: Sparse) -> float:
    """An upper bound of the first elastic ω²: Ritz, with displacements of second degree.

    Raises InputError where rigid motions are resisted.
    """
    centred = r - np.mean(r, axis=0)
    rigid = rigid_motions(centred)
    x = centred / np.maximum(np.ptp(r, axis=0), 1e-9 * np.max(np.ptp(r)))
    scale = [x[:, a] * x[:, b] for a in range(3) for b in range(a, 3)]
    monomials = np.stack([np.ones(len(r)), *x.T, *scale], axis=1)
    trial = np.einsum("ki,ab->kaib", monomials, np.eye(3)).reshape(3 * len(r), -1)
    gram, bending = trial.T @ (M @ trial), trial.T @ (K @ trial)
    weight, turn = np.linalg.eigh(gram)
    some = weight > 1e-10 * weight[-1]
    kept = turn[:, some] / np.sqrt(weight[some])
    values = eigh(kept.T @ bending @ kept, eigvals_only=True)
    elastic = float(values[min(6, len(values) - 1)])
    held = np.max(np.sum(rigid * (K @ rigid), axis=0) / np.sum(rigid * (M @ rigid), axis=0))
    if not elastic > 0 or held > FREE * elastic:
        raise InputError(
            f"stiffness resists rigid motions (ω² = {held:.3g} s⁻² against {elastic:.3g} of the first "
            f"elastic mode): the model is held somewhere, or in other units than its nodes; free it, or "
            f"scale the nodes"
        )
    return elastic
