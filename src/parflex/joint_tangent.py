"""How actuated joints and friction change with the platform's motion."""

from typing import NamedTuple

import numpy as np

from parflex import chain
from parflex.array import Array, block, dot, join, merged, skew, stack, transpose
from parflex.assembly import LegTerms, System, by_group
from parflex.dual import jacobian
from parflex.legs.alike import leg_by_leg
from parflex.legs.base import LegGroup
from parflex.robot import Robot
from parflex.state import Coordinates
from parflex.tangent import blockwise, leg_seeds


class JointTangent(NamedTuple):
    """By the small motions of the state, as in `tangent.py`; of robots whose state carries no joints."""

    positions: Array  # ∂q_a (…, m, 12 + 2 N)
    rates: Array  # ∂q̇_a (…, m, 12 + 2 N)
    friction: Array  # ∂ of the power that friction takes (…, 12 + 2 N)


def joint_tangent(robot: Robot, system: System) -> JointTangent:
    """By way of the places and velocities of the legs' tips."""
    positions, rates, lost = [], [], []
    for leg, motions in zip(system.legs, by_group(robot, tip_motions(system)), strict=True):
        found, a = by_tips(leg, system.x) @ of_each_leg(motions), len(leg.group.actuated)
        positions.append(rows_of(found[..., :a, :]))
        rates.append(rows_of(found[..., a:-1, :]))
        lost.append(found[..., -1, :])
    q, qd, lost_by_leg = (np.concatenate(parts, axis=-2) for parts in (positions, rates, lost))
    order = robot.force_order
    return JointTangent(q[..., order, :], qd[..., order, :], np.sum(lost_by_leg, axis=-2))


def by_tips(leg: LegTerms, x: Coordinates) -> Array:
    """∂ of `joints_of` (…, L, 2a + 1, 6t), the tips' motions resolved in Σp."""
    seeds = leg_seeds(leg, x)
    shape = (2 * len(leg.group.actuated) + 1, seeds.shape[-1])

    def tangent(group: LegGroup, seeds: Array) -> list[Array]:
        return [jacobian(lambda x: joints_of(group, x), seeds)]

    found = leg_by_leg(leg.group, tangent, [seeds], [], [shape])[0]
    R_pi = transpose(leg.R_ip[..., 0, :, :])
    return transpose(blockwise(R_pi, transpose(found)))


def joints_of(group: LegGroup, seeds: Array) -> Array:
    """q_a, q̇_a and friction's power (…, L, 2a + 1), of places and velocities of the tips in Σ0i."""
    by_tips = (*seeds.shape[:-1], len(group.tip_frames), 3)
    half = seeds.shape[-1] // 2
    place, velocity = seeds[..., :half].reshape(by_tips), seeds[..., half:].reshape(by_tips)
    c, none = group.chain, seeds[..., :0]
    joints = group.type.joints(group, place, none)
    qd = group.type.rates(group, chain.frames(c, joints), joints, place, velocity, none)
    still = np.zeros(len(group.legs))
    q_a = [chain.joint_position(c, joints, j, still) for j in group.actuated]
    qd_a = [qd[..., j] for j in group.actuated]
    return stack([*q_a, *qd_a, dot(qd, chain.friction(c, qd))])


def tip_motions(system: System) -> Array:
    """∂ of places and velocities of the tips in Σp, (…, k, 2 · 3 (12 + 2 N)), by the small motions."""
    x, (r, v, _), Phi = system.x, system.points, system.shapes
    axes, w = transpose(x.rotation)[..., None, :, :], skew(x.twist[..., None, 3:])
    one, none, unbent = np.eye(3), np.zeros((3, 3)), np.zeros(Phi.shape)
    place = block([[axes, -skew(r), none, none, Phi, unbent]])
    velocity = block([[none, -skew(v), one, -skew(r), w @ Phi, Phi]])
    return join([merged(place), merged(velocity)])


def of_each_leg(motions: Array) -> Array:
    """Motions of the tips (…, L, t, 6 D) as one matrix (…, L, 6t, D) per leg, places first."""
    *batch, t, size = motions.shape
    parts = motions.reshape((*batch, t, 2, 3, size // 6))
    return np.moveaxis(parts, -3, -4).reshape((*batch, 6 * t, size // 6))


def rows_of(by_leg: Array) -> Array:
    """(…, L, a, D) as (…, L a, D)."""
    return by_leg.reshape((*by_leg.shape[:-3], by_leg.shape[-3] * by_leg.shape[-2], by_leg.shape[-1]))
