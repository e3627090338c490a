"""The terms of the legs at a state: inertia, forces and Jacobians in their coordinates z = (q, e, δ)."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from parflex.base.array import Array, cross, join, merged, mtv, mv, split, stack, transpose
from parflex.base.unroll import solve_definite
from parflex.mechanics import chain, joint_forces, recursion
from parflex.mechanics.chain import Frames, Point
from parflex.mechanics.flexures import (
    bent_angle,
    from_rest,
    moments,
    openness,
    pulls,
    relative_spin,
    stretches,
)
from parflex.mechanics.floor import under_legs
from parflex.mechanics.inertia import inertia_matrix
from parflex.mechanics.legs.alike import each_leg
from parflex.mechanics.legs.base import LegGroup
from parflex.robot.layout import Coordinates

EMPTY: Any = ()  # a tree without arrays


class OfFlexures(NamedTuple):
    """The flexures at the tips of L legs: moments, forces and places; all (…, L, 0, c) without flexures,
    and the last three where no tip is soft."""

    bending: Array  # θ (…, L, t, 3)
    spin: Array  # ω (…, L, t, 3) of the legs' sections relative to the platform's, in the axes of these
    moment: Array  # (…, L, t, 3) on the platform at its points, in Σp
    open: Array  # (…, L, t), of order 1; not positive where a flexure is nearly turned about
    stretch: (
        Array  # g (…, L, t, 3) of soft tips, in the axes of the platform's sections; of others it is idle
    )
    stretch_rate: Array  # ġ
    pull: Array  # (…, L, t, 3) of soft tips on the platform, in Σp; it acts where the tip is


class LegTerms(NamedTuple):
    """The model of the L legs of a group in their coordinates z = (q, e, δ), joints, elastic coordinates
    and deflections of drives: A z̈ + c = S Γ − Jᵀ f; J, J̇ż and gaps resolved in Σp."""

    group: LegGroup
    joints: chain.Joints
    frames: Frames
    zd: Array  # (…, L, z)
    A: Array  # (…, L, z, z)
    c: Array  # (…, L, z)
    J: Array  # (…, L, 3t, z)
    Jdqd: Array  # (…, L, 3t)
    gap: Array  # (…, L, 3t), from the platform's points to the tips; zero for closed legs
    gap_rate: Array  # (…, L, 3t)
    reach: Array  # (…, L), of order 1; not positive where the leg cannot reach its tips
    regularity: Array  # (…, L), of order 1; zero where the inverse geometry is singular
    branch: Array  # (…, L, 1), ±1 as the state has it; (…, L, 0) where the branch is fixed
    R_ip: Array  # (…, L, 1, 3, 3), axes of Σp in Σ0i
    place: Array  # (…, L, t, 3), where the platform has the tips, in Σ0i
    velocity: Array  # (…, L, t, 3)
    flexed: OfFlexures

    @property
    def qd(self) -> Array:
        """Joint rates (…, L, n)."""
        return self.zd[..., : self.joints.cos.shape[-1]]

    @property
    def twist(self) -> Array:
        """The moments (…, L, t, 3) of the flexures on the platform that the tips themselves take, in Σp."""
        moment, pull = self.flexed.moment, self.flexed.pull
        if not any(self.group.soft):
            return moment
        return moment - cross(self.gap.reshape(pull.shape), pull)

    @property
    def bent(self) -> Frames:
        """The frames with seats and bodies of flexible links, which the terms do not keep."""
        return chain.frames(self.group.chain, self.joints)


def leg_terms(
    group: LegGroup, x: Coordinates, ground: Sequence[Array], place: Array, v: Array, section: Array
) -> LegTerms:
    """The legs of a group, moved by their tips (…, L, t, 3): places in Σ0, velocities in Σp.

    ground is that of `floor.ground`; sections (…, L, t, 12) are axes and angular velocities of the platform
    there. All, and the platform's rotation, are as they are seen from the base.
    """
    own = [x.s[..., group.carried], x.sd[..., group.carried], x.branches[..., group.branched]]
    held = merged(section) if group.flexures is not None else place[..., 0, :0]
    rows, shared = [merged(place), merged(v), *own, held], [x.rotation, *ground]
    terms: LegTerms = each_leg(group, terms_of, rows, shared)
    return terms._replace(group=group)


def terms_of(
    group: LegGroup,
    place: Array,
    v: Array,
    s: Array,
    sd: Array,
    branch: Array,
    section: Array,
    rotation: Array,
    *ground: Array,
) -> LegTerms:
    """The terms of legs whose tips have places and velocities (…, L, 3t) in Σ0 and in Σp, on a ground as of
    `floor.ground`.

    Carried coordinates and branch are those that the state has. The group of the terms is left empty.
    """
    group, c = group.on(branch), group.chain
    legs, points = place.shape[:-1], place.shape[:-1] + (len(group.tip_frames), 3)
    R_i0 = transpose(group.rotation)[:, None]
    R_ip = R_i0 @ rotation[..., None, None, :, :]
    place = mv(R_i0, place.reshape(points) - group.origin[:, None])
    velocity = mv(R_ip, v.reshape(points))
    joints = wide(group.type.joints(group, place, s), legs, c.n)
    frames, tips = chain.frames(c, joints), group.points(joints.bend)
    J = [chain.tip_jacobian(c, frames, tip) for tip in tips]  # Eqs. 1, 3
    zd = np.broadcast_to(rates_of(group, frames, joints, J, place, velocity, sd), (*legs, c.size))
    rest, floor = np.zeros(c.size), under_legs(group, *ground)
    motions = recursion.link_motions(c, frames, zd, rest, floor.motion)
    R_pi = transpose(R_ip[..., 0, :, :])
    Jdqd, gap = tips_of(group, frames, motions, tips, zd, floor.gravity, R_pi, place)
    J_p = np.concatenate([R_pi @ part for part in J], axis=-2)
    A = np.broadcast_to(inertia_matrix(c, frames), (*legs, c.size, c.size))
    bias = recursion.inverse_dynamics(c, frames, motions, zd, rest) + joint_forces.passive(c, joints, zd)
    gap_rate = mv(J_p, zd) - v
    none = place[..., :0, :]
    of_flexures = OfFlexures(none, none, none, none[..., 0], none, none, none)
    if group.flexures is not None:
        apart = Apart(J_p, gap, gap_rate)
        turning, of_flexures = flexed(group, frames, tips, zd, R_ip, section, apart)
        bias = bias + turning
        if any(group.soft):
            bias = bias + mtv(J_p, merged(of_flexures.pull))
    reach, regularity = (np.broadcast_to(a, legs) for a in group.type.margins(group, joints, place))
    moved = (zd, A, bias, J_p, Jdqd, gap, gap_rate, reach, regularity)
    stand = (branch, R_ip, place, velocity, of_flexures)
    return LegTerms(EMPTY, joints, frames._replace(seats=[], bodies=[]), *moved, *stand)


def wide(joints: chain.Joints, legs: tuple[int, ...], n: int) -> chain.Joints:
    """Joint variables, each (…, L, n), of legs (…, L)."""
    cos, sin, length = (np.broadcast_to(a, (*legs, n)) for a in joints[:3])
    return chain.Joints(cos, sin, length, np.broadcast_to(joints.bend, (*legs, joints.bend.shape[-1])))


def rates_of(
    group: LegGroup,
    frames: Frames,
    joints: chain.Joints,
    J: Sequence[Array],
    place: Array,
    velocity: Array,
    sd: Array,
) -> Array:
    """ż (…, L, z) from places and velocities (…, L, t, 3) of the tips in Σ0i, and the carried rates.

    J are the Jacobians (…, L, 3, z) of the tips in Σ0i.
    """
    n, ed = group.chain.n, group.bend(sd)
    if any(group.chain.modes) and not group.type.carries:
        velocity = velocity - stack([mv(part[..., n:], ed) for part in J], axis=-2)
    qd = group.type.rates(group, frames, joints, place, velocity, sd)
    return join([qd, ed]) if ed.shape[-1] else qd


def tips_of(
    group: LegGroup,
    frames: Frames,
    motions: list[recursion.Motion],
    tips: Sequence[Point],
    zd: Array,
    gravity: Array,
    R_pi: Array,
    place: Array,
) -> tuple[Array, Array]:
    """J̇ż and the gap (…, L, 3t) at the tips, in Σp; gravity and places are in Σ0i."""
    Jdqd, gap, rest = [], [], np.zeros(group.chain.size)
    for t, tip in enumerate(tips):
        own = recursion.tip_acceleration(group.chain, motions, tip, zd, rest)
        Jdqd.append(mv(R_pi, mv(frames.R_0j[tip.link], own) + gravity))
        gap.append(mv(R_pi, chain.tip_position(frames, tip) - place[..., t, :]))
    return np.concatenate(Jdqd, axis=-1), np.concatenate(gap, axis=-1)


class Apart(NamedTuple):
    """The tips against the platform's points, in Σp: J (…, L, 3t, z), the gaps and their rates (…, L, 3t)."""

    J: Array
    gap: Array
    gap_rate: Array


