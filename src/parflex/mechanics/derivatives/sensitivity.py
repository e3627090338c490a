"""Derivatives of the dynamic models with respect to state and forces, by implicit differentiation.

The contact system is solved for changes as for forces: with r_1, r_2, r_3 the changes of the equations
of platform, legs and closure at fixed accelerations and contact forces, and s = r_3 − J A⁻¹ r_2,

d(V̇_p, q̈_e, s̈) = Y s − Q r_1 − (0, 0, A⁻¹ r_2),     Y = M⁻¹ W C⁻¹,     Q = M_p⁻¹ − Y Wᵀ M_p⁻¹,

where s̈ are the accelerations of what the state carries of the legs, and M⁻¹ W those of platform, modes and s
under contact forces. Small motions of the state are those of `Layout.motions`.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, block, block_diagonal, join, merged, mtv, mv, transpose
from parflex.base.dual import jacobian
from parflex.base.unroll import each, factored_solve, solve_definite, solve_least_norm
from parflex.mechanics.contact import Contact, contact_forces, contact_system
from parflex.mechanics.derivatives.changes import Load, leg_changes, platform_changes
from parflex.mechanics.derivatives.leg_tangent import axes_of, leg_residual, leg_seeds, sections_of, seen
from parflex.mechanics.dynamics import acceleration_map, accelerations, inverse_of
from parflex.mechanics.floor import BASE_CHANGES, Seen, ground, seen_from, shifted, under_legs
from parflex.mechanics.kinematics import position_in_world, unstacked
from parflex.mechanics.leg_terms import LegTerms
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.output import PlatformOutput
from parflex.mechanics.platform import Platform, platform_terms
from parflex.mechanics.system import System, by_group, diagonal, leg_accelerations, tip_forces
from parflex.robot.carrying import Base


class Sensitivity(NamedTuple):
    """∂(V̇_p, q̈_e, s̈), rows (6 + N + n)."""

    state: Array  # (…, 6 + N + n, 12 + 2 N + 2 n)
    forces: Array  # (…, 6 + N + n, m)
    load: Array  # (…, 6 + N + n, 6 + N), by a generalised force
    base: Array  # (…, 6 + N + n, 18), by the base's motion; without a base no columns


class Solved(NamedTuple):
    """The direct model's answer at a state, and the maps Y and Q from changes of the equations."""

    a: Array  # (…, 6 + N)
    f: Array  # (…, 3k)
    qdd: list[Array]  # (…, L, z) of each group
    mobile: list[Array]  # `seen` of each group
    Y: Array  # (…, 6 + N + n, 3k)
    Q: Array  # (…, 6 + N + n, 6 + N)
    JAS: Array  # (…, 3k, m)
    AS: Array  # (…, n, m), A⁻¹ S of coordinates that the state carries


def solved(system: System, u: Array, load: Array) -> Solved:
    """The direct model under Γ (…, m) and a generalised force (…, 6 + N)."""
    mechanism = system.mechanism
    contact = contact_system(system, load)
    f = contact_forces(mechanism, contact.C, (contact.rhs + mv(contact.JAS, u))[..., None])[..., 0]
    Vd, qdd_e, _ = accelerations(system, contact, f)
    mobile = [seen(leg) for leg in system.legs]
    pulled, AS = carried_responses(system, mobile)
    MW = np.concatenate(acceleration_map(system, contact, np.eye(f.shape[-1])), axis=-2)
    Y = contact_response(mechanism, contact.C, block([[MW], [-pulled]]))
    M_p = block(
        [[inverse_inertia(mechanism.platform, contact)], [np.zeros((len(mechanism.kept), MW.shape[-2]))]]
    )
    Q = each(lambda m, y, MW: m - y @ transpose(MW), [M_p, Y], [MW])
    qdd = leg_accelerations(system, u, f)
    return Solved(join([Vd, qdd_e]), f, qdd, mobile, Y, Q, contact.JAS, AS)


def carried_responses(system: System, mobile: list[Array]) -> tuple[Array, Array]:
    """A⁻¹ Jᵀ (…, n, 3k) and A⁻¹ S (…, n, m) of the coordinates that the state carries."""
    mechanism, pulled, driven = system.mechanism, [], []
    for leg, both in zip(system.legs, mobile, strict=True):
        own = both[..., leg.J.shape[-2] :, :]
        pulled.append(block_diagonal(own @ transpose(leg.J)))
        driven.append(block_diagonal(own @ leg.group.S))
    order = mechanism.carried_order
    return diagonal(pulled)[..., order, :], diagonal(driven)[..., order, :][..., mechanism.force_order]


def direct_sensitivity(system: System, u: Array, load: Load) -> Sensitivity:
    """The derivatives of the direct model at an assembled state under Γ (…, m) and a load."""
    at = solved(system, u, load(system.x))
    by_forces = each(lambda y, JAS: y @ JAS, [at.Y], [at.JAS]) + own_rows(system, at.AS)
    return Sensitivity(by_state(system, at, load), by_forces, at.Q, base_sensitivity(system, at))


