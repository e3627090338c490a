"""The RPS leg: a hinge, an actuated prismatic joint, a spherical tip that stays in a plane."""

import numpy as np

from parflex.base.array import Array, mtv, stack
from parflex.mechanics.chain import Frames, Joints, placement
from parflex.mechanics.legs.base import LegGroup, LegType
from parflex.mechanics.legs.ups import QUARTER, in_first_frame
from parflex.robot.leg import Leg, deviations


class RPS(LegType):
    """Joints R, P with perpendicular axes that meet; the first may be placed anywhere in Σ0i.

    In the frame of the first joint at q_1 = 0 the tip is at ± ℓ (sin q1, −cos q1, 0) for
    α_2 = ± π/2, with ℓ > 0.
    """

    name = "RPS"

    def recognises(self, leg: Leg) -> bool:
        """R, P; α_2 = ± π/2; the rest of row 2 zero but r; one tip on the slider's axis."""
        if leg.pattern != "RP" or leg.antecedents != (0, 1) or len(leg.tips) != 1:
            return False
        second, offset = leg.joints[1], np.asarray(leg.tips[0].offset)
        zero = [second.theta, offset[0], offset[1]]
        zero += deviations(second, alpha=np.copysign(QUARTER, second.alpha))
        return leg.tips[0].frame == 2 and max(np.abs(zero)) < 1e-12

    def joints(self, group: LegGroup, tips: Array, q: Array) -> Joints:
        """(cos q1, sin q1) and q2 of the tip's projection on the leg's plane."""
        x, y, radius = self._in_plane(group, tips)
        one, zero = np.ones(()), np.zeros(())
        side = np.sign(group.chain.alpha[:, 1])
        return Joints(
            cos=stack([-side * y / radius, one]),
            sin=stack([side * x / radius, zero]),
            length=stack([zero, radius - group.chain.r[:, 1] - group.offsets[:, 0, 2]]),
        )

    def rates(
        self, group: LegGroup, frames: Frames, joints: Joints, tips: Array, v: Array, qd: Array
    ) -> Array:
        """The tip's velocity across and along the slider."""
        x, y, radius = self._in_plane(group, tips)
        v_1 = mtv(placement(group.chain, 0)[0], v[..., 0, :])
        c, s = x / radius, y / radius
        across, along = c * v_1[..., 1] - s * v_1[..., 0], c * v_1[..., 0] + s * v_1[..., 1]
        return stack([across / radius, along])

    def margins(self, group: LegGroup, joints: Joints, tips: Array) -> tuple[Array, Array]:
        """The distance from hinge to tip (m); nothing else can fail."""
        radius = self._in_plane(group, tips)[2]
        return radius, radius / radius

    def _in_plane(self, group: LegGroup, tips: Array) -> tuple[Array, Array, Array]:
        u = in_first_frame(group, tips[..., 0, :])
        x, y = u[..., 0], u[..., 1]
        return x, y, np.sqrt(x * x + y * y)
