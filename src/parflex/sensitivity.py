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
    block_diagonal,
    cross,
    factored,
    factored_solve,
    for_each,
    join,
    merged,
    mtv,
    mv,
    skew,
    solve_definite,
    transpose,
)
from parflex.assembly import System, by_group, diagonal, joint_accelerations
from parflex.body import FlexibleBody
from parflex.dual import jacobian
from parflex.dynamics import Contact, acceleration_map, accelerations, contact_forces, contact_system
from parflex.robot import Robot
from parflex.state import Coordinates
from parflex.tangent import blockwise, leg_tangent, platform_tangent

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
    Y = contact_response(robot, contact.C, MW)
    Q = for_each(lambda m, y, MW: m - y @ transpose(MW), [inverse_inertia(body, contact), Y], [MW])
    state = by_state(robot, system, u, f, join([Vd, qdd_e]), Y, Q, load)
    by_forces = for_each(lambda y, JAS: y @ JAS, [Y], [contact.JAS])
    return Sensitivity(state, by_forces, Q)


def by_state(
    robot: Robot, system: System, u: Array, f: Array, a: Array, Y: Array, Q: Array, load: Load
) -> Array:
    """Y s − Q r_1 for every small motion of the state."""
    body, x = robot.platform, system.x
    gravity = mtv(x.rotation, np.asarray(robot.gravity))
    platform = platform_tangent(body, x, gravity, a)
    tips = f.reshape(f.shape[:-1] + (f.shape[-1] // 3, 3))
    N, carried = body.modes, robot.layout.carried
    external = load_tangent(load, x)
    turning = platform.gravity @ skew(gravity) - external[..., :3]
    levers = -transpose(hats(tips)) @ transpose(system.W_e)
    pushed = block([[np.zeros((3, N))], [levers], [np.zeros((N, N))]])
    bending = platform.elastic + pushed - external[..., 3:]
    still, none = np.zeros((6 + N, 3)), np.zeros((6 + N, 2 * carried))
    r_1 = block([[still, turning, still, platform.omega, bending, platform.elastic_rate, none]])
    s = closure_changes(robot, system, joint_accelerations(robot, system, u, f), tips, a)

    def solved(s: Array, r: Array, Y: Array, Q: Array) -> Array:
        return s @ transpose(Y) - r @ transpose(Q)

    return transpose(for_each(solved, [transpose(s), transpose(r_1)], [Y, Q]))


def closure_changes(robot: Robot, system: System, qdd: list[Array], f: Array, a: Array) -> Array:
    """s = r_3 − J A⁻¹ r_2 (…, 3k, 12 + 2 N + 2 n) under contact forces f (…, k, 3)."""
    x, (r, v, h) = system.x, system.points
    w, spin = skew(x.twist[..., 3:]), x.twist[..., None, 3:]
    Omega = skew(a[..., 3:6]) + w @ w
    shapes = transpose(system.W_e)
    moved = mtv(system.W_p, a[..., :6]) + mv(shapes, a[..., 6:])
    moved = moved.reshape(r.shape) + h
    bending = mv(shapes, x.elastic_rate).reshape(r.shape)
    by_omega = skew(cross(spin, r) + 2.0 * bending) + w[..., None, :, :] @ skew(r)
    vectors = (r, v, moved, f, merged(by_omega), shapes.reshape(len(shapes) // 3, 3 * shapes.shape[-1]))
    rows, joints = [], []
    for leg, q, r_i, v_i, a_i, f_i, turned, Phi in zip(
        system.legs, qdd, *(by_group(robot, values) for values in vectors), strict=True
    ):
        found = leg_tangent(robot, leg, x, q, f_i)
        H_p, H_v, count = found.place, found.velocity, 3 * r_i.shape[-2]
        one, Phi = np.tile(np.eye(3), (count // 3, 1)), Phi.reshape((len(Phi), count, shapes.shape[-1]))
        columns = [
            H_p @ one @ transpose(x.rotation)[..., None, :, :],
            hats(a_i) + found.mobility @ hats(f_i) - H_p @ hats(r_i) - H_v @ hats(v_i),
            H_v @ one,
            turned.reshape((*turned.shape[:-2], count, 3)) - H_v @ hats(r_i),
            H_p @ Phi + H_v @ blockwise(w[..., None, :, :], Phi) - blockwise(Omega[..., None, :, :], Phi),
            H_v @ Phi - blockwise(2.0 * w[..., None, :, :], Phi),
        ]
        batch = np.broadcast_shapes(*(c.shape[:-2] for c in columns), leg.J.shape[:-2])
        wide = np.concatenate([np.broadcast_to(c, batch + c.shape[-2:]) for c in columns], axis=-1)
        rows.append(wide.reshape((*wide.shape[:-3], len(Phi) * count, wide.shape[-1])))
        joints.append((block_diagonal(found.joints), block_diagonal(found.joint_rates)))
    by_joint = [diagonal([part[i] for part in joints])[..., robot.carried_order] for i in (0, 1)]
    return block([[np.concatenate(rows, axis=-2), *by_joint]])


def hats(vectors: Array) -> Array:
    """â of vectors (…, k, 3), one below the other (…, 3k, 3)."""
    matrices = skew(vectors)
    return matrices.reshape((*vectors.shape[:-2], 3 * vectors.shape[-2], 3))


def contact_response(robot: Robot, C: Array, MW: Array) -> Array:
    """Y = M_p⁻¹ W C⁻¹ (…, 6 + N, 3k), zero for rows that depend on others."""
    kept = robot.rows.kept
    if len(kept) == C.shape[-1]:
        return for_each(lambda b, F: transpose(factored_solve(F, transpose(b))), [MW], [factored(C)])
    Y = transpose(solve_definite(C[..., kept, :][..., kept], transpose(MW[..., kept])))
    every = np.concatenate([Y, 0.0 * MW[..., robot.rows.dropped]], axis=-1)
    return every[..., robot.rows.order]


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
