"""The contact system: what is left of the equations of legs, platform and closure when the accelerations
are eliminated (`dynamics.py`), put together tip by tip.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, block_diagonal, join, merged, mtv, mv, split, transpose
from parflex.base.unroll import factored, factored_solve, for_each, solve_definite
from parflex.mechanics import kinematics
from parflex.mechanics.legs.alike import leg_by_leg
from parflex.mechanics.legs.base import LegGroup
from parflex.mechanics.system import LegTerms, System, diagonal, selection
from parflex.robot.body import FlexibleBody
from parflex.robot.robot import Robot


class MobileInertia(NamedTuple):
    """M_p⁻¹ with the modal block eliminated first: m_ee is constant, the rest has rank six."""

    E: Array  # (…, 6, N), A_re m_ee⁻¹
    A_s: Array  # (…, 6, 6), A_rr − E A_reᵀ, as `factored`
    B: Array  # (…, 6, 3k), W_p − E W_e


class Contact(NamedTuple):
    """The contact system: C f = rhs + JAS Γ."""

    inertia: MobileInertia
    C: Array  # (…, 3k, 3k)
    compliance: Array  # (…, 3k, 3k), the legs' part of C
    rhs: Array  # (…, 3k)
    JAS: Array  # (…, 3k, m), J A⁻¹ S
    c_s: Array  # (…, 6), c_r − E c_e
    c_e: Array  # (…, N)


def contact_system(robot: Robot, system: System, wrench: Array) -> Contact:
    """The system at a state, under a generalised force (…, 6 + N)."""
    body, (A_rr, A_re, c_r, c_e) = robot.platform, system.platform
    c_r, c_e = c_r - wrench[..., :6], c_e - wrench[..., 6:]
    E = transpose(body.modal_solve(transpose(A_re)))
    A_s, c_s = factored(A_rr - E @ transpose(A_re)), c_r - mv(E, c_e)
    a_r = factored_solve(A_s, c_s[..., None])[..., 0]
    a_e = body.modal_solve(c_e[..., None])[..., 0]

    contacts = [leg_contacts(leg) for leg in system.legs]
    JAS = diagonal([block_diagonal(driven) for _, driven, _ in contacts])[..., robot.force_order]
    drift = join([np.zeros(0), *(merged(drift) for *_, drift in contacts)])
    rows = [system.points.r, kinematics.unstacked(drift) - system.points.h, merged(system.shapes)]
    found = for_each(of_tips, rows, [E, A_s, a_r, a_e])
    B, held, rhs = split(found, [(3, 6), (3, 6), (3,)])

    own, mates = compliances([compliance for compliance, *_ in contacts])
    bending = transpose(body.modal_solve(system.W_e)) @ system.W_e
    between = bending.reshape((*bending.shape[:-2], len(mates), 9 * len(mates)))
    parts = [merged(own), merged(mates), between, merged(B)]
    found = for_each(contact_rows, parts, [stacked(held)])
    C, legs = split(found, [(3, 3 * len(mates))] * 2)
    inertia = MobileInertia(E, A_s, transpose(stacked(B)))
    return Contact(inertia, stacked(C), stacked(legs), merged(rhs), JAS, c_s, c_e)


def loaded(body: FlexibleBody, system: System, contact: Contact, wrench: Array) -> Contact:
    """The same system under one more generalised force (…, 6 + N)."""
    E, A_s, B = contact.inertia
    w_e = wrench[..., 6:]
    w_s = wrench[..., :6] - mv(E, w_e)
    pushed = mtv(B, factored_solve(A_s, w_s[..., None])[..., 0])
    pushed = pushed + mtv(system.W_e, body.modal_solve(w_e[..., None])[..., 0])
    return contact._replace(rhs=contact.rhs - pushed, c_s=contact.c_s - w_s, c_e=contact.c_e - w_e)


def of_tips(r: Array, rest: Array, shapes: Array, E: Array, A_s: Array, a_r: Array, a_e: Array) -> Array:
    """Of tips at r (…, k, 3) the rows of Bᵀ and of (A_s⁻¹ B)ᵀ, each 3 × 6, and the right-hand side 3."""
    Phi = shapes.reshape((*shapes.shape[:-1], 3, E.shape[-1]))
    B = transpose(kinematics.tip_map(r)) - Phi @ transpose(E)[..., None, :, :]
    held = transpose(factored_solve(A_s[..., None, :, :], transpose(B)))
    rhs = rest + mv(B, a_r[..., None, :]) + mv(Phi, a_e[..., None, :])
    return join([merged(B), merged(held), rhs])


def contact_rows(own: Array, mates: Array, bending: Array, B: Array, held: Array) -> Array:
    """Of tips (…, k) the rows of C, and the legs' part of them, each 3 × 3k.

    own (…, k, 3 · 3s) are compliances with the tips of the same leg, mates (k, s · k) which those are.
    """
    tips, most = held.shape[-2] // 3, own.shape[-1] // 9
    wide = own.reshape((*own.shape[:-1], 3, most, 1, 3))
    where = mates.reshape((*mates.shape[:-1], 1, most, tips, 1))
    legs = np.sum(wide * where, axis=-3)
    legs = legs.reshape((*legs.shape[:-2], 3 * tips))
    C = B.reshape((*B.shape[:-1], 3, 6)) @ transpose(held)[..., None, :, :]
    C = C + bending.reshape((*bending.shape[:-1], 3, 3 * tips)) + legs
    return join([merged(C), merged(legs)])


def compliances(blocks: Sequence[Array]) -> tuple[Array, Array]:
    """J A⁻¹ Jᵀ of groups of legs (…, L, 3t, 3t), tip by tip: (…, k, 3, 3s), with the s tips of the same leg;
    and which those are, (k, s, k) of zeros and ones."""
    most = max((block.shape[-1] // 3 for block in blocks), default=1)
    count = sum(block.shape[-3] * block.shape[-1] // 3 for block in blocks)
    own, mates, first = [np.zeros((0, 3, 3 * most))], np.zeros((count, most, count)), 0
    for block in blocks:
        legs, tips = block.shape[-3], block.shape[-1] // 3
        rows = block.reshape((*block.shape[:-3], legs * tips, 3, 3 * tips))
        none = np.zeros((*rows.shape[:-1], 3 * (most - tips)))
        own.append(np.concatenate([rows, none], axis=-1))
        for leg in range(legs):
            its = first + leg * tips + np.arange(tips)
            mates[its[:, None], np.arange(tips), its] = 1.0
        first += legs * tips
    batch = np.broadcast_shapes(*(part.shape[:-3] for part in own))
    wide = [np.broadcast_to(part, batch + part.shape[-3:]) for part in own]
    return np.concatenate(wide, axis=-3), mates


def stacked(rows: Array) -> Array:
    """(…, k, 3, c) as (…, 3k, c)."""
    return rows.reshape((*rows.shape[:-3], 3 * rows.shape[-3], rows.shape[-1]))


def contact_forces(robot: Robot, C: Array, columns: Array) -> Array:
    """f (…, 3k, c) with C f = columns (…, 3k, c): of least norm where rows depend on others.

    Dependent rows are D times the independent ones, D = C_ds C_ss⁻¹, so that (f_s, f_d) acts as
    f_s + Dᵀ f_d; the shortest pair with the same action has f_d = D f_s.
    """
    kept, dropped, order = robot.rows
    if not len(dropped):
        return solve_definite(C, columns, 3)  # axis by axis the tips are alike
    C_s = C[..., kept, :]
    right = np.concatenate([columns[..., kept, :], C_s[..., dropped]], axis=-1)
    solved = solve_definite(C_s[..., kept], right)
    count = columns.shape[-1]
    f, D = solved[..., :count], transpose(solved[..., count:])
    excess = solve_definite(np.eye(len(dropped)) + D @ transpose(D), D @ f)
    f = f - transpose(D) @ excess
    return np.concatenate([f, D @ f], axis=-2)[..., order, :]


def leg_contacts(leg: LegTerms) -> list[Array]:
    """J A⁻¹ Jᵀ (…, L, 3t, 3t), J A⁻¹ S (…, L, 3t, a) and J̇q̇ − J A⁻¹ c (…, L, 3t) of the legs of a group."""
    S, (contacts, n) = selection(leg.group), leg.J.shape[-2:]

    def solved(group: LegGroup, A: Array, J: Array, c: Array, Jdqd: Array) -> list[Array]:
        A, J = A.reshape(A.shape[:-1] + (n, n)), J.reshape(J.shape[:-1] + (contacts, n))
        columns = np.concatenate([transpose(J), np.broadcast_to(S, A.shape[:-2] + S.shape), c[..., None]], -1)
        found = J @ solve_definite(A, columns)
        return [found[..., :contacts], found[..., contacts:-1], Jdqd - found[..., -1]]

    shapes = [(contacts, contacts), (contacts, S.shape[-1]), (contacts,)]
    return leg_by_leg(leg.group, solved, [merged(leg.A), merged(leg.J), leg.c, leg.Jdqd], [], shapes)
