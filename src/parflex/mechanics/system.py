"""Legs, platform and closure at one state, ready for the models."""

from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from parflex.base.array import Array, block, block_diagonal, cross, join, merged, mtv, mv, stack, transpose
from parflex.base.unroll import solve_definite, solve_least_norm
from parflex.mechanics import chain, kinematics
from parflex.mechanics.chain import Frames
from parflex.mechanics.kinematics import PointMotion
from parflex.mechanics.legs.alike import each_leg
from parflex.mechanics.legs.base import LegGroup
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.platform import PlatformTerms, platform_terms
from parflex.robot.layout import Coordinates, coordinates

EMPTY: Any = ()  # a tree without arrays


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
    reach: Array  # (…, L), of order 1; not positive where the leg cannot reach its tips
    regularity: Array  # (…, L), of order 1; zero where the inverse geometry is singular
    branch: Array  # (…, L, 1), ±1 as the state has it; (…, L, 0) where the branch is fixed
    R_ip: Array  # (…, L, 1, 3, 3), axes of Σp in Σ0i
    place: Array  # (…, L, t, 3), where the platform has the tips, in Σ0i
    velocity: Array  # (…, L, t, 3)


class System(NamedTuple):
    """Everything at one state; legs and tips group by group."""

    mechanism: Mechanism
    x: Coordinates
    legs: list[LegTerms]
    points: PointMotion  # of the attachments that are held
    shapes: Array  # (k, 3, N), theirs
    W_p: Array  # (…, 6, 3k)
    W_e: Array  # (N, 3k)
    platform: PlatformTerms


def assemble(mechanism: Mechanism, x: Coordinates) -> System:
    """Legs, platform and closure at a state."""
    body, held = mechanism.platform.body, mechanism.attachments
    shapes = body.attachment_shapes[held]
    points = kinematics.point_motion(body.attachment_points[held], shapes, x)
    W_p, W_e = kinematics.wrench_map(points.r, shapes)
    gravity_p = mtv(x.rotation, mechanism.gravity)
    platform = platform_terms(mechanism.platform, x.twist[..., 3:], x.elastic, x.elastic_rate, gravity_p)
    places = by_group(mechanism, kinematics.position_in_world(points.r, x))
    moved = zip(mechanism.groups, places, by_group(mechanism, points.v), strict=True)
    legs = [leg_terms(mechanism, group, x, place, v) for group, place, v in moved]
    return System(mechanism, x, legs, points, shapes, W_p, W_e, platform)


def assembled(mechanism: Mechanism, x: Array) -> System:
    """The system at a flat state (…, size)."""
    return assemble(mechanism, coordinates(x, mechanism.layout))


def examined(mechanism: Mechanism, x: Array) -> tuple[System, Array]:
    """The system at a flat state and its `health`, with NaN and no warning where a leg has no answer."""
    with np.errstate(invalid="ignore", divide="ignore"):
        system = assembled(mechanism, x)
        return system, health(system)


def by_group(mechanism: Mechanism, vectors: Array) -> list[Array]:
    """Vectors (…, k, c) of all tips as one (…, L, t, c) per group."""
    ends = pairwise(np.cumsum([0, *(group.attachments.size for group in mechanism.groups)]))
    return [
        vectors[..., first:last, :].reshape(vectors.shape[:-2] + group.attachments.shape + vectors.shape[-1:])
        for group, (first, last) in zip(mechanism.groups, ends, strict=True)
    ]


def leg_terms(mechanism: Mechanism, group: LegGroup, x: Coordinates, place: Array, v: Array) -> LegTerms:
    """The legs of a group, moved by their tips (…, L, t, 3): places in Σ0, velocities in Σp."""
    own = [x.q[..., group.carried], x.qd[..., group.carried], x.branches[..., group.branched]]
    rows, shared = [merged(place), merged(v), *own], [x.rotation, mechanism.gravity]
    terms: LegTerms = each_leg(group, terms_of, rows, shared)
    return terms._replace(group=group)