def own_rows(system: System, rows: Array) -> Array:
    """Rows (…, n, c) of carried coordinates below zeros for platform and modes."""
    return block([[np.zeros((6 + system.mechanism.platform.modes, rows.shape[-1]))], [rows]])


def inverse_sensitivity(
    system: System, target: Array, load: Load, output: PlatformOutput
) -> tuple[Array, Array, Array]:
    """∂Γ by the state (…, m, 12 + 2 N + 2 n), by the output's target (…, m, m), as many as actuators, and by
    the base's motion (…, m, 18), without a base no columns.

    The output's acceleration is L(x) a + d(x): L da + ∂(L a + d) = dtarget.
    """
    mechanism, x = system.mechanism, system.x
    body, N, motions = mechanism.platform.body, mechanism.platform.modes, mechanism.layout.motions
    nothing = np.zeros(mechanism.n_forces)
    u = inverse_of(system, target, load(x), output, nothing).forces
    at = solved(system, u, load(x))
    moved, driven = by_state(system, at, load)[..., : 6 + N, :], at.Y[..., : 6 + N, :] @ at.JAS

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
    shaken = base_sensitivity(system, at)[..., : 6 + N, :]
    by_base = output.linear(body, x, shaken[..., :6, :], shaken[..., 6:, :])
    columns = block([[-change, np.eye(output.size), -by_base]])
    found = transpose(solve_least_norm(gain[..., None, :, :], transpose(columns)))
    first, last = change.shape[-1], change.shape[-1] + output.size
    return found[..., :first], found[..., first:last], found[..., last:]


def parameter_sensitivity(
    mechanism_at: Callable[[Array], Mechanism], theta: Array, system: System, u: Array, load: Load
) -> Array:
    """∂(V̇_p, q̈_e, s̈)/∂θ (…, 6 + N + n, P) of the mechanism that has θ (P,) in its tables, at its assembled
    state."""
    at = solved(system, u, load(system.x))
    return system_sensitivity(lambda theta: system._replace(mechanism=mechanism_at(theta)), theta, system, at)


def base_sensitivity(system: System, at: Solved) -> Array:
    """∂(V̇_p, q̈_e, s̈) (…, 6 + N + n, 18) by small changes of the base's motion, as of `floor.shifted`; no
    columns without a base."""
    base = system.mechanism.base
    if base is None:
        return np.zeros((*at.a.shape[:-1], at.Y.shape[-2], 0))
    unmoved = np.broadcast_to(0.0 * at.a[..., :1], (*at.a.shape[:-1], BASE_CHANGES))

    def moved(seeds: Array) -> System:
        s, sd = (part + (seeds[..., :1] - seeds[..., :1]) for part in (system.x.s, system.x.sd))  # like seeds
        return on_floor(system._replace(x=system.x._replace(s=s, sd=sd)), shifted(base, seeds))

    return system_sensitivity(moved, unmoved, system, at)


def on_floor(system: System, base: Base) -> System:
    """The system as another base sees it, as far as `residuals` reads it."""
    x, points, mechanism = system.x, system.points, replace(system.mechanism, base=base)
    place = position_in_world(points.r, x)
    seen = seen_from(base, Seen(x.rotation, place, points.v, system.sections.spin))
    moved = zip(system.legs, *(by_group(mechanism, part) for part in seen[1:3]), strict=True)
    legs = [placed_again(leg, seen.rotation, place, v) for leg, place, v in moved]
    return system._replace(mechanism=mechanism, legs=legs, seen=seen)


def placed_again(leg: LegTerms, rotation: Array, place: Array, v: Array) -> LegTerms:
    """A leg whose tips (…, L, t, 3) are elsewhere in Σ0, of velocities in Σp; the platform turned there."""
    R_i0 = transpose(leg.group.rotation)[:, None]
    R_ip = R_i0 @ rotation[..., None, None, :, :]
    return leg._replace(R_ip=R_ip, place=mv(R_i0, place - leg.group.origin[:, None]), velocity=mv(R_ip, v))


def system_sensitivity(
    system_at: Callable[[Array], System], theta: Array, system: System, at: Solved
) -> Array:
    """∂(V̇_p, q̈_e, s̈)/∂θ (…, 6 + N + n, P) of a system that changes with θ (…, P)."""
    P = theta.shape[-1]
    found = jacobian(lambda theta: residuals(system_at(theta), at), theta)
    first, closure, carried = 0, [np.zeros((0, P))], [np.zeros((0, P))]
    for leg, mobile in zip(system.legs, at.mobile, strict=True):
        count, z, rows = leg.A.shape[-3], leg.A.shape[-1], leg.J.shape[-2]
        r = found[..., first : first + count * (z + rows), :]
        r = r.reshape((*r.shape[:-2], count, z + rows, P))
        below = np.zeros((mobile.shape[-2] - rows, P))
        s = block([[r[..., z:, :]], [below]]) - mobile @ r[..., :z, :]
        first = first + count * (z + rows)
        for all_legs, part in ((closure, s[..., :rows, :]), (carried, s[..., rows:, :])):
            all_legs.append(part.reshape((*part.shape[:-3], count * part.shape[-2], P)))
    s, own = (block([[part] for part in all_legs]) for all_legs in (closure, carried))
    own = own[..., system.mechanism.carried_order, :]
    return at.Y @ s - at.Q @ found[..., first:, :] + own_rows(system, own)


