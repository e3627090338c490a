"""Derivatives of the dynamic models with respect to state and forces, by implicit differentiation.

The contact system is solved for changes as for forces: with r_1, r_2, r_3 the changes of the equations
of platform, legs and closure at fixed accelerations and contact forces, and s = r_3 − J A⁻¹ r_2,

d(V̇_p, q̈_e) = Y s − Q r_1,     Y = M_p⁻¹ W C⁻¹,     Q = M_p⁻¹ − Y Wᵀ M_p⁻¹.

Small motions of the state are those of `tangent.py`.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, block, block_diagonal, cross, join, merged, mtv, mv, skew, transpose
from parflex.base.dual import jacobian
from parflex.base.unroll import each, factored_solve, solve_definite, solve_least_norm
from parflex.mechanics.contact import Contact, contact_forces, contact_system
from parflex.mechanics.derivatives.tangent import (
    blockwise,
    leg_residual,
    leg_seeds,
    leg_tangent,
    platform_tangent,
)
from parflex.mechanics.dynamics import acceleration_map, accelerations, inverse_of
from parflex.mechanics.kinematics import unstacked
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.output import PlatformOutput
from parflex.mechanics.platform import Platform, platform_terms
from parflex.mechanics.system import System, by_group, diagonal, leg_accelerations
from parflex.robot.layout import Coordinates

Load = Callable[[Coordinates], Array]  # external generalised force (…, 6 + N)


class Sensitivity(NamedTuple):
    """∂(V̇_p, q̈_e), rows (6 + N)."""

    state: Array  # (…, 6 + N, 12 + 2 N + 2 n)
    forces: Array  # (…, 6 + N, m)
    load: Array  # (…, 6 + N, 6 + N), by a generalised force


class Solved(NamedTuple):
    """The direct model's answer at a state, and the maps Y and Q from changes of the equations."""

    a: Array  # (…, 6 + N)
    f: Array  # (…, 3k)
    qdd: list[Array]  # (…, L, n) of each group
    Y: Array  # (…, 6 + N, 3k)
    Q: Array  # (…, 6 + N, 6 + N)
    JAS: Array  # (…, 3k, m)


def solved(system: System, u: Array, load: Array) -> Solved:
    """The direct model under Γ (…, m) and a generalised force (…, 6 + N)."""
    mechanism = system.mechanism
    contact = contact_system(system, load)
    f = contact_forces(mechanism, contact.C, (contact.rhs + mv(contact.JAS, u))[..., None])[..., 0]
    Vd, qdd_e, _ = accelerations(system, contact, f)
    MW = np.concatenate(acceleration_map(system, contact, np.eye(f.shape[-1])), axis=-2)
    Y = contact_response(mechanism, contact.C, MW)
    Q = each(lambda m, y, MW: m - y @ transpose(MW), [inverse_inertia(mechanism.platform, contact), Y], [MW])
    qdd = leg_accelerations(system, u, f)
    return Solved(join([Vd, qdd_e]), f, qdd, Y, Q, contact.JAS)


def direct_sensitivity(system: System, u: Array, load: Load) -> Sensitivity:
    """The derivatives of the direct model at an assembled state under Γ (…, m) and a load."""
    at = solved(system, u, load(system.x))
    by_forces = each(lambda y, JAS: y @ JAS, [at.Y], [at.JAS])
    return Sensitivity(by_state(system, at, load), by_forces, at.Q)


def inverse_sensitivity(
    system: System, target: Array, load: Load, output: PlatformOutput
) -> tuple[Array, Array]:
    """∂Γ by the state (…, m, 12 + 2 N + 2 n) and by the output's target (…, m, m), as many as actuators.

    The output's acceleration is L(x) a + d(x): L da + ∂(L a + d) = dtarget.
    """
    mechanism, x = system.mechanism, system.x
    body, N, motions = mechanism.platform.body, mechanism.platform.modes, mechanism.layout.motions
    nothing = np.zeros(mechanism.n_forces)
    u = inverse_of(system, target, load(x), output, nothing).forces
    at = solved(system, u, load(x))
    moved, driven = by_state(system, at, load), at.Y @ at.JAS

    def prescribed(seeds: Array) -> Array:
        omega, q_e, qd_e = seeds[..., :3], seeds[..., 3 : 3 + N], seeds[..., 3 + N :]
        there = x._replace(twist=join([x.twist[..., :3], omega]), elastic=q_e, elastic_rate=qd_e)
        reached = output.linear(body, there, at.a[..., :6, None], at.a[..., 6:, None])[..., 0]
        return reached + output.drift(body, there)

    own = jacobian(prescribed, join([x.twist[..., 3:], x.elastic, x.elastic_rate]))
    still = np.zeros((output.size, motions.omega.start))
    carried = np.zeros((output.size, moved.shape[-1] - motions.joints.start))
    change = output.linear(body, x, moved[..., :6, :], moved[..., 6:, :]) + block([[still, own, carried]])
    gain = output.linear(body, x, driven[..., :6, :], driven[..., 6:, :])
    columns = block([[-change, np.eye(output.size)]])
    found = transpose(solve_least_norm(gain[..., None, :, :], transpose(columns)))
    return found[..., : change.shape[-1]], found[..., change.shape[-1] :]


