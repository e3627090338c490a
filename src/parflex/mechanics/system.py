"""Legs, platform and closure at one state, ready for the models."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from parflex.base.array import (
    Array,
    block,
    block_diagonal,
    dot,
    join,
    merged,
    mtv,
    mv,
    stack,
    transpose,
)
from parflex.base.unroll import solve_least_norm
from parflex.mechanics import floor, kinematics, recursion
from parflex.mechanics.flexures import Sections, sections, unturned
from parflex.mechanics.kinematics import PointMotion
from parflex.mechanics.leg_terms import (
    LegTerms,
    leg_response,
    leg_terms,
    motor_positions,
    of_motors,
)
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.platform import PlatformTerms, platform_terms
from parflex.robot.layout import Coordinates, coordinates


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
    sections: Sections  # of the attachments that are held, where there are flexures
    seen: floor.Seen  # the platform at its attachments, from the base


def assemble(mechanism: Mechanism, x: Coordinates) -> System:
    """Legs, platform and closure at a state."""
    body, held = mechanism.platform.body, mechanism.attachments
    shapes = body.attachment_shapes[held]
    points = kinematics.point_motion(body.attachment_points[held], shapes, x)
    W_p, W_e = kinematics.wrench_map(points.r, shapes)
    gravity_p = mtv(x.rotation, mechanism.gravity)
    platform = platform_terms(mechanism.platform, x.twist[..., 3:], x.elastic, x.elastic_rate, gravity_p)
    turned = unturned(len(held), body.modes)
    if mechanism.flexed:
        turned = sections(body.attachment_turns[held], x.twist[..., 3:], x.elastic, x.elastic_rate)
    places = kinematics.position_in_world(points.r, x)
    seen = floor.seen_from(mechanism.base, floor.Seen(x.rotation, places, points.v, turned.spin))
    of_tips = (by_group(mechanism, seen.places), by_group(mechanism, seen.velocities))
    moved = zip(mechanism.groups, *of_tips, sections_by_group(mechanism, turned, seen), strict=True)
    there, ground = x._replace(rotation=seen.rotation), floor.ground(mechanism.base, mechanism.gravity)
    legs = [leg_terms(group, there, ground, place, v, own) for group, place, v, own in moved]
    platform = with_moments(platform, mechanism, legs, turned)
    system = System(mechanism, x, legs, points, shapes, W_p, W_e, platform, turned, seen)
    return with_pulls(system) if mechanism.soft else system


def sections_by_group(mechanism: Mechanism, turned: Sections, seen: floor.Seen) -> list[Array]:
    """Axes and angular velocities (…, L, t, 12) of the platform's sections as they are seen from the base,
    group by group."""
    return by_group(mechanism, join([merged(turned.turn), seen.spins]))


def with_moments(
    platform: PlatformTerms, mechanism: Mechanism, legs: list[LegTerms], turned: Sections
) -> PlatformTerms:
    """The platform's terms with the moments of the flexures at its tips."""
    if not mechanism.flexed:
        return platform
    m = tip_moments(legs)
    modal = np.sum(mtv(turned.tilt, m), axis=-2)
    still = np.zeros(3)
    return platform._replace(c_r=platform.c_r - join([still, np.sum(m, axis=-2)]), c_e=platform.c_e - modal)


def tip_moments(legs: list[LegTerms]) -> Array:
    """The moments (…, k, 3) of flexures at all tips on the platform, in Σp; zero where a tip has none."""
    return at_tips([leg.flexed.moment if leg.group.flexures else 0.0 * leg.place for leg in legs])


def soft_pulls(legs: list[LegTerms]) -> Array:
    """The forces (…, k, 3) of soft tips on the platform, in Σp, each where the tip is; zero of other tips."""
    return at_tips([leg.flexed.pull if any(leg.group.soft) else 0.0 * leg.place for leg in legs])


