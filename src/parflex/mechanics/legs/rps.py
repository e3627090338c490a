"""The RPS leg: a hinge, an actuated prismatic joint, a spherical tip that stays in a plane."""

import numpy as np

from parflex.base.array import Array, mtv, stack
from parflex.mechanics.chain import Frames, Joints, placement
from parflex.mechanics.legs.base import LegGroup, LegType
from parflex.mechanics.legs.ups import QUARTER, in_first_frame, slide
from parflex.robot.leg import Leg, deviations


class RPS(LegType):
    """Joints R, P with perpendicular axes that meet; the first may be placed anywhere in Σ0i.

    In the frame of the first joint at q_1 = 0 the tip of a rigid leg is at ± ℓ (sin q1, −cos q1, 0) for
    α_2 = ± π/2, with ℓ > 0. Cylinder and rod may bend: then only the parts in the plane across the hinge
    count.
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

    def joints(self, group: LegGroup, tips: Array, kept: Array) -> Joints:
        """(cos q1, sin q1) and q2 of the tip's projection on the leg's plane."""
        u = in_first_frame(group, tips[..., 0, :])
        start, along = slide(group, 1, group.bend(kept))
        square, ahead = level(along, along), level(along, start)
        root = np.sqrt(ahead * ahead - square * level(start, start) + square * level(u, u))
        length = (root - ahead) / square
        w = start + length[..., None] * along
        radius, one, zero = level(u, u), np.ones(()), np.zeros(())
        return Joints(
            cos=stack([level(u, w) / radius, one]),
            sin=stack([lever(w, u) / radius, zero]),
            length=stack([zero, length]),
            bend=kept,
        )

    def rates(
        self, group: LegGroup, frames: Frames, joints: Joints, tips: Array, v: Array, kept: Array
    ) -> Array:
        """The tip's velocity across and along the slider."""
        u = in_first_frame(group, tips[..., 0, :])
        start, along = slide(group, 1, joints.bend)
        w = start + joints.length[..., 1, None] * along
        v_1 = mtv(placement(group.chain, 0)[0], v[..., 0, :])
        growth = level(u, v_1) / level(w, along)
        return stack([(lever(u, v_1) - growth * lever(w, along)) / level(u, u), growth])

    def margins(self, group: LegGroup, joints: Joints, tips: Array) -> tuple[Array, Array]:
        """The distance from hinge to tip (m); nothing else can fail."""
        u = in_first_frame(group, tips[..., 0, :])
        square = level(u, u)
        return np.sqrt(square), square / square


def level(a: Array, b: Array) -> Array:
    """The scalar product of what vectors have across the hinge's axis."""
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1]


def lever(a: Array, b: Array) -> Array:
    """The part of a × b along the hinge's axis."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
