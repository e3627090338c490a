"""The static compliance that a basis lacks at each node: what a force there would bend beside its shapes."""

import numpy as np

from parflex.base.array import Array
from parflex.fe.body.free_body import FreeBody

LARGEST = 1500  # unknowns of a model whose compliance is formed at all nodes in less than a second


def missed_at_nodes(body: FreeBody, vectors: Array, squares: Array) -> Array:
    """(K,), the share of the compliance of the free body under a force at each node, in the mean of the
    directions, that vectors (n, N) with squares ω² (N,) lack; NaN of all nodes where the model is large."""
    nodes, n = len(body.nodes), body.unknowns
    if n > LARGEST:
        return np.full(nodes, np.nan)
    K, M = body.stiffness.toarray(), body.mass.toarray()
    rigid = body.rigid[:, body.can_move]
    moved = M @ rigid
    relieved = np.eye(n) - rigid @ np.linalg.solve(rigid.T @ moved, moved.T)  # K⁺ = P (K + …)⁻¹ Pᵀ
    scale = np.trace(K) / np.trace(moved @ moved.T)
    D = body.displacement.toarray() @ relieved
    flexed = np.linalg.solve(K + scale * (moved @ moved.T), D.T).T
    whole = np.sum(D * flexed, axis=1).reshape(nodes, 3).sum(axis=1)
    shapes = body.displacement @ vectors
    kept = np.sum(shapes**2 / squares, axis=1).reshape(nodes, 3).sum(axis=1)
    found: Array = 1.0 - kept / whole
    return found
