"""Inertia integrals of bodies whose unknowns are the nodal displacements, and the rigid bodies they make."""

from typing import Any, NamedTuple

import numpy as np

from parflex.base.array import Array, outer
from parflex.base.errors import InputError
from parflex.robot.moments import Moments

Sparse = Any  # scipy.sparse array or matrix


class RigidBody(NamedTuple):
    """Mass kg, centre of mass (3,) m, inertia about it (3, 3) kg m²."""

    mass: float
    com: Array
    inertia: Array


def rigid_body(m: float, MS0: Array, inertia: Array) -> RigidBody:
    """The rigid body of mass m kg, first moment MS0 (3,) kg m, and inertia about the origin (3, 3) kg m².

    Raises InputError for a mass that is not positive.
    """
    if not (np.isfinite(m) and np.all(np.isfinite(inertia)) and m > 0):
        raise InputError(f"mass is {m:.4g} kg; a platform needs a positive mass")
    com = MS0 / m
    return RigidBody(m, com, inertia - m * (com @ com * np.eye(3) - outer(com, com)))


def rigid_part(moments: Moments) -> RigidBody:
    """The rigid body of inertia integrals."""
    P0 = moments.P0
    return rigid_body(float(moments.m), moments.MS0, np.trace(P0) * np.eye(3) - P0)


def rigid_fields(nodes: Array) -> Array:
    """Displacements (6, K, 3) of nodes (K, 3): unit translations along, then rotations about the axes."""
    axes = np.eye(3)[:, None, :]
    return np.concatenate([np.broadcast_to(axes, (3, len(nodes), 3)), np.cross(axes, nodes)])


def by_node(rows: Array) -> Array:
    """Displacements (3K, N), node after node, as fields (N, K, 3)."""
    return np.ascontiguousarray(rows.T.reshape(rows.shape[1], len(rows) // 3, 3))


def nodal_moments(nodes: Array, mass: Sparse, shapes: Array) -> Moments:
    """The integrals with the scalar mass matrix m_ij = ∫ N_i N_j dm (K, K), sparse, and shapes (N, K, 3).

    They are exact where r itself lies in the space of the elements: Φ_kᵀ m r and so on.
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