def flexed(
    group: LegGroup,
    frames: Frames,
    tips: Sequence[Point],
    zd: Array,
    R_ip: Array,
    section: Array,
    apart: Apart,
) -> tuple[Array, OfFlexures]:
    """The generalised forces (…, L, z) by which the flexures' moments hold the legs, and what they do.

    R_ip takes vectors in the axes of `section` and `apart` to Σ0i. A soft tip's force acts at the tip, so
    that it has a moment about the platform's point.
    """
    assert group.flexures is not None, "legs without flexures have none of this"
    C, spin = split(section.reshape(section.shape[:-1] + (len(tips), 12)), [(3, 3), (3,)])
    R_leg = stack([chain.tip_rotation(frames, tip) for tip in tips], axis=-3)
    J_r = stack([chain.turning_jacobian(group.chain, frames, tip) for tip in tips], axis=-3)
    J_r = transpose(R_ip) @ J_r
    Q = from_rest(group.flexures, R_ip @ C, R_leg)
    theta, opening = bent_angle(Q), openness(group.flexures, Q)
    omega = relative_spin(C, mv(J_r, zd[..., None, :]), spin)
    moment = mv(C, moments(group.flexures, theta, omega))
    turning = np.sum(mtv(J_r, moment), axis=-2)
    if not any(group.soft):
        return turning, OfFlexures(theta, omega, moment, opening, *[theta[..., :0, :]] * 3)
    gap, gap_rate = (part.reshape(theta.shape) for part in (apart.gap, apart.gap_rate))
    stretch, stretch_rate = stretches(C, spin, gap, gap_rate)
    pull = mv(C, pulls(group.flexures, stretch, stretch_rate))
    moment = moment + cross(gap, pull)
    return turning, OfFlexures(theta, omega, moment, opening, stretch, stretch_rate, pull)


