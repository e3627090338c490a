"""Derivatives of the equations of the legs by the state, at fixed accelerations and contact forces."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, join, merged, mtv, mv, skew, split, stack, transpose
from parflex.base.dual import jacobian
from parflex.mechanics import chain, joint_forces, recursion
from parflex.mechanics.chain import Frames, Point
from parflex.mechanics.floor import Ground, ground, under_legs
from parflex.mechanics.leg_terms import Apart, LegTerms, flexed, leg_response, rates_of
from parflex.mechanics.legs.alike import each_leg
from parflex.mechanics.legs.base import LegGroup
from parflex.mechanics.system import System, sections_by_group
from parflex.robot.layout import Coordinates


class LegTangent(NamedTuple):
    """Changes of L legs with t tips whose state carries s coordinates each, at fixed z̈ and contact forces.

    Rows (3t + s) are ∂(J z̈ + J̇ż) − J A⁻¹ r_2, resolved in Σp, and those of −A⁻¹ r_2 that belong to carried
    coordinates, with r_2 = ∂(A z̈ + c + Jᵀ f).
    """

    by_tips: Array  # (…, L, 3t + s, d), by motions of the tips as `tip_motions.leg_by_leg` has them
    own: Array  # (…, L, 3t + s, 2 s), by carried coordinates and their rates
    held_by_tips: Array  # (…, L, 3t[ + 3t], d), moments of flexures on the platform and forces of soft tips
    held_own: Array  # (…, L, 3t[ + 3t], 2 s); all in Σp, and no rows without flexures
    mobility: Array  # (…, L, 3t + s, 3t), [J; those rows of 1] A⁻¹ Jᵀ


def seen(leg: LegTerms) -> Array:
    """[J; rows of 1] A⁻¹ (…, L, 3t + s, z): what generalised forces give to the tips, and to carried
    coordinates."""
    rows = np.eye(leg.group.chain.size)[list(leg.group.kept)]
    both = np.concatenate([leg.J, np.broadcast_to(rows, leg.J.shape[:-2] + rows.shape)], axis=-2)
    return transpose(leg_response(leg.group, leg.A, transpose(both)))


def leg_tangent(
    system: System, leg: LegTerms, section: Array, mobile: Array, zdd: Array, f: Array
) -> LegTangent:
    """The legs of a group with accelerations z̈ (…, L, z) under contact forces f (…, L, t, 3) in Σp.

    section (…, L, t, 12) is of the platform, mobile (…, L, 3t + s, z) as of `seen`.
    """
    group = leg.group
    z, rows, s = group.chain.size, 3 * len(group.tip_frames), len(group.kept)
    found = residual_tangent(system, leg, section, zdd, mv(leg.R_ip, f))
    R_pi = transpose(leg.R_ip[..., 0, :, :])
    reached = blockwise(R_pi, found[..., z : z + rows, :])
    kept = np.zeros((*reached.shape[:-2], s, reached.shape[-1]))
    H = np.concatenate([reached, kept], axis=-2) - mobile @ found[..., :z, :]
    held = blockwise(R_pi, found[..., z + rows :, :])
    seeds = H.shape[-1] - 2 * s
    by_tips = (transpose(blockwise(R_pi, transpose(part[..., :seeds]))) for part in (H, held))
    own = (part[..., seeds:] for part in (H, held))
    (H, held), (H_own, held_own) = by_tips, own
    return LegTangent(H, H_own, held, held_own, mobile @ transpose(leg.J))


class Seeds(NamedTuple):
    """The arguments of the equations of the legs, all in Σ0i: places and velocities (…, L, t, 3) of the tips,
    which legs that carry their joints read for soft tips only; small turns and angular velocities
    (…, L, t, 3) of the platform's sections, which only flexures read; and the carried coordinates with their
    rates."""

    place: Array
    velocity: Array
    turn: Array
    spin: Array
    s: Array
    sd: Array


def seeds_of(group: LegGroup, flat: Array) -> Seeds:
    """The parts of seeds (…, L, d) that stand side by side."""
    t, s = len(group.tip_frames), len(group.kept)
    tips, held = (t if group.reads_tips else 0, 3), (0 if group.flexures is None else t, 3)
    return Seeds(*split(flat, [tips, tips, held, held, (s,), (s,)]))


def leg_seeds(leg: LegTerms, x: Coordinates, section: Array) -> Array:
    """The arguments (…, L, d) of `leg_residual` at a state, for sections (…, L, t, 12) of the platform."""
    group, parts = leg.group, []
    if group.reads_tips:
        parts += [merged(leg.place), merged(leg.velocity)]
    if group.flexures is not None:
        spin = mv(leg.R_ip, section[..., 9:])
        parts += [merged(0.0 * spin), merged(spin)]
    return join([*parts, x.s[..., group.carried], x.sd[..., group.carried]])


def axes_of(leg: LegTerms, section: Array) -> Array:
    """The axes (…, L, 9t) in Σ0i of the platform's sections (…, L, t, 12); (…, L, 0) without flexures."""
    if leg.group.flexures is None:
        return leg.place[..., 0, :0]
    C = leg.R_ip @ section[..., :9].reshape((*section.shape[:-1], 3, 3))
    return merged(merged(C))


