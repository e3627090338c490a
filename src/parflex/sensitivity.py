"""Derivatives of the dynamic models with respect to state and forces, by implicit differentiation.

The contact system is solved for changes as for forces: with r_1, r_2, r_3 the changes of the equations
of platform, legs and closure at fixed accelerations and contact forces, and s = r_3 − J A⁻¹ r_2,

d(V̇_p, q̈_e) = Y s − Q r_1,     Y = M_p⁻¹ W C⁻¹,     Q = M_p⁻¹ − Y Wᵀ M_p⁻¹.

Small motions of the state are those of `tangent.py`.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from parflex.array import (
    Array,
    block,
    cross,
    join,
    merged,
    mtv,
    mv,
    skew,
    solve_definite,
    transpose,
)
from parflex.assembly import System, by_group, joint_accelerations
from parflex.body import FlexibleBody
from parflex.dual import jacobian
from parflex.dynamics import Contact, acceleration_map, accelerations, contact_forces, contact_system
from parflex.robot import Robot
from parflex.state import Coordinates
from parflex.tangent import leg_tangent, platform_tangent

Load = Callable[[Coordinates], Array]  # external generalised force (…, 6 + N)


class Sensitivity(NamedTuple):
    """∂(V̇_p, q̈_e), rows (6 + N)."""

    state: Array  # (…, 6 + N, 12 + 2 N + 2 n)
    forces: Array  # (…, 6 + N, m)
    load: Array  # (…, 6 + N, 6 + N), by a generalised force


def direct_sensitivity(robot: Robot, system: System, u: Array, load: Load) -> Sensitivity:
    """Of the direct model at an assembled state under Γ (…, m) and a load."""
    body, x = robot.platform, system.x
    contact = contact_system(robot, system, load(x))
    f = contact_forces(robot, contact.C, (contact.rhs + mv(contact.JAS, u))[..., None])[..., 0]
    Vd, qdd_e, _ = accelerations(body, system, contact, f)
    MW = np.concatenate(acceleration_map(body, system, contact, np.eye(f.shape[-1])), axis=-2)
    Y = transpose(contact_forces(robot, contact.C, transpose(MW)))
    Q = inverse_inertia(body, contact) - Y @ transpose(MW)
    state = by_state(robot, system, u, f, join([Vd, qdd_e]), Y, Q, load)
    return Sensitivity(state, Y @ contact.JAS, Q)


def by_state(
    robot: Robot, system: System, u: Array, f: Array, a: Array, Y: Array, Q: Array, load: Load
) -> Array:
    """Y s − Q r_1 for every small motion of the state."""
    body, x, (r, v, h) = robot.platform, system.x, system.points
    N, omega = body.modes, x.twist[..., 3:]
    w, shapes = skew(omega), transpose(system.W_e)  # (…, 3, 3), (3k, N)
    Omega = skew(a[..., 3:6]) + w @ w
    gravity = mtv(x.rotation, np.asarray(robot.gravity))
    platform = platform_tangent(body, x, gravity, a)
    tips = f.reshape(f.shape[:-1] + (f.shape[-1] // 3, 3))

    qdd = joint_accelerations(robot, system, u, f)
    by_place: list[Array] = []
    by_velocity: list[Array] = []
    by_force: list[Array] = []
    by_joint: list[tuple[Array, Array]] = []
    first = 0
    for leg, q, push in zip(system.legs, qdd, by_group(robot, tips), strict=True):
        found = leg_tangent(robot, leg, x, q, push)
        count, rows = leg.J.shape[-3:-1]
        mine = Y[..., first : first + count * rows]
        each = np.moveaxis(mine.reshape(mine.shape[:-1] + (count, rows)), -2, -3)  # (…, L, 6 + N, 3t)
        for parts, H in ((by_place, found.place), (by_velocity, found.velocity), (by_force, found.mobility)):
            parts.append(side_by_side(each @ H))
        if leg.group.type.carries:
            by_joint.append((side_by_side(each @ found.joints), side_by_side(each @ found.joint_rates)))
        first += count * rows
    K_p, K_v, K_f = (np.concatenate(parts, axis=-1) for parts in (by_place, by_velocity, by_force))

    def across(K: Array, X: Array) -> Array:
        """K (…, 6 + N, 3k) times X (…, 3, 3) at every tip."""
        parts = K.reshape(K.shape[:-1] + (K.shape[-1] // 3, 3))
        return merged(parts @ X[..., None, :, :])

    def hats(vectors: Array) -> Array:
        """â of every tip's vector (…, k, 3), one below the other (…, 3k, 3)."""
        matrices = skew(vectors)
        return matrices.reshape(matrices.shape[:-3] + (3 * matrices.shape[-3], 3))

    ones = np.tile(np.eye(3), (len(shapes) // 3, 1))
    bending = mv(shapes, x.elastic_rate).reshape(r.shape)
    tip_acceleration = mtv(
        np.concatenate(
            [system.W_p, np.broadcast_to(system.W_e, system.W_p.shape[:-2] + system.W_e.shape)], axis=-2
        ),
        a,
    )
    tip_acceleration = tip_acceleration.reshape(r.shape) + h
    by_omega = hats(cross(omega[..., None, :], r) + 2.0 * bending)
    by_omega = by_omega + (w[..., None, :, :] @ skew(r)).reshape(by_omega.shape)
    pushed = block([[np.zeros((3, N))], [transpose(hats(tips)) @ (-shapes)], [np.zeros((N, N))]])

    external = load_tangent(load, x)
    r_q = platform.elastic + pushed - external[..., 3:]
    r_turn = platform.gravity @ skew(gravity) - external[..., :3]
    columns = [
        (K_p @ ones) @ transpose(x.rotation),
        Y @ hats(tip_acceleration) + K_f @ hats(tips) - K_p @ hats(r) - K_v @ hats(v) - Q @ r_turn,
        K_v @ ones,
        Y @ by_omega - K_v @ hats(r) - Q @ platform.omega,
        (K_p + across(K_v, w) - across(Y, Omega)) @ shapes - Q @ r_q,
        (K_v - 2.0 * across(Y, w)) @ shapes - Q @ platform.elastic_rate,
    ]
    if by_joint:
        q, qd = (
            np.concatenate(parts, axis=-1)[..., robot.carried_order] for parts in zip(*by_joint, strict=True)
        )
        columns += [q, qd]
    batch = np.broadcast_shapes(*(column.shape[:-2] for column in columns))
    return np.concatenate([np.broadcast_to(c, batch + c.shape[-2:]) for c in columns], axis=-1)


def load_tangent(load: Load, x: Coordinates) -> Array:
    """∂load/∂(δθ, q_e) (…, 6 + N, 3 + N)."""

    def moved(seeds: Array) -> Array:
        turned = x.rotation @ (np.eye(3) + skew(seeds[..., :3]))
        return load(x._replace(rotation=turned, elastic=seeds[..., 3:]))

    return jacobian(moved, join([0.0 * x.twist[..., :3], x.elastic]))


def inverse_inertia(body: FlexibleBody, contact: Contact) -> Array:
    """M_p⁻¹ (…, 6 + N, 6 + N)."""
    E = contact.inertia.E
    A_i = solve_definite(contact.inertia.A_s, np.eye(6))
    corner = A_i @ E
    return block([[A_i, -corner], [-transpose(corner), body.m_ee_inverse + transpose(E) @ corner]])


def side_by_side(parts: Array) -> Array:
    """(…, L, r, c) as (…, r, L c)."""
    return merged(np.moveaxis(parts, -3, -2))