def residuals(system: System, at: Solved) -> Array:
    """A z̈ + c + Jᵀ f and J z̈ + J̇ż of each leg, and M_p a + c_p, one after the other."""
    x, mechanism, parts, pulled = system.x, system.mechanism, [], []
    platform, tips = mechanism.platform, by_group(mechanism, unstacked(at.f))
    under = ground(mechanism.base, mechanism.gravity)
    held, tilts = np.zeros(6 + platform.modes), by_group(mechanism, merged(system.sections.tilt))
    legs = zip(mechanism.groups, system.legs, sections_of(system), tilts, at.qdd, tips, strict=True)
    for group, leg, section, tilt, zdd, f in legs:
        own, (z, rows) = group.on(leg.branch), (group.chain.size, 3 * len(group.tip_frames))
        floor, seeds = under_legs(group, *under), leg_seeds(leg, x, section)
        rest = leg_residual(own, seeds, zdd, mv(leg.R_ip, f), axes_of(leg, section), floor)
        moved = mtv(leg.R_ip, unstacked(rest[..., z : z + rows]) + floor.gravity[..., None, :])
        parts.append(merged(join([rest[..., :z], merged(moved)])))
        if any(group.soft):
            pull = mtv(leg.R_ip, rest[..., z + 2 * rows :].reshape(leg.place.shape))
            pulled.append(merged(merged(pull)))
        else:
            pulled.append(0.0 * merged(merged(leg.place)))
        if group.flexures is not None:
            m = mtv(leg.R_ip, rest[..., z + rows : z + 2 * rows].reshape(leg.place.shape))
            modal = mtv(tilt.reshape((*m.shape, platform.modes)), m)
            held = held + np.sum(join([np.zeros(3), m, modal]), axis=(-3, -2))
    if mechanism.soft:
        pull = join(pulled)
        held = held + join([mv(system.W_p, pull), mv(system.W_e, pull)])
    gravity = mtv(x.rotation, mechanism.gravity)
    A_rr, A_re, c_r, c_e = platform_terms(platform, x.twist[..., 3:], x.elastic, x.elastic_rate, gravity)
    Vd, qdd_e = at.a[..., :6], at.a[..., 6:]
    rigid = mv(A_rr, Vd) + mv(A_re, qdd_e) + c_r
    elastic = mtv(A_re, Vd) + mv(platform.m_ee, qdd_e) + c_e
    return join([*parts, join([rigid, elastic]) - held])


def by_state(system: System, at: Solved, load: Load, driven: Array | None = None) -> Array:
    """∂(V̇_p, q̈_e, s̈) (…, 6 + N + n, M) for every small motion of the state; `driven` is ∂Γ (…, m, M) where
    forces change with it."""
    f = unstacked(at.f)
    legs = leg_changes(system, at.mobile, at.qdd, f, at.a)
    r_1 = platform_changes(system, at.a, unstacked(tip_forces(system, at.f)), load, legs)
    s, own = legs.closure, legs.carried
    if driven is not None:
        s, own = s + at.JAS @ driven, own + at.AS @ driven

    def changed(s: Array, r: Array, Y: Array, Q: Array) -> Array:
        return s @ transpose(Y) - r @ transpose(Q)

    return transpose(each(changed, [transpose(s), transpose(r_1)], [at.Y, at.Q])) + own_rows(system, own)


def contact_response(mechanism: Mechanism, C: Array, MW: Array) -> Array:
    """Y = M⁻¹ W C⁻¹ (…, 6 + N + n, 3k), zero for rows that depend on others, and at soft tips."""
    kept, dropped, released, order = mechanism.solved_rows
    if len(kept) == C.shape[-1]:
        return transpose(contact_forces(mechanism, C, transpose(MW)))
    if not len(kept):
        return 0.0 * MW
    Y = transpose(solve_definite(C[..., kept, :][..., kept], transpose(MW[..., kept])))
    every = np.concatenate([Y, 0.0 * MW[..., dropped], 0.0 * MW[..., released]], axis=-1)
    return every[..., order]


def inverse_inertia(platform: Platform, contact: Contact) -> Array:
    """M_p⁻¹ (…, 6 + N, 6 + N)."""
    E = contact.inertia.E
    A_i = factored_solve(contact.inertia.A_s, np.eye(6))
    corner = A_i @ E
    return block([[A_i, -corner], [-transpose(corner), platform.m_ee_inverse + transpose(E) @ corner]])
