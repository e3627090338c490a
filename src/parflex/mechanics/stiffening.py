"""Legs that do not accelerate in their bend: each flexible link is taken as a body of the shape it has,
motors move with what they drive, and soft tips hold the platform."""

from dataclasses import replace

import numpy as np

from parflex.base.array import Array, join, merged, mtv, mv
from parflex.mechanics.leg_terms import LegTerms
from parflex.mechanics.platform import PlatformTerms
from parflex.mechanics.system import (
    System,
    at_tips,
    in_carried_order,
    leg_accelerations,
    leg_pulls,
    soft_pulls,
)
from parflex.robot.robot import Robot


def stiffened(system: System) -> System:
    """The system with ë = 0: the equations of the links' bend are replaced by it; soft tips do not pull, and
    their rows are solved as those of others. Itself where nothing gives."""
    mechanism = system.mechanism
    if not mechanism.gives:
        return system
    stiff = replace(mechanism, rows=mechanism.rows_stiff)
    legs = [stiffened_leg(leg) for leg in system.legs]
    return system._replace(mechanism=stiff, legs=legs, platform=unpulled(system))


def unpulled(system: System) -> PlatformTerms:
    """The platform's terms without the forces of soft tips."""
    platform = system.platform
    if not system.mechanism.soft:
        return platform
    pull, bent = soft_pulls(system.legs), system.sections.tilt
    arm = at_tips(
        [leg.flexed.moment - leg.twist if any(leg.group.soft) else 0.0 * leg.place for leg in system.legs]
    )
    rigid = mv(system.W_p, merged(pull)) + join([np.zeros(3), np.sum(arm, axis=-2)])
    elastic = mv(system.W_e, merged(pull)) + np.sum(mtv(bent, arm), axis=-2)
    return platform._replace(c_r=platform.c_r + rigid, c_e=platform.c_e + elastic)


def stiffened_leg(leg: LegTerms) -> LegTerms:
    """The leg with A = [A_qq 0; 0 1], c = (c_q, 0), J = [J_q 0], S = (S_q, 0)."""
    joints, c = of_joints(leg), leg.c
    if any(leg.group.soft):
        c = c - mtv(leg.J, merged(leg.flexed.pull))
    group = leg.group._replace(S=joints[:, None] * leg.group.S)
    A = joints[:, None] * leg.A * joints + np.diag(1.0 - joints)
    return leg._replace(group=group, A=A, c=c * joints, J=leg.J * joints)


def of_joints(leg: LegTerms) -> Array:
    """(z,): 1 for the joints among a leg's coordinates z = (q, e), 0 for its bend."""
    return np.repeat([1.0, 0.0], [leg.group.chain.n, leg.group.chain.size - leg.group.chain.n])


def unbalanced(system: System, forces: Array, f: Array) -> Array:
    """The excess of the legs' bend over that which balances: K⁻¹ (A_eq q̈ + c_e + J_eᵀ f − S_e Γ), under
    Γ (…, m) and contact forces (…, 3k) of the stiffened system.

    It is in the order of the coordinates that the state carries, and zero for joints; for shapes without
    stiffness it is the force itself.
    """
    found = []
    moved = zip(leg_accelerations(stiffened(system), forces, f), leg_pulls(system, f), strict=True)
    for leg, (zdd, pull) in zip(system.legs, moved, strict=True):
        driving = mv(leg.group.S, forces[..., leg.group.forces])
        rest = mv(leg.A, zdd) + leg.c + pull - driving
        found.append(rest * (1.0 - of_joints(leg)) / yielding(leg, system.mechanism.robot))
    return in_carried_order(system, found)


def yielding(leg: LegTerms, robot: Robot) -> Array:
    """The stiffness (L, z) of the links' shapes and of drives; 1 where there is none, and of joints."""
    group, parts = leg.group, [np.ones((len(leg.group.legs), leg.group.chain.n))]
    for j, link in enumerate(group.chain.links):
        if link is not None:
            bodies = [robot.legs[number].joints[j].body for number in group.legs]
            parts.append(link.stiffness + [body.stiffness == 0 for body in bodies if body is not None])
    return join([*parts, group.chain.drive_stiffness[:, list(group.chain.drives)]])
