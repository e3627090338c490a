"""The contact system formed tip by tip, for machine code that computes one state.

All tips share an instruction then, where the formula of `mechanics.contact` leaves the product Bᵀ A_s⁻¹ B
to scalar code: by the formula a single direct model takes longer, by 11 % for the rigid Gough-Stewart
robot, 14 % with ten modes, 7 % with forty, 4 to 10 % for a Delta. In batches the two cost the same number
of operations, and the formula is what runs.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from parflex.base.array import Array, block_diagonal, join, merged, mv, split, transpose
from parflex.base.unroll import each, factored, factored_solve, looping
from parflex.mechanics import kinematics
from parflex.mechanics.contact import Contact, MobileInertia, eliminated, leg_contacts
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.system import System, diagonal


def by_tips(mechanism: Mechanism) -> Mechanism:
    """The mechanism whose contact system is formed tip by tip where that is quicker."""
    return replace(mechanism, elimination=contact_system)


def contact_system(system: System, wrench: Array) -> Contact:
    """The contact system at a state, under a generalised force (…, 6 + N)."""
    if looping.get() is None:
        return eliminated(system, wrench)
    mechanism, (A_rr, A_re, c_r, c_e) = system.mechanism, system.platform
    solve = mechanism.platform.modal_solve
    c_r, c_e = c_r - wrench[..., :6], c_e - wrench[..., 6:]
    E = transpose(solve(transpose(A_re)))
    A_s, c_s = factored(A_rr - E @ transpose(A_re)), c_r - mv(E, c_e)
    a_r, a_e = factored_solve(A_s, c_s[..., None])[..., 0], solve(c_e[..., None])[..., 0]

    legs = [leg_contacts(leg) for leg in system.legs]
    JAS = diagonal([block_diagonal(leg.driven) for leg in legs])[..., mechanism.force_order]
    drift = join([np.zeros(0), *(merged(leg.drift) for leg in legs)])
    rows = [system.points.r, kinematics.unstacked(drift) - system.points.h, merged(system.shapes)]
    B, held, rhs = split(each(of_tips, rows, [E, A_s, a_r, a_e]), [(3, 6), (3, 6), (3,)])

    own, mates = compliances([leg.compliance for leg in legs])
    bending = transpose(solve(system.W_e)) @ system.W_e
    between = bending.reshape((*bending.shape[:-2], len(mates), 9 * len(mates)))
    parts = [merged(own), merged(mates), between, merged(B)]
    C, compliance = split(each(contact_rows, parts, [stacked(held)]), [(3, 3 * len(mates))] * 2)
    inertia = MobileInertia(E, A_s, transpose(stacked(B)))
    return Contact(inertia, stacked(C), stacked(compliance), merged(rhs), JAS, c_s, c_e)


def of_tips(r: Array, rest: Array, shapes: Array, E: Array, A_s: Array, a_r: Array, a_e: Array) -> Array:
    """The rows of Bᵀ and of (A_s⁻¹ B)ᵀ, each 3 × 6, and the right-hand side 3, of tips at r (…, k, 3)."""
    Phi = shapes.reshape((*shapes.shape[:-1], 3, E.shape[-1]))
    B = transpose(kinematics.tip_map(r)) - Phi @ transpose(E)[..., None, :, :]
    held = transpose(factored_solve(A_s[..., None, :, :], transpose(B)))
    rhs = rest + mv(B, a_r[..., None, :]) + mv(Phi, a_e[..., None, :])
    return join([merged(B), merged(held), rhs])


def contact_rows(own: Array, mates: Array, bending: Array, B: Array, held: Array) -> Array:
    """The rows of C of tips (…, k), and the legs' part of them, each 3 × 3k.

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
