"""Legs, platform and closure at one state, ready for the models."""

from typing import NamedTuple

import numpy as np

from parflex import chain, kinematics
from parflex.array import (
    Array,
    block_diagonal,
    join,
    merged,
    mtv,
    mv,
    solve_definite,
    solve_least_norm,
    stack,
    transpose,
)
from parflex.chain import Frames
from parflex.kinematics import PointMotion
from parflex.platform import PlatformTerms, platform_terms
from parflex.robot import LegGroup, Robot
from parflex.state import Coordinates


class LegTerms(NamedTuple):
    """The model of the L legs of a group: A q̈ + c = S Γ − Jᵀ f; J and J̇q̇ resolved in Σp."""

    group: LegGroup
    joints: chain.Joints
    frames: Frames
    qd: Array  # (…, L, n)
    A: Array  # (…, L, n, n)
    c: Array  # (…, L, n)
    J: Array  # (…, L, 3t, n)
    Jdqd: Array  # (…, L, 3t)


class System(NamedTuple):
    """Everything at one state; legs' tips in the order of the groups."""

    legs: list[LegTerms]
    points: PointMotion  # of the attachments that are held
    W_p: Array  # (…, 6, 3k)
    W_e: Array  # (N, 3k)
    platform: PlatformTerms


def assemble(robot: Robot, x: Coordinates) -> System:
    """Legs, platform and closure at a state."""
    body, held = robot.platform, robot.tip_attachments
    shapes = body.attachment_shapes[held]
    points = kinematics.point_motion(body.attachment_points[held], shapes, x)
    W_p, W_e = kinematics.wrench_map(points.r, shapes)
    gravity_p = mtv(x.rotation, robot.gravity)
    platform = platform_terms(body, x.twist[..., 3:], x.elastic, x.elastic_rate, gravity_p)
    legs, first = [], 0
    for group in robot.groups:
        last = first + group.attachments.size
        legs.append(leg_terms(robot, group, x, points.r[..., first:last, :], points.v[..., first:last, :]))
        first = last
    return System(legs, points, W_p, W_e, platform)


def leg_terms(robot: Robot, group: LegGroup, x: Coordinates, r: Array, v: Array) -> LegTerms:
    """The legs of a group, moved by their tips at r with velocity v (…, L t, 3), in Σp."""
    count, tips = group.attachments.shape
    by_leg = r.shape[:-2] + (count, tips, 3)
    R_i0 = transpose(group.rotation)[:, None]
    R_ip = R_i0 @ x.rotation[..., None, None, :, :]
    place = kinematics.position_in_world(r, x).reshape(by_leg) - group.origin[:, None]
    place, velocity = mv(R_i0, place), mv(R_ip, v.reshape(by_leg))
    joints = group.type.joints(group.chain, group.offsets, place)
    frames = chain.frames(group.chain, joints)
    qd = group.type.rates(group.chain, frames, joints, place, velocity)
    rest = np.zeros(group.chain.n)
    gravity = mtv(group.rotation, np.asarray(robot.gravity))
    motions = chain.link_motions(group.chain, frames, qd, rest, gravity)
    R_pi = transpose(R_ip[..., 0, :, :])
    J, Jdqd = [], []
    for t, j in enumerate(group.tip_frames):
        offset, (omega, omegad, vd) = group.offsets[:, t], motions[j]
        acceleration = mv(frames.R_0j[j], vd + chain.point_acceleration(omega, omegad, offset))
        J.append(R_pi @ chain.tip_jacobian(group.chain, frames, j, offset))  # Eqs. 1, 3
        Jdqd.append(mv(R_pi, acceleration + gravity))
    return LegTerms(
        group,
        joints,
        frames,
        qd,
        A=chain.inertia_matrix(group.chain, frames),
        c=chain.inverse_dynamics(group.chain, frames, motions, rest),
        J=np.concatenate(J, axis=-2),
        Jdqd=np.concatenate(Jdqd, axis=-1),
    )


def selection(group: LegGroup) -> Array:
    """S (n, actuated): Γ_i = [0 0 Γ_3i]ᵀ for a leg that drives its third joint."""
    return np.eye(group.chain.n)[:, list(group.actuated)]  # Eq. 8


def actuated_axes(robot: Robot, system: System) -> Array:
    """∂q_a/∂p (…, 3k, m): rows of the legs' J⁻¹, for a slider its unit axis a_3i."""
    parts = []
    for leg in system.legs:
        rows = transpose(leg.J)
        unit = selection(leg.group).T
        axes = [solve_least_norm(rows, np.broadcast_to(u, rows.shape[:-1])) for u in unit]
        parts.append(block_diagonal(stack(axes) if axes else leg.J[..., :0]))
    return diagonal(parts)[..., robot.force_order]


def leg_margins(system: System) -> Array:
    """Reach and regularity of the legs' inverse geometry, (…, 2 legs) in the order of the groups."""
    parts = [np.zeros(0)]
    for leg in system.legs:
        parts += leg.group.type.margins(leg.group.chain, leg.joints, leg.group.offsets)
    return join(parts)


def joint_rates(robot: Robot, system: System) -> Array:
    """q̇_a (…, m) of the actuated joints, in the order of Γ."""
    parts = [leg.qd[..., list(leg.group.actuated)] for leg in system.legs]
    flat = [merged(part) for part in parts]
    return join([np.zeros(0), *flat])[..., robot.force_order]


def actuated_positions(robot: Robot, system: System) -> Array:
    """q_a (…, m): lengths and angles (−π, π] of the actuated joints, in the order of Γ."""
    parts = []
    for leg in system.legs:
        q = [joint_position(leg, j) for j in leg.group.actuated]
        by_leg = stack(q) if q else leg.qd[..., :0]
        parts.append(merged(by_leg))
    return join([np.zeros(0), *parts])[..., robot.force_order]


def joint_position(leg: LegTerms, j: int) -> Array:
    """q_j (…, L) of the legs of a group."""
    if leg.group.chain.sigma[j]:
        return leg.joints.length[..., j]
    return np.arctan2(leg.joints.sin[..., j], leg.joints.cos[..., j])


def joint_accelerations(leg: LegTerms, forces: Array, f: Array) -> Array:
    """q̈ (…, L, n) of a group from its actuator forces (…, L, m_i) and tip forces (…, L, 3t)."""
    driving = mv(selection(leg.group), forces) - mtv(leg.J, f) - leg.c
    return solve_definite(leg.A, driving[..., None])[..., 0]  # Eq. 7


def diagonal(blocks: list[Array]) -> Array:
    """Blocks of different shapes on the diagonal of one matrix."""
    out = np.zeros((0, 0))
    for part in blocks:
        batch = np.broadcast_shapes(out.shape[:-2], part.shape[:-2])
        out, part = (np.broadcast_to(a, batch + a.shape[-2:]) for a in (out, part))
        (r, c), (s, d) = out.shape[-2:], part.shape[-2:]
        upper = np.concatenate([out, np.zeros(batch + (r, d))], axis=-1)
        lower = np.concatenate([np.zeros(batch + (s, c)), part], axis=-1)
        out = np.concatenate([upper, lower], axis=-2)
    return out
