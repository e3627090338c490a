"""The UPS leg of Table 1: a universal joint, an actuated prismatic joint, a spherical tip."""

import numpy as np

from parflex.base.array import Array, dot, mtv, stack
from parflex.mechanics.chain import Frames, Joints, placement
from parflex.mechanics.legs.base import LegGroup, LegType
from parflex.robot.leg import Leg, deviations

QUARTER = np.pi / 2


class UPS(LegType):
    """Joints R, R, P with concurrent axes; the first may be placed anywhere in Σ0i.

    In the frame of the first joint at q_1 = 0 the tip is at
    ℓ (cos q1 sin q2, sin q1 sin q2, −cos q2), with 0 < q2 < π.
    """

    name = "UPS"

    def recognises(self, leg: Leg) -> bool:
        """R, R, P; α_2 = α_3 = π/2; the rest of rows 2 and 3 zero; one tip on the slider's axis."""
        if leg.pattern != "RRP" or leg.antecedents != (0, 1, 2) or len(leg.tips) != 1:
            return False
        _, second, third = leg.joints
        offset = np.asarray(leg.tips[0].offset)
        zero = [second.theta, second.r, third.theta, offset[0], offset[1]]
        zero += deviations(second, alpha=QUARTER) + deviations(third, alpha=QUARTER)
        return leg.tips[0].frame == 3 and max(np.abs(zero)) < 1e-12

    def joints(self, group: LegGroup, tips: Array, q: Array) -> Joints:
        """(cos q1, sin q1), (cos q2, sin q2) and q3 of the tip, without an angle."""
        u = in_first_frame(group, tips[..., 0, :])
        x, y, z = u[..., 0], u[..., 1], u[..., 2]
        radius = np.sqrt(x * x + y * y)
        length = np.sqrt(dot(u, u))
        slide = length - group.chain.r[:, 2] - group.offsets[:, 0, 2]
        one, zero = np.ones(()), np.zeros(())
        return Joints(
            cos=stack([x / radius, -z / length, one]),
            sin=stack([y / radius, radius / length, zero]),
            length=stack([zero, zero, slide]),
        )

    def rates(
        self, group: LegGroup, frames: Frames, joints: Joints, tips: Array, v: Array, qd: Array
    ) -> Array:
        """q̇ = J⁻¹ v, row by row."""
        u = in_first_frame(group, tips[..., 0, :])
        length = np.sqrt(dot(u, u))
        v_1 = mtv(placement(group.chain, 0)[0], v[..., 0, :])
        x, y, z = v_1[..., 0], v_1[..., 1], v_1[..., 2]
        c1, c2 = joints.cos[..., 0], joints.cos[..., 1]
        s1, s2 = joints.sin[..., 0], joints.sin[..., 1]
        outward = c1 * x + s1 * y
        return stack(  # Eq. 2
            [
                (c1 * y - s1 * x) / (length * s2),  # Eq. 4
                (c2 * outward + s2 * z) / length,  # Eq. 4
                s2 * outward - c2 * z,  # Eq. 5
            ]
        )

    def margins(self, group: LegGroup, joints: Joints, tips: Array) -> tuple[Array, Array]:
        """The distance from joint to tip (m), and sin q2, which is zero in gimbal lock."""
        return joints.length[..., 2] + group.chain.r[:, 2] + group.offsets[:, 0, 2], joints.sin[..., 1]


def in_first_frame(group: LegGroup, tip: Array) -> Array:
    """A point (…, L, 3) of Σ0i in the frame of the first joint at q_1 = 0."""
    R, p = placement(group.chain, 0)
    return mtv(R, tip - p)
