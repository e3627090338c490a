"""The accelerations of the legs' joints that the platform's motion imposes, whatever the forces."""

import numpy as np

from parflex.base.array import Array, join, merged, mtv, mv, transpose
from parflex.base.unroll import solve_definite
from parflex.mechanics.kinematics import unstacked
from parflex.mechanics.leg_terms import LegTerms
from parflex.mechanics.system import System, by_group


def imposed_accelerations(system: System, platform: Array, elastic: Array) -> list[Array]:
    """z̈ (…, L, z) of each group at V̇_p (…, 6) and q̈_e (…, N): J q̈ = Wᵀ (V̇_p, q̈_e) + h − J̇ż.

    Links and drives do not accelerate in their bend. Legs with fewer joints than their tips have coordinates
    need an acceleration that the closure allows; joints that the state carries follow in the sense of least
    squares, and are no more than the coordinates.
    """
    moved = mtv(system.W_p, platform) + mtv(system.W_e, elastic) + merged(system.points.h)  # Eqs. 22, 38
    tips = by_group(system.mechanism, unstacked(moved))
    found = [followed(leg, merged(tip) - leg.Jdqd) for leg, tip in zip(system.legs, tips, strict=True)]
    return [
        join([qdd, np.zeros(leg.group.chain.size - leg.group.chain.n)])
        for leg, qdd in zip(system.legs, found, strict=True)
    ]


def followed(leg: LegTerms, rest: Array) -> Array:
    """q̈ (…, L, n) with J q̈ = rest (…, L, 3t), in Σp."""
    if leg.group.type.carries:
        J = leg.J[..., : leg.group.chain.n]
        return solve_definite(transpose(J) @ J, mtv(J, rest)[..., None])[..., 0]
    group, v = leg.group.on(leg.branch), mv(leg.R_ip, unstacked(rest))
    found = group.type.rates(group, leg.frames, leg.joints, leg.place, v, leg.qd)
    return np.broadcast_to(found, leg.qd.shape)
