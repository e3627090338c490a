"""Inertia integrals of bodies whose unknowns are the nodal displacements."""

import numpy as np

from parflex.base.array import Array
from parflex.fe.body.free_body import Sparse
from parflex.robot.moments import Moments


def nodal_moments(nodes: Array, mass: Sparse, shapes: Array) -> Moments:
    """With the scalar mass matrix m_ij = ∫ N_i N_j dm (K, K), sparse, and shapes (N, K, 3).

    Exact where r itself lies in the space of the elements: Φ_kᵀ m r and so on.
    """
    N, K = shapes.shape[:2]
    heavy, weight = mass @ nodes, np.asarray(mass @ np.ones(K))
    flat = np.moveaxis(shapes, 0, 1).reshape(K, 3 * N)
    products = (flat.T @ (mass @ flat)).reshape(N, 3, N, 3)
    return Moments(
        m=float(np.sum(weight)),
        MS0=weight @ nodes,
        P0=nodes.T @ heavy,
        S=np.einsum("i,nia->an", weight, shapes),
        P1=np.einsum("nia,ib->nab", shapes, heavy),
        P2=np.einsum("najb->njab", products),
    )


def rigid_momentum(moments: Moments) -> Array:
    """∫ Φ dm and ∫ r × Φ dm of the shapes, (6, N)."""
    P1 = moments.P1
    beta = [P1[:, 2, 1] - P1[:, 1, 2], P1[:, 0, 2] - P1[:, 2, 0], P1[:, 1, 0] - P1[:, 0, 1]]
    return np.concatenate([moments.S, beta])
