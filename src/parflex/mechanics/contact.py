"""The contact system: what is left of the equations of legs, platform and closure when the accelerations
are eliminated (`dynamics.py`).
"""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, block_diagonal, join, merged, mtv, mv, transpose
from parflex.base.unroll import factored, factored_solve, solve_definite
from parflex.mechanics.leg_terms import LegTerms, leg_response
from parflex.mechanics.legs.alike import each_leg
from parflex.mechanics.legs.base import LegGroup
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.system import System, diagonal


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


def contact_system(system: System, wrench: Array) -> Contact:
    """The contact system at a state, under a generalised force (…, 6 + N), as the mechanism has it formed."""
    found: Contact = (system.mechanism.elimination or eliminated)(system, wrench)
    return found


def eliminated(system: System, wrench: Array) -> Contact:
    """The contact system at a state, under a generalised force (…, 6 + N)."""
    solve, (A_rr, A_re, c_r, c_e) = system.mechanism.platform.modal_solve, system.platform
    c_r, c_e = c_r - wrench[..., :6], c_e - wrench[..., 6:]
    E = transpose(solve(transpose(A_re)))
    A_s, c_s = factored(A_rr - E @ transpose(A_re)), c_r - mv(E, c_e)
    B = system.W_p - E @ system.W_e
    compliance, JAS, drift = legs_at_tips(system)
    solved = factored_solve(A_s, np.concatenate([B, c_s[..., None]], axis=-1))
    C = transpose(B) @ solved[..., :-1] + transpose(system.W_e) @ solve(system.W_e) + compliance
    rhs = drift - merged(system.points.h) + mtv(B, solved[..., -1])
    rhs = rhs + mtv(system.W_e, solve(c_e[..., None])[..., 0])
    return Contact(MobileInertia(E, A_s, B), C, compliance, rhs, JAS, c_s, c_e)


def loaded(system: System, contact: Contact, wrench: Array) -> Contact:
    """The same system under one more generalised force (…, 6 + N)."""
    E, A_s, B = contact.inertia
    w_e = wrench[..., 6:]
    w_s = wrench[..., :6] - mv(E, w_e)
    pushed = mtv(B, factored_solve(A_s, w_s[..., None])[..., 0])
    pushed = pushed + mtv(system.W_e, system.mechanism.platform.modal_solve(w_e[..., None])[..., 0])
    return contact._replace(rhs=contact.rhs - pushed, c_s=contact.c_s - w_s, c_e=contact.c_e - w_e)


def contact_forces(mechanism: Mechanism, C: Array, columns: Array) -> Array:
    """f (…, 3k, c) with C f = columns: zero at soft tips, of least norm where rows depend on others.

    Dependent rows are D times the independent ones, D = C_ds C_ss⁻¹, so that (f_s, f_d) acts as
    f_s + Dᵀ f_d; the shortest pair with the same action has f_d = D f_s.
    """
    kept, dropped, released, order = mechanism.solved_rows
    if len(kept) == C.shape[-1]:
        return solve_definite(C, columns, 3)  # axis by axis the tips are alike
    if not len(kept):
        return 0.0 * columns
    C_s, none = C[..., kept, :], 0.0 * columns[..., released, :]
    if not len(dropped):
        f = solve_definite(C_s[..., kept], columns[..., kept, :], 3)
        return np.concatenate([f, none], axis=-2)[..., order, :]
    right = np.concatenate([columns[..., kept, :], C_s[..., dropped]], axis=-1)
    solved = solve_definite(C_s[..., kept], right)
    count = columns.shape[-1]
    f, D = solved[..., :count], transpose(solved[..., count:])
    excess = solve_definite(np.eye(len(dropped)) + D @ transpose(D), D @ f)
    f = f - transpose(D) @ excess
    return np.concatenate([f, D @ f, none], axis=-2)[..., order, :]


class LegContacts(NamedTuple):
    """The part of the legs of a group, or of all of them (…, 3k), in the contact system."""

    compliance: Array  # J A⁻¹ Jᵀ (…, L, 3t, 3t)
    driven: Array  # J A⁻¹ S (…, L, 3t, a)
    drift: Array  # J̇ż − J A⁻¹ c (…, L, 3t)


def legs_at_tips(system: System) -> LegContacts:
    """All legs seen from their tips, group by group."""
    legs = [leg_contacts(leg) for leg in system.legs]
    return LegContacts(
        diagonal([block_diagonal(leg.compliance) for leg in legs]),
        diagonal([block_diagonal(leg.driven) for leg in legs])[..., system.mechanism.force_order],
        join([np.zeros(0), *(merged(leg.drift) for leg in legs)]),
    )


def leg_contacts(leg: LegTerms) -> LegContacts:
    """The legs of a group seen from their tips."""
    S, (contacts, n) = leg.group.S, leg.J.shape[-2:]

    def solved(group: LegGroup, A: Array, J: Array, c: Array, Jdqd: Array) -> LegContacts:
        A, J = A.reshape(A.shape[:-1] + (n, n)), J.reshape(J.shape[:-1] + (contacts, n))
        columns = np.concatenate([transpose(J), np.broadcast_to(S, A.shape[:-2] + S.shape), c[..., None]], -1)
        found = J @ leg_response(group, A, columns)
        return LegContacts(found[..., :contacts], found[..., contacts:-1], Jdqd - found[..., -1])

    found: LegContacts = each_leg(leg.group, solved, [merged(leg.A), merged(leg.J), leg.c, leg.Jdqd])
    return found