def terms_of(
    group: LegGroup,
    place: Array,
    v: Array,
    q: Array,
    qd: Array,
    branch: Array,
    rotation: Array,
    gravity: Array,
) -> LegTerms:
    """The terms of legs whose tips have places and velocities (…, L, 3t) in Σ0 and in Σp; gravity in Σ0.

    Joints and branch are those that the state carries. The group of the terms is left empty.
    """
    group, n = group.on(branch), group.chain.n
    legs, points = place.shape[:-1], place.shape[:-1] + (len(group.tip_frames), 3)
    R_i0 = transpose(group.rotation)[:, None]
    R_ip = R_i0 @ rotation[..., None, None, :, :]
    place = mv(R_i0, place.reshape(points) - group.origin[:, None])
    velocity = mv(R_ip, v.reshape(points))
    joints = chain.Joints(*(np.broadcast_to(a, (*legs, n)) for a in group.type.joints(group, place, q)))
    frames = chain.frames(group.chain, joints)
    qd = np.broadcast_to(group.type.rates(group, frames, joints, place, velocity, qd), (*legs, n))
    rest, gravity = np.zeros(n), mtv(group.rotation, gravity)
    motions = chain.link_motions(group.chain, frames, qd, rest, gravity)
    J, Jdqd, gap = tips_of(group, frames, motions, gravity, R_ip, place)
    A = np.broadcast_to(chain.inertia_matrix(group.chain, frames), (*legs, n, n))
    c = chain.inverse_dynamics(group.chain, frames, motions, rest) + chain.friction(group.chain, qd)
    c = c + group.chain.k * chain.stretch(group.chain, joints)
    reach, regularity = (np.broadcast_to(a, legs) for a in group.type.margins(group, joints, place))
    moved = (qd, A, c, J, Jdqd, gap, mv(J, qd) - v, reach, regularity)
    return LegTerms(EMPTY, joints, frames, *moved, branch, R_ip, place, velocity)


def tips_of(
    group: LegGroup, frames: Frames, motions: list[chain.Motion], gravity: Array, R_ip: Array, place: Array
) -> tuple[Array, Array, Array]:
    """J (…, L, 3t, n), J̇q̇ and the gap (…, L, 3t) at the tips, in Σp; gravity and places are in Σ0i."""
    R_pi = transpose(R_ip[..., 0, :, :])
    J, Jdqd, gap = [], [], []
    for t, j in enumerate(group.tip_frames):
        offset, (omega, omegad, vd) = group.offsets[:, t], motions[j]
        acceleration = mv(frames.R_0j[j], vd + chain.point_acceleration(omega, omegad, offset))
        J.append(R_pi @ chain.tip_jacobian(group.chain, frames, j, offset))  # Eqs. 1, 3
        Jdqd.append(mv(R_pi, acceleration + gravity))
        gap.append(mv(R_pi, chain.tip_position(frames, j, offset) - place[..., t, :]))
    return np.concatenate(J, axis=-2), np.concatenate(Jdqd, axis=-1), np.concatenate(gap, axis=-1)


def selection(group: LegGroup) -> Array:
    """S (n, actuated): Γ_i = [0 0 Γ_3i]ᵀ for a leg that drives its third joint."""
    return np.eye(group.chain.n)[:, list(group.actuated)]  # Eq. 8


def actuated_axes(system: System) -> Array:
    """∂q_a/∂p (…, 3k, m): rows of the legs' J⁻¹, for a slider its unit axis a_3i."""
    parts = []
    for leg in system.legs:
        rows = transpose(leg.J)
        unit = selection(leg.group).T
        axes = [solve_least_norm(rows, np.broadcast_to(u, rows.shape[:-1])) for u in unit]
        parts.append(block_diagonal(stack(axes) if axes else leg.J[..., :0]))
    return diagonal(parts)[..., system.mechanism.force_order]


def health(system: System) -> Array:
    """Reach and regularity of all legs, gaps and their rates at tips of legs that do not close by themselves.

    They tell whether the state is one, and stand where `mechanism.health` says.
    """
    at, legs = system.mechanism.health, system.legs
    tips = [leg for leg in legs if not leg.group.closed]
    reach, regularity, gap, gap_rate = (
        join([np.zeros(0), *parts])
        for parts in (
            [leg.reach for leg in legs],
            [leg.regularity for leg in legs],
            [merged(leg.gap) for leg in tips],
            [merged(leg.gap_rate) for leg in tips],
        )
    )
    by_leg, by_gap = at.leg_order, at.gap_order
    return join([reach[..., by_leg], regularity[..., by_leg], gap[..., by_gap], gap_rate[..., by_gap]])


def joint_rates(system: System) -> Array:
    """q̇_a (…, m) of the actuated joints, in the order of Γ."""
    return actuated(system, [leg.qd for leg in system.legs])


