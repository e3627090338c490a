"""The UPS leg of Table 1: a universal joint, an actuated prismatic joint, a spherical tip."""

import numpy as np

from parflex.base.array import Array, dot, mtv, mv, stack
from parflex.mechanics.chain import Frames, Joints, joint_seat, placement
from parflex.mechanics.legs.base import LegGroup, LegType
from parflex.mechanics.legs.universal import in_outward_axes, universal
from parflex.robot.leg import Leg, deviations

QUARTER = np.pi / 2


class UPS(LegType):
    """Joints R, R, P with concurrent axes; the first may be placed anywhere in Σ0i.

    In the frame of the first joint at q_1 = 0 the tip of a rigid leg is at
    ℓ (cos q1 sin q2, sin q1 sin q2, −cos q2), with 0 < q2 < π. Cylinder and rod may bend.
    """

    name = "UPS"

    def recognises(self, leg: Leg) -> bool:
        """R, R, P; α_2 = α_3 = π/2; the rest of rows 2 and 3 zero; one tip on the slider's axis."""
        if leg.pattern != "RRP" or leg.antecedents != (0, 1, 2) or len(leg.tips) != 1:
            return False
        _, second, third = leg.joints
        offset = np.asarray(leg.tips[0].offset)
        zero = [second.theta, second.r, third.theta, offset[0], offset[1], leg.modes[0]]
        zero += deviations(second, alpha=QUARTER) + deviations(third, alpha=QUARTER)
        return leg.tips[0].frame == 3 and max(np.abs(zero)) < 1e-12

    def joints(self, group: LegGroup, tips: Array, kept: Array) -> Joints:
        """(cos q1, sin q1), (cos q2, sin q2) and q3 of the tip, without an angle."""
        u = in_first_frame(group, tips[..., 0, :])
        start, along = slide(group, 2, group.bend(kept))
        ahead = dot(along, start)
        length = np.sqrt(ahead * ahead - dot(start, start) + dot(u, u)) - ahead
        w = start + length[..., None] * along
        (c1, s1), (c2, s2), _ = universal(u, w, np.ones(()))
        one, zero = np.ones(()), np.zeros(())
        return Joints(
            cos=stack([c1, c2, one]),
            sin=stack([s1, s2, zero]),
            length=stack([zero, zero, length]),
            bend=kept,
        )

    def rates(
        self, group: LegGroup, frames: Frames, joints: Joints, tips: Array, v: Array, kept: Array
    ) -> Array:
        """q̇ = J_q⁻¹ v, row by row."""
        u = in_first_frame(group, tips[..., 0, :])
        start, along = slide(group, 2, joints.bend)
        w = start + joints.length[..., 2, None] * along
        v_1 = mtv(placement(group.chain, 0)[0], v[..., 0, :])
        c2, s2 = joints.cos[..., 1], joints.sin[..., 1]
        at = joints.cos[..., 0], joints.sin[..., 0]
        outward, _, _ = in_outward_axes(u, at, np.ones(()))
        _, v_rise, v_across = in_outward_axes(v_1, at, np.ones(()))
        growth = dot(u, v_1) / dot(w, along)  # Eq. 2, 5
        rising = s2 * along[..., 0] + c2 * along[..., 1]
        return stack(
            [
                (along[..., 2] * growth - v_across) / outward,  # Eq. 4
                (v_rise - rising * growth) / outward,  # Eq. 4
                growth,
            ]
        )

    def margins(self, group: LegGroup, joints: Joints, tips: Array) -> tuple[Array, Array]:
        """The distance from joint to tip (m), and sin q2, which is zero in gimbal lock."""
        return joints.length[..., 2] + group.chain.r[:, 2] + group.offsets[:, 0, 2], joints.sin[..., 1]


def in_first_frame(group: LegGroup, tip: Array) -> Array:
    """A point (…, L, 3) of Σ0i in the frame of the first joint at q_1 = 0."""
    R, p = placement(group.chain, 0)
    return mtv(R, tip - p)


def slide(group: LegGroup, j: int, bend: Array) -> tuple[Array, Array]:
    """Where a sliding joint has the only tip at q_j = 0, and the unit vector along which it moves it: in the
    frame of its antecedent, of links bent by (…, L, ΣN)."""
    R, p = placement(group.chain, j)
    start, along = p + mv(R, group.points(bend)[0].place), R[..., 2]
    seat = joint_seat(group.chain, j, bend)
    if seat is None:
        return start, along
    return seat.place + mv(seat.turn, start - seat.rest), mv(seat.turn, along)