def at_tips(parts: list[Array]) -> Array:
    """Vectors (…, L, t, 3) of each group as those of all tips (…, k, 3)."""
    return np.concatenate([part.reshape(part.shape[:-3] + (-1, 3)) for part in parts], axis=-2)


def with_pulls(system: System) -> System:
    """The system whose platform is pulled by its soft tips; the legs' terms have their part."""
    platform, pull = system.platform, merged(soft_pulls(system.legs))
    c_r, c_e = platform.c_r - mv(system.W_p, pull), platform.c_e - mv(system.W_e, pull)
    return system._replace(platform=platform._replace(c_r=c_r, c_e=c_e))


def tip_forces(system: System, f: Array) -> Array:
    """The forces (…, 3k) of all tips on the platform, of contact forces f (…, 3k), which are those that the
    closure takes and zero at soft tips."""
    return f + merged(soft_pulls(system.legs)) if system.mechanism.soft else f


def closing_forces(system: System, forces: Array) -> Array:
    """The contact forces (…, 3k) that the closure takes, of those of all tips; `tip_forces` undone."""
    return forces - merged(soft_pulls(system.legs)) if system.mechanism.soft else forces


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


def actuated_axes(system: System) -> Array:
    """∂q_a/∂p (…, 3k, m): rows of the legs' J⁻¹, for a slider its unit axis a_3i."""
    parts = []
    for leg in system.legs:
        rows = transpose(leg.J)
        unit = leg.group.S.T
        axes = [solve_least_norm(rows, np.broadcast_to(u, rows.shape[:-1])) for u in unit]
        parts.append(block_diagonal(stack(axes) if axes else leg.J[..., :0]))
    return diagonal(parts)[..., system.mechanism.force_order]


def health(system: System) -> Array:
    """Reach and regularity of all legs, how far flexures are open, gaps and their rates at tips of legs that
    do not close by themselves.

    They tell whether the state is one, and stand where `mechanism.health` says.
    """
    at, legs = system.mechanism.health, system.legs
    tips = [leg for leg in legs if not leg.group.closed]
    reach, regularity, opening, gap, gap_rate = (
        join([np.zeros(0), *parts])
        for parts in (
            [leg.reach for leg in legs],
            [leg.regularity for leg in legs],
            [merged(leg.flexed.open) for leg in legs],
            [merged(leg.gap[..., leg.group.firm]) for leg in tips],
            [merged(leg.gap_rate[..., leg.group.firm]) for leg in tips],
        )
    )
    by_leg, by_gap, opening = at.leg_order, at.gap_order, opening[..., at.open_order]
    of_legs = (reach[..., by_leg], regularity[..., by_leg], opening)
    return join([*of_legs, gap[..., by_gap], gap_rate[..., by_gap]])


def joint_rates(system: System) -> Array:
    """θ̇ (…, m) of the motors, in the order of Γ: q̇ of the actuated joints where no drive gives."""
    return actuated(system, [leg.zd for leg in system.legs])


def actuated(system: System, joints: list[Array]) -> Array:
    """Sᵀ z (…, m), what the motors have in the order of Γ, of all coordinates (…, L, z) by group."""
    pairs = zip(system.legs, joints, strict=True)
    flat = [merged(of_motors(leg.group, each)) for leg, each in pairs]
    return join([np.zeros(0), *flat])[..., system.mechanism.force_order]


def actuated_positions(system: System) -> Array:
    """θ (…, m): lengths and angles of the motors, in the order of Γ; q of the actuated joints, angles in
    (−π, π], where no drive gives."""
    parts = [merged(motor_positions(leg)) for leg in system.legs]
    return join([np.zeros(0), *parts])[..., system.mechanism.force_order]


def leg_accelerations(system: System, forces: Array, f: Array) -> list[Array]:
    """z̈ (…, L, z) of each group from all actuator forces (…, m) and contact forces (…, 3k)."""
    found = []
    for leg, pull in zip(system.legs, leg_pulls(system, f), strict=True):
        driving = mv(leg.group.S, forces[..., leg.group.forces]) - pull - leg.c
        found.append(leg_response(leg.group, leg.A, driving[..., None])[..., 0])  # Eq. 7
    return found


