"""Foreshortening, by which an interface of a bent link comes nearer: H, from the geometric stiffness of the
link's own elements.

A unit tension along t, from the frame to the interface, makes stresses σ in the body; with them

t · H = −Φᵀ K_g Φ,   (K_g)_kl = ∫ σ_ij ∂_i u_k · ∂_j u_l dV   (Bathe 1996, sec. 6.3)
"""

import numpy as np
from scipy import sparse

from parflex.base.array import Array
from parflex.fe.body.elements import TET10, gradients, sum_of_elements
from parflex.fe.body.integrals import Sparse, by_node
from parflex.fe.body.solid import Solid

DEGREE = 4  # of the quadrature: stresses and both gradients are linear in a straight element
BATCH = 2000  # elements at once


def geometric_stiffness(nodes: Array, solid: Solid, pulled: Array) -> Sparse:
    """k (K, K) of K_g = k ⊗ 1 for the stresses that displacements (K, 3) of the nodes (K, 3) cause."""
    lam, mu = solid.by_element(np.array([material.lame for material in solid.materials])).T
    _, slopes, weights = TET10.tabulated(DEGREE)
    total = sparse.csr_array((len(nodes), len(nodes)))
    for first in range(0, len(solid.elements), BATCH):
        some = slice(first, first + BATCH)
        cells = solid.elements[some]
        G, volume = gradients(nodes[cells], slopes)
        slope = np.einsum("eqia,eib->eqab", G, pulled[cells], optimize=True)
        strain = 0.5 * (slope + np.swapaxes(slope, -1, -2))
        pressure = lam[some, None] * np.trace(strain, axis1=-2, axis2=-1)
        stress = pressure[..., None, None] * np.eye(3) + 2.0 * mu[some, None, None, None] * strain
        blocks = np.einsum("eq,eqia,eqab,eqjb->eij", volume * weights, G, stress, G, optimize=True)
        total = total + sum_of_elements(cells, blocks, len(nodes))
    return total


def shortening(nodes: Array, solid: Solid, pulled: Array, t: Array, vectors: Array) -> Array:
    """H (3, N, N) of an interface, of modes (3K, N) and of the displacements (3K,) under a unit tension along
    t (3,)."""
    k = geometric_stiffness(nodes, solid, pulled.reshape(-1, 3))
    fields = by_node(vectors)
    count = len(fields)
    flat = np.moveaxis(fields, 0, 1).reshape(len(nodes), 3 * count)
    drawn = np.einsum("ajbj->ab", (flat.T @ (k @ flat)).reshape(count, 3, count, 3))
    return -t[:, None, None] * (0.5 * (drawn + drawn.T))
