"""Legs, platform and closure at one state, ready for the models."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, block_diagonal, cross, join, merged, mtv, mv, stack, transpose
from parflex.base.unroll import solve_definite, solve_least_norm
from parflex.mechanics import chain, kinematics
from parflex.mechanics.chain import Frames
from parflex.mechanics.kinematics import PointMotion
from parflex.mechanics.legs.alike import leg_by_leg
from parflex.mechanics.legs.base import MARGINS, LegGroup
from parflex.mechanics.platform import PlatformTerms, platform_terms
from parflex.robot.layout import Coordinates, coordinates
from parflex.robot.robot import Robot


class LegTerms(NamedTuple):
    """The model of the L legs of a group: A q̈ + c = S Γ − Jᵀ f; J, J̇q̇ and gaps resolved in Σp."""

    group: LegGroup
    joints: chain.Joints
    frames: Frames
    qd: Array  # (…, L, n)
    A: Array  # (…, L, n, n)
    c: Array  # (…, L, n)
    J: Array  # (…, L, 3t, n)
    Jdqd: Array  # (…, L, 3t)
    gap: Array  # (…, L, 3t), from the platform's points to the tips; zero for closed legs
    gap_rate: Array  # (…, L, 3t)
    margins: tuple[Array, Array]  # (…, L)
    R_ip: Array  # (…, L, 1, 3, 3), axes of Σp in Σ0i
    place: Array  # (…, L, t, 3), where the platform has the tips, in Σ0i
    velocity: Array  # (…, L, t, 3)


class System(NamedTuple):
    """Everything at one state; legs' tips in the order of the groups."""

    x: Coordinates
    legs: list[LegTerms]
    points: PointMotion  # of the attachments that are held
    shapes: Array  # (k, 3, N), theirs
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
    places = by_group(robot, kinematics.position_in_world(points.r, x))
    moved = zip(robot.groups, places, by_group(robot, points.v), strict=True)
    legs = [leg_terms(robot, group, x, place, v) for group, place, v in moved]
    return System(x, legs, points, shapes, W_p, W_e, platform)


def assembled(robot: Robot, x: Array) -> System:
    """As `assemble`, at a flat state (…, size)."""
    return assemble(robot, coordinates(x, robot.layout))


def examined(robot: Robot, x: Array) -> tuple[System, Array]:
    """As `assembled`, with its `health`, where a flat state may be none: quietly not a number there."""
    with np.errstate(invalid="ignore", divide="ignore"):
        system = assembled(robot, x)
        return system, health(system)


def by_group(robot: Robot, vectors: Array) -> list[Array]:
    """Vectors (…, k, c) of all tips as one (…, L, t, c) per group."""
    ends = pairwise(np.cumsum([0, *(group.attachments.size for group in robot.groups)]))
    return [
        vectors[..., first:last, :].reshape(vectors.shape[:-2] + group.attachments.shape + vectors.shape[-1:])
        for group, (first, last) in zip(robot.groups, ends, strict=True)
    ]


def leg_terms(robot: Robot, group: LegGroup, x: Coordinates, place: Array, v: Array) -> LegTerms:
    """The legs of a group, moved by their tips (…, L, t, 3): places in Σ0, velocities in Σp."""
    n, t = group.chain.n, len(group.tip_frames)
    joint, frame = [(n,)] * 3, [(3, 3)] * n + [(3,)] * n
    shapes = [*joint, *frame, *frame, (n,), (n, n), (n,), (3 * t, n), *[(3 * t,)] * 3, (), (), (1, 3, 3)]
    rows = [merged(place), merged(v), x.q[..., group.carried], x.qd[..., group.carried]]
    shared = [x.rotation, np.asarray(robot.gravity)]
    found = leg_by_leg(group, terms_of, rows, shared, [*shapes, (t, 3), (t, 3)])
    joints, frames, rest = found[:3], found[3 : 3 + 4 * n], found[3 + 4 * n :]
    qd, A, c, J, Jdqd, gap, gap_rate, reach, regularity, *tips = rest
    by_joint = Frames(*(frames[i * n : (i + 1) * n] for i in range(4)))
    margins = (reach, regularity)
    return LegTerms(group, chain.Joints(*joints), by_joint, qd, A, c, J, Jdqd, gap, gap_rate, margins, *tips)


