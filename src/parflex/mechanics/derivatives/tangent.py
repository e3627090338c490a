"""Derivatives of the equations of platform and legs by the state, at fixed accelerations and forces.

Small motions of the state are (δp 3 in Σ0, δθ 3 in Σp, δv_p 3, δω_p 3, δq_e N, δq̇_e N[, δq, δq̇]), with
the attitude turned by R → R (1 + δθ̂).
"""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, block, cross, join, merged, mtv, mv, skew, stack, transpose
from parflex.base.dual import jacobian
from parflex.base.spatial import axial
from parflex.base.unroll import contract, solve_definite
from parflex.mechanics import chain
from parflex.mechanics.legs.alike import each_leg
from parflex.mechanics.legs.base import LegGroup
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.platform import Platform, contractions
from parflex.mechanics.system import LegTerms
from parflex.robot.layout import Coordinates


class PlatformTangent(NamedTuple):
    """∂(M_p a + c_p) of Eq. 35 at fixed a, rows (linear 3, angular 3, elastic N)."""

    gravity: Array  # (…, 6 + N, 3), by g in Σp
    omega: Array  # (…, 6 + N, 3)
    elastic: Array  # (…, 6 + N, N)
    elastic_rate: Array  # (…, 6 + N, N)


class LegTangent(NamedTuple):
    """∂(J q̈ + J̇q̇) − J A⁻¹ ∂(A q̈ + c + Jᵀ f) of L legs at fixed q̈ and f, resolved in Σp.

    By the places and velocities of the leg's tips, in Σp, or by joints that the state carries.
    """

    place: Array  # (…, L, 3t, 3t)
    velocity: Array  # (…, L, 3t, 3t)
    joints: Array  # (…, L, 3t, n), n = 0 where no joints are carried
    joint_rates: Array  # (…, L, 3t, n)
    mobility: Array  # (…, L, 3t, 3t), J A⁻¹ Jᵀ


def platform_tangent(platform: Platform, x: Coordinates, gravity: Array, a: Array) -> PlatformTangent:
    """All terms are integrals of ρ and Φ_k with the acceleration v̇ − g + Ω ρ + 2 ω × Φ q̇_e + Φ q̈_e.

    The function is long because all of them share the integrals at its head.

    x at one state, gravity (…, 3) in Σp, a (…, 6 + N).
    """
    t, omega, q_e, qd_e = platform.moments, x.twist[..., 3:], x.elastic, x.elastic_rate
    G = contractions(platform, q_e, qd_e).G
    rates, accelerations = contract(qd_e, t.P2), contract(a[..., 6:], t.P2)  # ∫ (Φ q̇) Φ_jᵀ, ∫ (Φ q̈) Φ_jᵀ
    w = skew(omega)
    Omega = skew(a[..., 3:6]) + w @ w
    second = t.P0 + np.sum(q_e[..., None, None] * (transpose(t.P1) + G), axis=-3)
    MS, drift = t.MS0 + mv(t.S, q_e), mv(t.S, qd_e)
    C = np.sum(qd_e[..., None, None] * G, axis=-3)

    free = a[..., :3] - gravity
    each_S = transpose(t.S)  # (N, 3)
    carried = free[..., None, :, None] * each_S[:, None, :]
    carried = (
        carried + Omega[..., None, :, :] @ transpose(G) + 2.0 * (w[..., None, :, :] @ rates) + accelerations
    )
    by_shape = transpose(axial(carried) + axial(Omega[..., None, :, :] @ G))
    modes = platform.modes
    table = transpose(t.P2.reshape(modes * modes, 9))

    def paired(X: Array) -> Array:
        """∫ Φ_kᵀ X Φ_j dm, (…, N, N)."""
        return (merged(X)[..., None, :] @ table).reshape(X.shape[:-2] + (modes, modes))

    columns = []
    for e in np.eye(3):
        turn = skew(e) @ w + w @ skew(e)
        linear = mv(turn, MS) + 2.0 * cross(e, drift)
        angular = axial(turn @ second + 2.0 * (skew(e) @ C))
        elastic = np.sum(turn[..., None, :, :] * G, axis=(-2, -1))
        elastic = elastic + 2.0 * np.sum(skew(e) * transpose(rates), axis=(-2, -1))
        columns.append(join([linear, angular, elastic]))
    return PlatformTangent(
        gravity=block([[-t.m * np.eye(3)], [-skew(MS)], [-each_S]]),
        omega=stack(columns),
        elastic=block([[Omega @ t.S], [by_shape], [paired(Omega) + np.diag(platform.stiffness)]]),
        elastic_rate=block(
            [
                [2.0 * (w @ t.S)],
                [transpose(axial(2.0 * (w[..., None, :, :] @ G)))],
                [paired(2.0 * w) + np.diag(platform.damping)],
            ]
        ),
    )


