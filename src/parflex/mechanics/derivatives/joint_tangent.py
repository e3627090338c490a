"""Derivatives of the actuated joints, positions and rates, by the state."""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, block, join, merged, mv, skew, split, transpose
from parflex.base.dual import jacobian
from parflex.base.unroll import each
from parflex.mechanics import chain
from parflex.mechanics.derivatives.tangent import blockwise, leg_seeds
from parflex.mechanics.leg_terms import LegTerms
from parflex.mechanics.legs.alike import each_leg
from parflex.mechanics.legs.base import LegGroup
from parflex.mechanics.system import System, by_group
from parflex.robot.layout import Coordinates


class JointTangent(NamedTuple):
    """Derivatives by the small motions of the state, as in `tangent.py`, of robots whose state carries no
    joints."""

    positions: Array  # ∂q_a (…, m, 12 + 2 N)
    rates: Array  # ∂q̇_a (…, m, 12 + 2 N)


def joint_tangent(system: System) -> JointTangent:
    """The tangent by way of the places and velocities of the legs' tips."""
    mechanism = system.mechanism
    shapes = [(len(group.legs), 6 * len(group.tip_frames)) for group in mechanism.groups]

    def joints(motions: Array, *maps: Array) -> Array:
        """∂(q_a, q̇_a) by group (…, D, 2m) for motions of the tips (…, D, 6k)."""
        q, qd = [], []
        for by_tip, tips in zip(maps, split(motions, shapes), strict=True):
            by_leg = mv(by_tip[..., None, :, :, :], tips)
            half = by_leg.shape[-1] // 2
            q.append(merged(by_leg[..., :half]))
            qd.append(merged(by_leg[..., half:]))
        return join([*q, *qd])

    found = each(joints, [tip_motions(system)], [by_tips(leg, system.x) for leg in system.legs])
    rows, order = transpose(found), mechanism.force_order
    return JointTangent(rows[..., order, :], rows[..., mechanism.n_forces + order, :])


def by_tips(leg: LegTerms, x: Coordinates) -> Array:
    """∂ of `joints_of` (…, L, 2a, 6t), the tips' motions resolved in Σp."""
    seeds = leg_seeds(leg, x)

    def tangent(group: LegGroup, seeds: Array, branch: Array) -> Array:
        return jacobian(lambda x: joints_of(group.on(branch), x), seeds)

    found = each_leg(leg.group, tangent, [seeds, leg.branch])
    R_pi = transpose(leg.R_ip[..., 0, :, :])
    return transpose(blockwise(R_pi, transpose(found)))


def joints_of(group: LegGroup, seeds: Array) -> Array:
    """q_a and q̇_a (…, L, 2a), of places and velocities of the tips in Σ0i."""
    by_tips = (*seeds.shape[:-1], len(group.tip_frames), 3)
    half = seeds.shape[-1] // 2
    place, velocity = seeds[..., :half].reshape(by_tips), seeds[..., half:].reshape(by_tips)
    c, none = group.chain, seeds[..., :0]
    joints = group.type.joints(group, place, none)
    qd = group.type.rates(group, chain.frames(c, joints), joints, place, velocity, none)
    still = np.zeros(len(group.legs))
    q_a = [chain.joint_position(c, joints, j, still)[..., None] for j in group.actuated]
    return join([*q_a, qd[..., list(group.actuated)]])


def tip_motions(system: System) -> Array:
    """Places and velocities of the tips in Σp, leg by leg (…, 12 + 2 N, 6k), of each small motion."""
    x, (r, v, _), Phi = system.x, system.points, system.shapes
    axes, w = transpose(x.rotation)[..., None, :, :], skew(x.twist[..., None, 3:])
    one, none, unbent = np.eye(3), np.zeros((3, 3)), np.zeros(Phi.shape)
    place = block([[axes, -skew(r), none, none, Phi, unbent]])
    velocity = block([[none, -skew(v), one, -skew(r), w @ Phi, Phi]])
    both = np.concatenate(np.broadcast_arrays(place, velocity), axis=-2)
    D, parts = both.shape[-1], []
    for tips in by_group(system.mechanism, merged(both)):
        count, t = tips.shape[-3:-1]
        by_leg = np.moveaxis(tips.reshape((*tips.shape[:-1], 2, 3, D)), -3, -4)
        parts.append(by_leg.reshape((*tips.shape[:-3], count * t * 6, D)))
    return transpose(np.concatenate(parts, axis=-2))