def terms_of(
    group: LegGroup, place: Array, v: Array, q: Array, qd: Array, rotation: Array, gravity: Array
) -> list[Array]:
    """The fields of `LegTerms` in one list; place, v (…, L, 3t), rotation (…, 3, 3), gravity in Σ0."""
    points = place.shape[:-1] + (len(group.tip_frames), 3)
    R_i0 = transpose(group.rotation)[:, None]
    R_ip = R_i0 @ rotation[..., None, None, :, :]
    place = mv(R_i0, place.reshape(points) - group.origin[:, None])
    velocity = mv(R_ip, v.reshape(points))
    joints = group.type.joints(group, place, q)
    frames = chain.frames(group.chain, joints)
    qd = group.type.rates(group, frames, joints, place, velocity, qd)
    rest = np.zeros(group.chain.n)
    gravity = mtv(group.rotation, gravity)
    motions = chain.link_motions(group.chain, frames, qd, rest, gravity)
    R_pi = transpose(R_ip[..., 0, :, :])
    J, Jdqd, gap = [], [], []
    for t, j in enumerate(group.tip_frames):
        offset, (omega, omegad, vd) = group.offsets[:, t], motions[j]
        acceleration = mv(frames.R_0j[j], vd + chain.point_acceleration(omega, omegad, offset))
        J.append(R_pi @ chain.tip_jacobian(group.chain, frames, j, offset))  # Eqs. 1, 3
        Jdqd.append(mv(R_pi, acceleration + gravity))
        gap.append(mv(R_pi, chain.tip_position(frames, j, offset) - place[..., t, :]))
    by_tip = np.concatenate(J, axis=-2)
    A = chain.inertia_matrix(group.chain, frames)
    c = chain.inverse_dynamics(group.chain, frames, motions, rest) + chain.friction(group.chain, qd)
    c = c + group.chain.k * chain.stretch(group.chain, joints)
    gaps = np.concatenate(gap, axis=-1), mv(by_tip, qd) - v
    margins = group.type.margins(group, joints, place)
    by_joint = [part for parts in frames for part in parts]
    moved = [qd, A, c, by_tip, np.concatenate(Jdqd, axis=-1), *gaps]
    return [*joints, *by_joint, *moved, *margins, R_ip, place, velocity]


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


def health(system: System) -> Array:
    """What tells whether the state is one: reach and regularity of all legs, in the order of the
    groups, then gaps and their rates at the tips of the legs that do not close by themselves."""
    parts = [np.zeros(0)]
    for leg in system.legs:
        parts += leg.margins
    for leg in system.legs:
        if not leg.group.closed:
            parts += [merged(leg.gap), merged(leg.gap_rate)]
    return join(parts)


def health_size(robot: Robot) -> int:
    """Length of `health`."""
    gaps = sum(6 * group.attachments.size for group in robot.groups if not group.closed)
    return MARGINS * len(robot.legs) + gaps


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
    """q_j (…, L) of the legs of a group; angles in (−π, π]."""
    return chain.joint_position(leg.group.chain, leg.joints, j, np.zeros(len(leg.group.legs)))


def joint_accelerations(robot: Robot, system: System, forces: Array, f: Array) -> list[Array]:
    """q̈ (…, L, n) of each group from all actuator forces (…, m) and contact forces (…, 3k)."""
    found = []
    for leg, pull in zip(system.legs, joint_pulls(robot, system, f), strict=True):
        driving = mv(selection(leg.group), forces[..., leg.group.forces]) - pull - leg.c
        found.append(solve_definite(leg.A, driving[..., None])[..., 0])  # Eq. 7
    return found


def joint_pulls(robot: Robot, system: System, f: Array) -> list[Array]:
    """Jᵀ f (…, L, n) of each group: what contact forces (…, 3k) ask of its joints."""
    tips = by_group(robot, kinematics.unstacked(f))
    return [mtv(leg.J, merged(pull)) for leg, pull in zip(system.legs, tips, strict=True)]


def joint_reactions(robot: Robot, system: System, qdd: list[Array], f: Array) -> list[tuple[Array, Array]]:
    """Force and moment (…, L, n, 3) that links receive through their joints, in their own axes."""
    found = []
    tips = by_group(robot, kinematics.unstacked(f))
    for leg, acceleration, pull in zip(system.legs, qdd, tips, strict=True):
        group = leg.group
        gravity = mtv(group.rotation, np.asarray(robot.gravity))
        motions = chain.link_motions(group.chain, leg.frames, leg.qd, acceleration, gravity)
        force: list[Array] = [np.zeros(3)] * group.chain.n
        moment = list(force)
        R_ip = transpose(group.rotation) @ system.x.rotation[..., None, :, :]
        for t, j in enumerate(group.tip_frames):
            push = mtv(leg.frames.R_0j[j], mv(R_ip, pull[..., t, :]))
            force[j], moment[j] = force[j] + push, moment[j] + cross(group.offsets[:, t], push)
        passed = chain.reactions(group.chain, leg.frames, motions, chain.Reaction(force, moment))
        found.append((stack(passed.force, axis=-2), stack(passed.moment, axis=-2)))
    return found


def carried_accelerations(robot: Robot, system: System, forces: Array, f: Array) -> Array:
    """q̈ (…, n) of the joints that the state carries, in its order."""
    return in_carried_order(robot, system, joint_accelerations(robot, system, forces, f))


def carried_pull(robot: Robot, system: System, f: Array) -> Array:
    """A⁻¹ Jᵀ f (…, n) of the joints that the state carries: what contact forces (…, 3k) do to them."""
    pulls = zip(system.legs, joint_pulls(robot, system, f), strict=True)
    moved = [solve_definite(leg.A, pull[..., None])[..., 0] for leg, pull in pulls]
    return in_carried_order(robot, system, moved)


def in_carried_order(robot: Robot, system: System, joints: list[Array]) -> Array:
    """Of joints (…, L, n) by group, those that the state carries, in its order."""
    parts = [merged(q) for leg, q in zip(system.legs, joints, strict=True) if leg.group.type.carries]
    return join([np.zeros(0), *parts])[..., robot.carried_order]


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