def leg_tangent(mechanism: Mechanism, leg: LegTerms, x: Coordinates, qdd: Array, f: Array) -> LegTangent:
    """The legs of a group with accelerations q̈ (…, L, n) under contact forces f (…, L, t, 3) in Σp."""
    group, carries = leg.group, leg.group.type.carries
    n, rows = group.chain.n, 3 * len(group.tip_frames)
    force = mv(leg.R_ip, f)
    found = residual_tangent(mechanism, leg, leg_seeds(leg, x), qdd, force)
    R_pi = transpose(leg.R_ip[..., 0, :, :])
    JA = transpose(solve_definite(leg.A, transpose(leg.J)))
    H = blockwise(R_pi, found[..., n:, :]) - JA @ found[..., :n, :]
    mobility = JA @ transpose(leg.J)
    if carries:
        still = np.zeros((rows, rows))
        return LegTangent(still, still, H[..., :n], H[..., n:], mobility)
    H = transpose(blockwise(R_pi, transpose(H)))
    return LegTangent(H[..., :rows], H[..., rows:], H[..., :0], H[..., :0], mobility)


def leg_seeds(leg: LegTerms, x: Coordinates) -> Array:
    """The arguments of the equations of the legs: see `leg_residual`."""
    carried = leg.group.carried
    if leg.group.type.carries:
        return join([x.q[..., carried], x.qd[..., carried]])
    return join([merged(leg.place), merged(leg.velocity)])


def residual_tangent(mechanism: Mechanism, leg: LegTerms, seeds: Array, qdd: Array, force: Array) -> Array:
    """∂ of `leg_residual` by its seeds, (…, L, n + 3t, d); (…, L)."""
    push = (len(leg.group.tip_frames), 3)

    def tangent(group: LegGroup, *given: Array) -> Array:
        seeds, qdd, force, branch, gravity = given
        group, force = group.on(branch), force.reshape(force.shape[:-1] + push)
        local = mtv(group.rotation, gravity)
        return jacobian(lambda x: leg_residual(group, x, qdd, force, local), seeds)

    rows = [seeds, qdd, merged(force), leg.branch]
    found: Array = each_leg(leg.group, tangent, rows, [mechanism.gravity])
    return found


def leg_residual(group: LegGroup, seeds: Array, qdd: Array, force: Array, gravity: Array) -> Array:
    """(A q̈ + c + Jᵀ f, J q̈ + J̇q̇): (…, L, n + 3t) in Σ0i.

    seeds are places and velocities of the tips, or q and q̇; force (…, L, t, 3), gravity (L, 3); all in
    Σ0i.
    """
    c, half = group.chain, seeds.shape[-1] // 2
    first, second = seeds[..., :half], seeds[..., half:]
    place = velocity = np.zeros((1, 3))
    if not group.type.carries:
        by_tip = (*seeds.shape[:-1], len(group.tip_frames), 3)
        place, velocity = first.reshape(by_tip), second.reshape(by_tip)
    joints = group.type.joints(group, place, first)
    frames = chain.frames(c, joints)
    qd = group.type.rates(group, frames, joints, place, velocity, second)
    motions = chain.link_motions(c, frames, qd, qdd, gravity)
    tips, accelerations = chain.unloaded(c), []
    for t, j in enumerate(group.tip_frames):
        offset, (omega, omegad, vd) = group.offsets[:, t], motions[j]
        push = mtv(frames.R_0j[j], force[..., t, :])
        tips.force[j], tips.moment[j] = tips.force[j] + push, tips.moment[j] + cross(offset, push)
        accelerations.append(mv(frames.R_0j[j], vd + chain.point_acceleration(omega, omegad, offset)))
    torque = chain.inverse_dynamics(c, frames, motions, qdd, tips)
    torque = torque + chain.friction(c, qd) + c.k * chain.stretch(c, joints)
    return join([torque, *accelerations])


def blockwise(R: Array, a: Array) -> Array:
    """R (…, 3, 3) times each three rows of a (…, 3 r, c)."""
    parts = a.reshape(a.shape[:-2] + (a.shape[-2] // 3, 3, a.shape[-1]))
    turned = R[..., None, :, :] @ parts
    return turned.reshape(turned.shape[:-3] + a.shape[-2:])