def residual_tangent(system: System, leg: LegTerms, section: Array, zdd: Array, force: Array) -> Array:
    """∂ of `leg_residual` by its seeds, (…, L, z + 3t[ + 3t[ + 3t]], d), under forces (…, L, t, 3) in Σ0i."""
    push = (len(leg.group.tip_frames), 3)

    def tangent(group: LegGroup, *given: Array) -> Array:
        seeds, zdd, force, branch, axes, *ground = given
        group, force = group.on(branch), force.reshape(force.shape[:-1] + push)
        local = under_legs(group, *ground)
        return jacobian(lambda x: leg_residual(group, x, zdd, force, axes, local), seeds)

    rows = [leg_seeds(leg, system.x, section), zdd, merged(force), leg.branch, axes_of(leg, section)]
    floor = ground(system.mechanism.base, system.mechanism.gravity)
    found: Array = each_leg(leg.group, tangent, rows, floor)
    return found


def leg_residual(
    group: LegGroup, seeds: Array, zdd: Array, force: Array, axes: Array, ground: Ground
) -> Array:
    """(A z̈ + c + Jᵀ f, J z̈ + J̇ż, moments of flexures and forces of soft tips on the platform): (…, L, z + 3t
    [ + 3t[ + 3t]]) in Σ0i.

    seeds as in `Seeds`, side by side; force (…, L, t, 3), axes (…, L, 9t) of the platform's sections where
    there are flexures; all in Σ0i. The accelerations of the tips are those less gravity.
    """
    c, at = group.chain, seeds_of(group, seeds)
    joints = group.type.joints(group, at.place, at.s)
    frames, tips = chain.frames(c, joints), group.points(joints.bend)
    several = any(c.modes) or any(group.soft)
    J = [chain.tip_jacobian(c, frames, tip) for tip in tips] if several else []
    zd = rates_of(group, frames, joints, J, at.place, at.velocity, at.sd)
    motions = recursion.link_motions(c, frames, zd, zdd, ground.motion)
    loads, accelerations = recursion.unloaded(c), []
    for t, tip in enumerate(tips):
        R = frames.R_0j[tip.link]
        recursion.with_push(loads, tip, mtv(R, force[..., t, :]))
        accelerations.append(mv(R, recursion.tip_acceleration(c, motions, tip, zd, zdd)))
    torque = recursion.inverse_dynamics(c, frames, motions, zd, zdd, loads)
    torque = torque + joint_forces.passive(c, joints, zd)
    if group.flexures is None:
        return join([torque, *accelerations])
    C = axes.reshape((*axes.shape[:-1], len(tips), 3, 3))
    section = join([merged(C + skew(at.turn) @ C), at.spin])
    apart = apart_of(frames, tips, J, zd, at)
    turning, held = flexed(group, frames, tips, zd, np.eye(3), merged(section), apart)
    if not any(group.soft):
        return join([torque + turning, *accelerations, merged(held.moment)])
    torque = torque + turning + mtv(apart.J, merged(held.pull))
    return join([torque, *accelerations, merged(held.moment), merged(held.pull)])


def apart_of(frames: Frames, tips: Sequence[Point], J: list[Array], zd: Array, at: Seeds) -> Apart:
    """The tips against the platform's points, in Σ0i; nothing of legs that do not read where those are."""
    if not (J and at.place.shape[-2]):
        return Apart(*[zd[..., :0]] * 3)
    places = stack([chain.tip_position(frames, tip) for tip in tips], axis=-2)
    every = np.concatenate(J, axis=-2)
    return Apart(every, merged(places - at.place), mv(every, zd) - merged(at.velocity))


def sections_of(system: System) -> list[Array]:
    """The platform's sections (…, L, t, 12) at the tips, group by group."""
    return sections_by_group(system.mechanism, system.sections, system.seen)


def blockwise(R: Array, a: Array) -> Array:
    """R (…, 3, 3) times each three rows of a (…, 3 r, c)."""
    parts = a.reshape(a.shape[:-2] + (a.shape[-2] // 3, 3, a.shape[-1]))
    turned = R[..., None, :, :] @ parts
    return turned.reshape(turned.shape[:-3] + a.shape[-2:])