def leg_pulls(system: System, f: Array) -> list[Array]:
    """Jᵀ f (…, L, z) of each group: the generalised forces of the contact forces (…, 3k)."""
    tips = by_group(system.mechanism, kinematics.unstacked(f))
    return [mtv(leg.J, merged(pull)) for leg, pull in zip(system.legs, tips, strict=True)]


def joint_reactions(system: System, zdd: list[Array], f: Array) -> list[tuple[Array, Array]]:
    """Force and moment (…, L, n, 3) that links receive through their joints, in their own axes."""
    pairs = zip(system.legs, zdd, reactions(system, zdd, f), strict=True)
    return [(by_link(found.force, leg, z), by_link(found.moment, leg, z)) for leg, z, found in pairs]


def floor_power(system: System, zdd: list[Array], f: Array) -> Array:
    """The power (…,) W that the motion of the base gives to the robot: of what legs receive from below."""
    given, base = np.zeros(system.x.position.shape[:-1]), system.mechanism.base
    if base is None:
        return given
    for leg, found in zip(system.legs, reactions(system, zdd, f), strict=True):
        v, omega = floor.twist_of_legs(base, leg.group)
        given = given + np.sum(dot(found.force[-1], v) + dot(found.moment[-1], omega), axis=-1)
    return given


def reactions(system: System, zdd: list[Array], f: Array) -> list[recursion.Reaction]:
    """The wrenches that links of each group receive at accelerations (…, L, z) and contact forces (…, 3k) of
    the closure."""
    found, ground = [], floor.ground(system.mechanism.base, system.mechanism.gravity)
    tips = by_group(system.mechanism, kinematics.unstacked(tip_forces(system, f)))
    for leg, acceleration, pull in zip(system.legs, zdd, tips, strict=True):
        group, c, frames = leg.group, leg.group.chain, leg.bent
        base = floor.under_legs(group, *ground).motion
        motions = recursion.link_motions(c, frames, leg.zd, acceleration, base)
        loads = recursion.unloaded(c)
        for t, tip in enumerate(group.points(leg.joints.bend)):
            R = transpose(frames.R_0j[tip.link]) @ leg.R_ip[..., 0, :, :]
            turn = mv(R, leg.twist[..., t, :]) if group.flexures is not None else None
            recursion.with_push(loads, tip, mv(R, pull[..., t, :]), turn)
        found.append(recursion.reactions(c, frames, motions, leg.zd, acceleration, loads))
    return found


def by_link(vectors: list[Array], leg: LegTerms, zdd: Array) -> Array:
    """Vectors (…, L, 3) of the links, less the last, which is the base: (…, L, n, 3), at z̈ (…, L, z)."""
    links = block([[np.zeros((0, 3))], *([vector[..., None, :]] for vector in vectors[:-1])])
    return np.broadcast_to(links, (*zdd.shape[:-1], leg.group.chain.n, 3))


def carried_accelerations(system: System, forces: Array, f: Array) -> Array:
    """The accelerations (…, n) of the coordinates that the state carries, in its order."""
    return in_carried_order(system, leg_accelerations(system, forces, f))


def carried_pull(system: System, f: Array) -> Array:
    """A⁻¹ Jᵀ f (…, n): the accelerations that contact forces (…, 3k) give to the coordinates that the state
    carries."""
    pulls = zip(system.legs, leg_pulls(system, f), strict=True)
    moved = [leg_response(leg.group, leg.A, pull[..., None])[..., 0] for leg, pull in pulls]
    return in_carried_order(system, moved)


def in_carried_order(system: System, z: list[Array]) -> Array:
    """The coordinates (…, n) that the state carries, in its order, of all of them (…, L, z) by group."""
    return join([np.zeros(0), *(merged(part) for part in z)])[..., system.mechanism.kept]


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