def parameter_sensitivity(
    mechanism_at: Callable[[Array], Mechanism], theta: Array, system: System, u: Array, load: Load
) -> Array:
    """∂(V̇_p, q̈_e)/∂θ (…, 6 + N, P) of the mechanism that has θ (P,) in its tables, at its assembled state."""
    at = solved(system, u, load(system.x))
    legs = sum(leg.A.shape[-3] * leg.A.shape[-1] for leg in system.legs)

    def equations(theta: Array) -> Array:
        return residuals(system._replace(mechanism=mechanism_at(theta)), at)

    found = jacobian(equations, theta)
    r_2, r_1 = found[..., :legs, :], found[..., legs:, :]
    parts, first = [], 0
    for leg in system.legs:
        count, n = leg.A.shape[-3], leg.A.shape[-1]
        mine = r_2[..., first : first + count * n, :]
        each = mine.reshape((*mine.shape[:-2], count, n, mine.shape[-1]))
        JA = transpose(solve_definite(leg.A, transpose(leg.J)))
        parts.append(-(JA @ each))
        first += count * n
    rows = [
        part.reshape((*part.shape[:-3], part.shape[-3] * part.shape[-2], part.shape[-1])) for part in parts
    ]
    s = block([[np.zeros((0, len(theta)))], *([part] for part in rows)])
    return at.Y @ s - at.Q @ r_1


def residuals(system: System, at: Solved) -> Array:
    """A q̈ + c + Jᵀ f of all legs and M_p a + c_p, one after the other, for one state."""
    x, mechanism, parts = system.x, system.mechanism, []
    platform, tips = mechanism.platform, by_group(mechanism, unstacked(at.f))
    for group, leg, qdd, f in zip(mechanism.groups, system.legs, at.qdd, tips, strict=True):
        gravity = mtv(group.rotation, mechanism.gravity)
        rest = leg_residual(group.on(leg.branch), leg_seeds(leg, x), qdd, mv(leg.R_ip, f), gravity)
        parts.append(merged(rest[..., : group.chain.size]))
    gravity = mtv(x.rotation, mechanism.gravity)
    A_rr, A_re, c_r, c_e = platform_terms(platform, x.twist[..., 3:], x.elastic, x.elastic_rate, gravity)
    Vd, qdd_e = at.a[..., :6], at.a[..., 6:]
    rigid = mv(A_rr, Vd) + mv(A_re, qdd_e) + c_r
    elastic = mtv(A_re, Vd) + mv(platform.m_ee, qdd_e) + c_e
    return join([*parts, rigid, elastic])


def by_state(system: System, at: Solved, load: Load, driven: Array | float = 0.0) -> Array:
    """Y s − Q r_1 for every small motion of the state; `driven` is J A⁻¹ S ∂Γ where forces change with it."""
    mechanism, x, tips = system.mechanism, system.x, unstacked(at.f)
    gravity = mtv(x.rotation, mechanism.gravity)
    platform = platform_tangent(mechanism.platform, x, gravity, at.a)
    N, carried = mechanism.platform.modes, mechanism.layout.carried
    external = load_tangent(load, x)
    turning = platform.gravity @ skew(gravity) - external[..., :3]
    levers = -transpose(hats(tips)) @ transpose(system.W_e)
    pushed = block([[np.zeros((3, N))], [levers], [np.zeros((N, N))]])
    bending = platform.elastic + pushed - external[..., 3:]
    still, none = np.zeros((6 + N, 3)), np.zeros((6 + N, 2 * carried))
    r_1 = block([[still, turning, still, platform.omega, bending, platform.elastic_rate, none]])
    s = closure_changes(system, at.qdd, tips, at.a) + driven

    def changed(s: Array, r: Array, Y: Array, Q: Array) -> Array:
        return s @ transpose(Y) - r @ transpose(Q)

    return transpose(each(changed, [transpose(s), transpose(r_1)], [at.Y, at.Q]))


def closure_changes(system: System, qdd: list[Array], f: Array, a: Array) -> Array:
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
        system.legs, qdd, *(by_group(system.mechanism, values) for values in vectors), strict=True
    ):
        found = leg_tangent(system.mechanism, leg, x, q, f_i)
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
        joints.append((block_diagonal(found.kept), block_diagonal(found.kept_rates)))
    by_joint = [diagonal([part[i] for part in joints])[..., system.mechanism.carried_order] for i in (0, 1)]
    every = block([[np.zeros((0, 12 + 2 * shapes.shape[-1]))], *([part] for part in rows)])
    return block([[every, *by_joint]])


def hats(vectors: Array) -> Array:
    """â of vectors (…, k, 3), one below the other (…, 3k, 3)."""
    matrices = skew(vectors)
    return matrices.reshape((*vectors.shape[:-2], 3 * vectors.shape[-2], 3))


def contact_response(mechanism: Mechanism, C: Array, MW: Array) -> Array:
    """Y = M_p⁻¹ W C⁻¹ (…, 6 + N, 3k), zero for rows that depend on others."""
    kept, dropped, order = mechanism.solved_rows
    if len(kept) == C.shape[-1]:
        return transpose(contact_forces(mechanism, C, transpose(MW)))
    Y = transpose(solve_definite(C[..., kept, :][..., kept], transpose(MW[..., kept])))
    every = np.concatenate([Y, 0.0 * MW[..., dropped]], axis=-1)
    return every[..., order]


def load_tangent(load: Load, x: Coordinates) -> Array:
    """∂load/∂(δθ, q_e) (…, 6 + N, 3 + N)."""

    def moved(seeds: Array) -> Array:
        turned = x.rotation @ (np.eye(3) + skew(seeds[..., :3]))
        return load(x._replace(rotation=turned, elastic=seeds[..., 3:]))

    return jacobian(moved, join([0.0 * x.twist[..., :3], x.elastic]))


def inverse_inertia(platform: Platform, contact: Contact) -> Array:
    """M_p⁻¹ (…, 6 + N, 6 + N)."""
    E = contact.inertia.E
    A_i = factored_solve(contact.inertia.A_s, np.eye(6))
    corner = A_i @ E
    return block([[A_i, -corner], [-transpose(corner), platform.m_ee_inverse + transpose(E) @ corner]])