def actuated(system: System, joints: list[Array]) -> Array:
    """The actuated ones (…, m), in the order of Γ, of all joints (…, L, n) by group."""
    pairs = zip(system.legs, joints, strict=True)
    flat = [merged(each[..., list(leg.group.actuated)]) for leg, each in pairs]
    return join([np.zeros(0), *flat])[..., system.mechanism.force_order]


def actuated_positions(system: System) -> Array:
    """q_a (…, m): lengths and angles (−π, π] of the actuated joints, in the order of Γ."""
    parts = []
    for leg in system.legs:
        q = [joint_position(leg, j) for j in leg.group.actuated]
        by_leg = stack(q) if q else leg.qd[..., :0]
        parts.append(merged(by_leg))
    return join([np.zeros(0), *parts])[..., system.mechanism.force_order]


def joint_position(leg: LegTerms, j: int) -> Array:
    """q_j (…, L) of the legs of a group; angles in (−π, π]."""
    return chain.joint_position(leg.group.chain, leg.joints, j, np.zeros(len(leg.group.legs)))


def joint_accelerations(system: System, forces: Array, f: Array) -> list[Array]:
    """q̈ (…, L, n) of each group from all actuator forces (…, m) and contact forces (…, 3k)."""
    found = []
    for leg, pull in zip(system.legs, joint_pulls(system, f), strict=True):
        driving = mv(selection(leg.group), forces[..., leg.group.forces]) - pull - leg.c
        found.append(solve_definite(leg.A, driving[..., None])[..., 0])  # Eq. 7
    return found


def joint_pulls(system: System, f: Array) -> list[Array]:
    """Jᵀ f (…, L, n) of each group: the joint forces of the contact forces (…, 3k)."""
    tips = by_group(system.mechanism, kinematics.unstacked(f))
    return [mtv(leg.J, merged(pull)) for leg, pull in zip(system.legs, tips, strict=True)]


def joint_reactions(system: System, qdd: list[Array], f: Array) -> list[tuple[Array, Array]]:
    """Force and moment (…, L, n, 3) that links receive through their joints, in their own axes."""
    found = []
    tips = by_group(system.mechanism, kinematics.unstacked(f))
    for leg, acceleration, pull in zip(system.legs, qdd, tips, strict=True):
        group = leg.group
        gravity = mtv(group.rotation, system.mechanism.gravity)
        motions = chain.link_motions(group.chain, leg.frames, leg.qd, acceleration, gravity)
        force, moment = chain.unloaded(group.chain)
        for t, j in enumerate(group.tip_frames):
            push = mtv(leg.frames.R_0j[j], mv(leg.R_ip[..., 0, :, :], pull[..., t, :]))
            force[j], moment[j] = force[j] + push, moment[j] + cross(group.offsets[:, t], push)
        passed = chain.reactions(group.chain, leg.frames, motions, chain.Reaction(force, moment))
        found.append((by_link(passed.force, acceleration), by_link(passed.moment, acceleration)))
    return found


def by_link(vectors: list[Array], like: Array) -> Array:
    """Vectors (…, L, 3) of the links, and last of the base, which is left out: (…, L, n, 3) for (…, L, n)."""
    links = block([[np.zeros((0, 3))], *([vector[..., None, :]] for vector in vectors[:-1])])
    return np.broadcast_to(links, (*like.shape, 3))


def carried_accelerations(system: System, forces: Array, f: Array) -> Array:
    """q̈ (…, n) of the joints that the state carries, in its order."""
    return in_carried_order(system, joint_accelerations(system, forces, f))


def carried_pull(system: System, f: Array) -> Array:
    """A⁻¹ Jᵀ f (…, n): the accelerations that contact forces (…, 3k) give to the joints that the state
    carries."""
    pulls = zip(system.legs, joint_pulls(system, f), strict=True)
    moved = [solve_definite(leg.A, pull[..., None])[..., 0] for leg, pull in pulls]
    return in_carried_order(system, moved)


def in_carried_order(system: System, joints: list[Array]) -> Array:
    """The joints (…, n) that the state carries, in its order, of all joints (…, L, n) by group."""
    parts = [merged(q) for leg, q in zip(system.legs, joints, strict=True) if leg.group.type.carries]
    return join([np.zeros(0), *parts])[..., system.mechanism.carried_order]


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
