"""Derivatives of the equations of platform and legs by the state, at fixed accelerations and forces.

Small motions of the state are (δp 3 in Σ0, δθ 3 in Σp, δv_p 3, δω_p 3, δq_e N, δq̇_e N[, δs, δṡ]), with
the attitude turned by R → R (1 + δθ̂).
"""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, block, cross, join, merged, mtv, mv, skew, split, stack, transpose
from parflex.base.dual import jacobian
from parflex.base.spatial import axial
from parflex.base.unroll import contract, solve_definite
from parflex.mechanics import chain, recursion
from parflex.mechanics.leg_terms import LegTerms, rates_of
from parflex.mechanics.legs.alike import each_leg
from parflex.mechanics.legs.base import LegGroup
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.platform import Platform, deformed
from parflex.robot.layout import Coordinates


class PlatformTangent(NamedTuple):
    """∂(M_p a + c_p) of Eq. 35 at fixed a, rows (linear 3, angular 3, elastic N)."""

    gravity: Array  # (…, 6 + N, 3), by g in Σp
    omega: Array  # (…, 6 + N, 3)
    elastic: Array  # (…, 6 + N, N)
    elastic_rate: Array  # (…, 6 + N, N)


class LegTangent(NamedTuple):
    """∂(J z̈ + J̇ż) − J A⁻¹ ∂(A z̈ + c + Jᵀ f) of L legs at fixed z̈ and f, resolved in Σp.

    By the places and velocities of the leg's tips, in Σp, and by coordinates that the state carries.
    """

    place: Array  # (…, L, 3t, 3t), zero where joints are carried
    velocity: Array  # (…, L, 3t, 3t)
    kept: Array  # (…, L, 3t, s)
    kept_rates: Array  # (…, L, 3t, s)
    mobility: Array  # (…, L, 3t, 3t), J A⁻¹ Jᵀ


def platform_tangent(platform: Platform, x: Coordinates, gravity: Array, a: Array) -> PlatformTangent:
    """All terms are integrals of ρ and Φ_k with the acceleration v̇ − g + Ω ρ + 2 ω × Φ q̇_e + Φ q̈_e.

    The function is long because all of them share the integrals at its head.

    x at one state, gravity (…, 3) in Σp, a (…, 6 + N).
    """
    t, omega, q_e, qd_e = platform.moments, x.twist[..., 3:], x.elastic, x.elastic_rate
    G = deformed(t, q_e).G
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


def leg_tangent(mechanism: Mechanism, leg: LegTerms, x: Coordinates, zdd: Array, f: Array) -> LegTangent:
    """The legs of a group with accelerations z̈ (…, L, z) under contact forces f (…, L, t, 3) in Σp."""
    group = leg.group
    z, rows, s = group.chain.size, 3 * len(group.tip_frames), len(group.kept)
    force = mv(leg.R_ip, f)
    found = residual_tangent(mechanism, leg, leg_seeds(leg, x), zdd, force)
    R_pi = transpose(leg.R_ip[..., 0, :, :])
    JA = transpose(solve_definite(leg.A, transpose(leg.J)))
    H = blockwise(R_pi, found[..., z:, :]) - JA @ found[..., :z, :]
    mobility = JA @ transpose(leg.J)
    own = H[..., H.shape[-1] - 2 * s :]
    if group.type.carries:
        still = np.zeros((rows, rows))
        return LegTangent(still, still, own[..., :s], own[..., s:], mobility)
    H = transpose(blockwise(R_pi, transpose(H[..., : 2 * rows])))
    return LegTangent(H[..., :rows], H[..., rows:], own[..., :s], own[..., s:], mobility)


def leg_seeds(leg: LegTerms, x: Coordinates) -> Array:
    """The arguments of the equations of the legs: see `leg_residual`."""
    carried = leg.group.carried
    own = [x.s[..., carried], x.sd[..., carried]]
    if leg.group.type.carries:
        return join(own)
    return join([merged(leg.place), merged(leg.velocity), *own])


def residual_tangent(mechanism: Mechanism, leg: LegTerms, seeds: Array, zdd: Array, force: Array) -> Array:
    """∂ of `leg_residual` by its seeds, (…, L, z + 3t, d); (…, L)."""
    push = (len(leg.group.tip_frames), 3)

    def tangent(group: LegGroup, *given: Array) -> Array:
        seeds, zdd, force, branch, gravity = given
        group, force = group.on(branch), force.reshape(force.shape[:-1] + push)
        local = mtv(group.rotation, gravity)
        return jacobian(lambda x: leg_residual(group, x, zdd, force, local), seeds)

    rows = [seeds, zdd, merged(force), leg.branch]
    found: Array = each_leg(leg.group, tangent, rows, [mechanism.gravity])
    return found


class Seeds(NamedTuple):
    """The arguments of the equations of the legs: the carried coordinates with their rates, and the places
    and velocities (…, L, t, 3) of the tips in Σ0i, which legs that carry their joints do not read."""

    place: Array
    velocity: Array
    s: Array
    sd: Array


def seeds_of(group: LegGroup, flat: Array) -> Seeds:
    """The parts of seeds (…, L, d) that stand side by side."""
    t, s = len(group.tip_frames), len(group.kept)
    if group.type.carries:
        still = np.zeros((t, 3))
        return Seeds(still, still, flat[..., :s], flat[..., s:])
    return Seeds(*split(flat, [(t, 3), (t, 3), (s,), (s,)]))


def leg_residual(group: LegGroup, seeds: Array, zdd: Array, force: Array, gravity: Array) -> Array:
    """(A z̈ + c + Jᵀ f, J z̈ + J̇ż): (…, L, z + 3t) in Σ0i.

    seeds as in `Seeds`, side by side; force (…, L, t, 3), gravity (L, 3); all in Σ0i.
    """
    c, at = group.chain, seeds_of(group, seeds)
    joints = group.type.joints(group, at.place, at.s)
    frames, tips = chain.frames(c, joints), group.points(joints.bend)
    J = [chain.tip_jacobian(c, frames, tip) for tip in tips] if any(c.modes) else []
    zd = rates_of(group, frames, joints, J, at.place, at.velocity, at.sd)
    motions = recursion.link_motions(c, frames, zd, zdd, gravity)
    loads, accelerations = recursion.unloaded(c), []
    for t, tip in enumerate(tips):
        R = frames.R_0j[tip.link]
        recursion.with_push(loads, tip, mtv(R, force[..., t, :]))
        accelerations.append(mv(R, recursion.tip_acceleration(c, motions, tip, zd, zdd)))
    torque = recursion.inverse_dynamics(c, frames, motions, zd, zdd, loads)
    return join([torque + recursion.passive(c, joints, zd), *accelerations])


def blockwise(R: Array, a: Array) -> Array:
    """R (…, 3, 3) times each three rows of a (…, 3 r, c)."""
    parts = a.reshape(a.shape[:-2] + (a.shape[-2] // 3, 3, a.shape[-1]))
    turned = R[..., None, :, :] @ parts
    return turned.reshape(turned.shape[:-3] + a.shape[-2:])
