"""The UPS leg of Table 1: a universal joint, an actuated prismatic joint, a spherical tip."""

import numpy as np

from parflex.array import Array, dot, mtv, stack
from parflex.chain import Chain, Frames, Joints
from parflex.legs.base import Leg, LegType
from parflex.spatial import exact_cos_sin

QUARTER = np.pi / 2


class UPS(LegType):
    """Joints R, R, P with concurrent axes; the first may be placed anywhere in Σ0i.

    In the frame of the first joint at q_1 = 0 the tip is at
    ℓ (cos q1 sin q2, sin q1 sin q2, −cos q2), with 0 < q2 < π.
    """

    name = "UPS"

    def recognises(self, leg: Leg) -> bool:
        """R, R, P; α_2 = α_3 = π/2; the rest of rows 2 and 3 zero; one tip on the slider's axis."""
        if [j.sigma for j in leg.joints] != [0, 0, 1]:
            return False
        if [j.antecedent for j in leg.joints] != [0, 1, 2] or len(leg.tips) != 1:
            return False
        first, second, third = leg.joints
        zero = [first.theta, second.gamma, second.b, second.d, second.theta, second.r]
        zero += [third.gamma, third.b, third.d, third.theta, *np.asarray(leg.tips[0].offset)[:2]]
        turns = [second.alpha - QUARTER, third.alpha - QUARTER]
        return leg.tips[0].frame == 3 and not np.any(np.abs(zero + turns) > 1e-12)

    def joints(self, chain: Chain, offsets: Array, tips: Array) -> Joints:
        """(cos q1, sin q1), (cos q2, sin q2) and q3 of the tip, without an angle."""
        u = self._in_first_frame(chain, tips[..., 0, :])
        x, y, z = u[..., 0], u[..., 1], u[..., 2]
        radius = np.sqrt(x * x + y * y)
        length = np.sqrt(dot(u, u))
        slide = length - chain.r[:, 2] - offsets[:, 0, 2]
        one, zero = np.ones(()), np.zeros(())
        return Joints(
            cos=stack([x / radius, -z / length, one]),
            sin=stack([y / radius, radius / length, zero]),
            length=stack([zero, zero, slide]),
        )

    def rates(self, chain: Chain, frame: Frames, joints: Joints, tips: Array, v: Array) -> Array:
        """q̇ = J⁻¹ v, row by row."""
        u = self._in_first_frame(chain, tips[..., 0, :])
        length = np.sqrt(dot(u, u))
        v_1 = mtv(self._first_frame(chain)[0], v[..., 0, :])
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

    def margins(self, chain: Chain, joints: Joints, offsets: Array) -> tuple[Array, Array]:
        """The distance from joint to tip (m), and sin q2, which is zero in gimbal lock."""
        return joints.length[..., 2] + chain.r[:, 2] + offsets[:, 0, 2], joints.sin[..., 1]

    def _first_frame(self, chain: Chain) -> tuple[Array, Array]:
        """Axes and origin, in Σ0i, of the first joint's frame at q_1 = 0."""
        cg, sg = exact_cos_sin(chain.gamma[:, 0])
        ca, sa = exact_cos_sin(chain.alpha[:, 0])
        zero, d, r = np.zeros_like(cg), chain.d[:, 0], chain.r[:, 0]
        R = np.stack([cg, -sg * ca, sg * sa, sg, cg * ca, -cg * sa, zero, sa, ca], axis=-1)
        p = [d * cg + r * (sg * sa), d * sg - r * (cg * sa), r * ca + chain.b[:, 0]]
        return R.reshape(-1, 3, 3), np.stack(p, axis=-1)

    def _in_first_frame(self, chain: Chain, tip: Array) -> Array:
        R, p = self._first_frame(chain)
        return mtv(R, tip - p)