def leg_response(group: LegGroup, A: Array, pulls: Array) -> Array:
    """A⁻¹ times columns (…, L, z, c): accelerations of the legs under generalised forces.

    Elastic coordinates are eliminated first: among themselves they are nearly orthonormal.
    """
    n, size = group.chain.n, group.chain.size
    if n == size:
        return solve_definite(A, pulls)
    order = np.roll(np.arange(size), -n)
    found = solve_definite(A[..., order, :][..., order], pulls[..., order, :])
    return found[..., np.argsort(order), :]


def of_motors(group: LegGroup, z: Array) -> Array:
    """Sᵀ z (…, L, actuated): rates or accelerations of the motors, from those of all coordinates."""
    c = group.chain
    return joint_forces.at_motors(c, z[..., : c.n], z[..., c.n :])[..., list(group.actuated)]


def motor_positions(leg: LegTerms) -> Array:
    """θ (…, L, actuated) of the motors: q of the joint, an angle in (−π, π], less what the drive gives."""
    c, bend = leg.group.chain, leg.joints.bend
    found = [joint_forces.at_motor(c, j, joint_position(leg, j), bend) for j in leg.group.actuated]
    return stack(found) if found else leg.qd[..., :0]


def joint_position(leg: LegTerms, j: int) -> Array:
    """q_j (…, L) of the legs of a group; angles in (−π, π]."""
    return chain.joint_position(leg.group.chain, leg.joints, j, np.zeros(len(leg.group.legs)))
