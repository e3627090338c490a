"""Platform kinematics and statics (Secs. 4.2–4.3): attachment points, W, h, J_p⁻¹, J_e⁻¹."""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, block, cross, join, merged, mtv, mv, skew, transpose
from parflex.robot.body import FlexibleBody
from parflex.robot.layout import Coordinates


class PointMotion(NamedTuple):
    """Points of the deformed platform, in Σp: place, velocity, and acceleration at V̇_p = q̈_e = 0."""

    r: Array  # (…, k, 3)
    v: Array  # (…, k, 3)
    h: Array  # (…, k, 3)


def point_motion(points: Array, shapes: Array, x: Coordinates) -> PointMotion:
    """Motion of body points (k, 3) with displacement shapes Φ_d (k, 3, N)."""
    v_p, omega = x.twist[..., None, :3], x.twist[..., None, 3:]  # Eq. 17
    Phi_d = shapes  # Eq. 15
    r = points + mv(Phi_d, x.elastic[..., None, :])  # Eq. 12
    bending = mv(Phi_d, x.elastic_rate[..., None, :])
    r_dot = cross(omega, r) + bending  # Eq. 13
    v = v_p + r_dot  # Eq. 18
    h = cross(omega, cross(omega, r)) + 2.0 * cross(omega, bending)  # Eq. 24
    return PointMotion(r, v, h)


def position_in_world(r: Array, x: Coordinates) -> Array:
    """p_i = p_p + r_i, (…, k, 3) m."""
    return x.position[..., None, :] + mv(x.rotation[..., None, :, :], r)  # Eq. 11


def point_acceleration(W: Array, h: Array, Vd: Array, qdd_e: Array) -> Array:
    """v̇ (…, 3k) of the points, resolved in Σp; W from `wrench_map`, h (…, 3k)."""
    return mtv(W, join([Vd, qdd_e])) + h  # Eqs. 22, 23, 38


def wrench_map(r: Array, shapes: Array) -> tuple[Array, Array]:
    """W_p (…, 6, 3k) and W_e (N, 3k): forces at points to the platform's generalised forces.

    Its transpose takes (V_p, q̇_e) to the velocities of the points.
    """
    k, modes = len(shapes), shapes.shape[-1]
    W_p = np.moveaxis(tip_map(r), -3, -2).reshape(r.shape[:-2] + (6, 3 * k))  # Eqs. 26, 30, 31, 32
    W_e = transpose(shapes.reshape(3 * k, modes))  # Eqs. 27, 30, 31, 32
    return W_p, W_e


def tip_map(r: Array) -> Array:
    """(…, k, 6, 3): forces at points to the platform's force and moment."""
    return block([[np.eye(3)], [skew(r)]])  # Eq. 27


def stacked(vectors: Array) -> Array:
    """(…, k, 3) as (…, 3k)."""
    return merged(vectors)  # Eq. 25


def unstacked(vectors: Array) -> Array:
    """(…, 3k) as (…, k, 3)."""
    return vectors.reshape(vectors.shape[:-1] + (vectors.shape[-1] // 3, 3))


def generalised_force(W_p: Array, W_e: Array, forces: Array) -> tuple[Array, Array]:
    """F_p = (f_p, n_p) and Q_p of the stacked contact forces (…, 3k)."""
    return mv(W_p, forces), mv(W_e, forces)  # Eqs. 27, 28, 29


def actuator_jacobian(W_p: Array, W_e: Array, axes: Array) -> tuple[Array, Array]:
    """J_p⁻ᵀ (…, 6, m) and J_e⁻ᵀ (…, N, m); a column of `axes` (…, 3k, m) is ∂q_a/∂(p_1 … p_k).

    q̇_a = J_p⁻¹ V_p + J_e⁻¹ q̇_e; both are formed directly, no matrix is inverted.
    """
    return W_p @ axes, W_e @ axes  # Eqs. 19, 20, 21, 33


def node_wrench_map(
    body: FlexibleBody, node: int, q_e: Array, offset: tuple[float, ...] = (0.0, 0.0, 0.0)
) -> Array:
    """W_a (…, 6 + N, 6): a wrench (F, N), in Σp, to the platform's generalised forces.

    It acts on a node, or on a point fixed to the node at an offset (3,) m.
    """
    Phi_d, Phi_r = body.shapes_at(node, offset)  # Eq. 16
    r = body.nodes[node] + np.asarray(offset) + mv(Phi_d, q_e)
    one, zero = np.eye(3), np.zeros((3, 3))
    return block([[one, zero], [skew(r), one], [Phi_d.T, Phi_r.T]])


def node_twist(body: FlexibleBody, node: int, x: Coordinates) -> Array:
    """V_t (…, 6): total twist of a node, rigid motion and deformation together, in Σp."""
    W_a = node_wrench_map(body, node, x.elastic)
    return mtv(W_a, join([x.twist, x.elastic_rate]))  # Eq. 14
