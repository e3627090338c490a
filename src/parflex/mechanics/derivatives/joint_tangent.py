"""Derivatives of the actuated joints, positions and rates, by the state."""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, join, merged, split, transpose
from parflex.base.dual import jacobian
from parflex.mechanics import chain
from parflex.mechanics.derivatives.changes import assembled
from parflex.mechanics.derivatives.leg_tangent import blockwise
from parflex.mechanics.derivatives.tip_motions import leg_by_leg, tip_motions
from parflex.mechanics.joint_forces import at_motor
from parflex.mechanics.leg_terms import LegTerms, of_motors, rates_of
from parflex.mechanics.legs.alike import each_leg
from parflex.mechanics.legs.base import LegGroup
from parflex.mechanics.system import System
from parflex.robot.layout import Coordinates


class JointTangent(NamedTuple):
    """Derivatives by the small motions of the state, as in `changes.py`."""

    positions: Array  # ∂q_a (…, m, 12 + 2 N + 2 n)
    rates: Array  # ∂q̇_a (…, m, 12 + 2 N + 2 n)


def joint_tangent(system: System) -> JointTangent:
    """The tangent by way of the places and velocities of the legs' tips, and of what the state carries."""
    mechanism, found = system.mechanism, []
    for leg, moved in zip(system.legs, leg_by_leg(system, tip_motions(system), sections=False), strict=True):
        by_seeds = by_leg(leg, system.x)
        tips, half = moved.shape[-2], by_seeds.shape[-2] // 2
        R_pi = transpose(leg.R_ip[..., 0, :, :])
        by_motion = transpose(blockwise(R_pi, transpose(by_seeds[..., :tips]))) @ moved
        own = by_seeds[..., tips:]
        found.append([(part[..., :half, :], part[..., half:, :]) for part in (by_motion, own)])
    R_p0, order = transpose(system.x.rotation), mechanism.force_order
    both = (assembled(mechanism, R_p0, [m[i] for m, _ in found], [s[i] for _, s in found]) for i in (0, 1))
    return JointTangent(*(part[..., order, :] for part in both))


def by_leg(leg: LegTerms, x: Coordinates) -> Array:
    """∂ of `joints_of` (…, L, 2a, d) by its seeds."""
    own = [x.s[..., leg.group.carried], x.sd[..., leg.group.carried]]
    tips = [merged(leg.place), merged(leg.velocity)] if leg.group.reads_tips else []

    def tangent(group: LegGroup, seeds: Array, branch: Array) -> Array:
        return jacobian(lambda x: joints_of(group.on(branch), x), seeds)

    found: Array = each_leg(leg.group, tangent, [join([*tips, *own]), leg.branch])
    return found


def joints_of(group: LegGroup, seeds: Array) -> Array:
    """θ and θ̇ of the motors (…, L, 2a), of places and velocities of the tips in Σ0i, which legs that
    carry their joints do not read, and of carried coordinates and their rates, side by side."""
    c, tips = group.chain, (len(group.tip_frames) if group.reads_tips else 0, 3)
    place, velocity, s, sd = split(seeds, [tips, tips, (len(group.kept),), (len(group.kept),)])
    joints = group.type.joints(group, place, s)
    frames, still = chain.frames(c, joints), np.zeros(len(group.legs))
    J = [chain.tip_jacobian(c, frames, tip) for tip in group.points(joints.bend)] if any(c.modes) else []
    zd = rates_of(group, frames, joints, J, place, velocity, sd)
    q_a = [chain.joint_position(c, joints, j, still) for j in group.actuated]
    motors = [at_motor(c, j, q, joints.bend)[..., None] for j, q in zip(group.actuated, q_a, strict=True)]
    return join([*motors, of_motors(group, zd)])
