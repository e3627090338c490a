"""An actuated joint that carries rods of fixed length: RUS, PUS, RRS, PRS, and the arms of a Delta.

Each rod hangs on link 1 by a knuckle, a universal joint (two joints) or a hinge (one), and ends in
a spherical tip. The distance from knuckle to tip gives the first joint, the direction the knuckle.
"""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, cross, dot, mtv, mv, stack
from parflex.base.spatial import rotation_about_z
from parflex.mechanics.chain import E_Z, Frames, Joints, placement
from parflex.mechanics.legs.base import LegGroup, LegType
from parflex.mechanics.legs.ups import QUARTER, in_first_frame
from parflex.robot.leg import Leg, deviations


class Rod(NamedTuple):
    """One rod of L legs, in the axes of link 1 unless noted."""

    first: int  # index of the knuckle's first joint
    last: int  # of its last, the same for a hinge
    elbow: Array  # (L, 3), a point on the knuckle; for a hinge in the plane of the tip
    R: Array  # (L, 3, 3), axes of the knuckle's first joint at zero
    side: Array  # (L,), ±1, sense of the second axis
    length: Array  # (L,) m
    heading: Array  # (L,) rad, of the rod in its own frame


class Rods(LegType):
    """A revolute or prismatic joint, and on its link one or several rods.

    With u the tip and e the elbow in the first frame at q_1 = 0, |u − Rot(z, q1) e| = ℓ or
    |u − e − q1 z| = ℓ; the sign of the square root is the branch. Of several rods the first gives
    q_1. The rod's elevation over the first axis of a universal joint is within ± π/2.
    """

    name = "rods"
    two_branches = True

    def recognises(self, leg: Leg) -> bool:
        """Knuckles on link 1, each a hinge or a universal joint with crossing axes, one tip each."""
        used = [1]
        for tip in leg.tips:
            if tip.frame == 0:
                return False
            last = leg.joints[tip.frame - 1]
            offset = np.asarray(tip.offset)
            if last.antecedent == 1:
                used += [tip.frame]
                continue
            zero = [last.theta, last.r, offset[2]]
            zero += deviations(last, alpha=np.copysign(QUARTER, last.alpha))
            knuckle = leg.joints[last.antecedent - 1]
            if last.antecedent == 0 or knuckle.antecedent != 1 or max(np.abs(zero)) > 1e-12:
                return False
            used += [last.antecedent, tip.frame]
        every = sorted(used) == list(range(1, len(leg.joints) + 1))
        turning = "P" not in leg.pattern[1:]
        long = all(np.hypot(*np.asarray(tip.offset)[:2]) > 0 for tip in leg.tips)
        return every and turning and long

    def branch(self, group: LegGroup, joints: Joints, tips: Array) -> Array:
        """The sign of the square root."""
        u, rod = in_first_frame(group, tips[..., 0, :]), rods(group)[0]
        if group.chain.sigma[0]:
            root = (u - rod.elbow)[..., 2] - joints.length[..., 0]
        else:
            A, B, _ = crank(u, rod)
            root = A * joints.sin[..., 0] - B * joints.cos[..., 0]
        return np.where(root < 0, -1.0, 1.0)

    def joints(self, group: LegGroup, tips: Array, q: Array) -> Joints:
        """q_1 from the first rod's length, the knuckles from the rods' directions."""
        sigma, hung = group.chain.sigma, rods(group)
        one, zero = np.ones(()), np.zeros(())
        cos, sin, length = [one] * len(sigma), [zero] * len(sigma), [zero] * len(sigma)
        u = in_first_frame(group, tips[..., 0, :])
        if sigma[0]:
            d = u - hung[0].elbow
            length[0] = d[..., 2] - group.branch * np.sqrt(self._square(group, u, hung[0]))
        else:
            cos[0], sin[0] = self._crank_angle(group, u, hung[0])
        for t, rod in enumerate(hung):
            w = self._along(group, tips[..., t, :], rod, cos[0], sin[0], length[0])
            radius = np.sqrt(w[..., 0] * w[..., 0] + w[..., 1] * w[..., 1])
            cos[rod.first], sin[rod.first] = w[..., 0] / radius, w[..., 1] / radius
            if rod.last > rod.first:
                full = np.sqrt(dot(w, w))
                cos[rod.last], sin[rod.last] = radius / full, rod.side * w[..., 2] / full
            cos[rod.last], sin[rod.last] = turned_back(cos[rod.last], sin[rod.last], rod.heading)
        return Joints(stack(cos), stack(sin), stack(length))

    def rates(
        self, group: LegGroup, frames: Frames, joints: Joints, tips: Array, v: Array, qd: Array
    ) -> Array:
        """q̇_1 keeps the first rod's length; the rest of the tips' velocities turns the knuckles."""
        slides, hung = group.chain.sigma[0], rods(group)
        c, s, length = joints.cos[..., 0], joints.sin[..., 0], joints.length[..., 0]
        R_01 = placement(group.chain, 0)[0]
        rates: list[Array] = [np.zeros(())] * group.chain.n
        for t, rod in enumerate(hung):
            w = self._along(group, tips[..., t, :], rod, c, s, length)
            v_1 = turned(mtv(R_01, v[..., t, :]), c, -s)
            along = mv(rod.R, w)
            if t == 0:
                lever = along if slides else cross(rod.elbow, along)
                rates[0] = dot(along, v_1) / lever[..., 2]
            travel = E_Z if slides else cross(E_Z, rod.elbow + along)
            wd = mtv(rod.R, v_1 - rates[0][..., None] * travel)
            radius = np.sqrt(w[..., 0] * w[..., 0] + w[..., 1] * w[..., 1])
            ca, sa = w[..., 0] / radius, w[..., 1] / radius
            rates[rod.first] = (ca * wd[..., 1] - sa * wd[..., 0]) / radius
            if rod.last > rod.first:
                outward = ca * wd[..., 0] + sa * wd[..., 1]
                full = dot(w, w)
                rates[rod.last] = rod.side * (radius * wd[..., 2] - w[..., 2] * outward) / full
        return stack(rates)

    def margins(self, group: LegGroup, joints: Joints, tips: Array) -> tuple[Array, Array]:
        """The square under the root, and the root times the rods' cosines over their first axes."""
        u, hung = in_first_frame(group, tips[..., 0, :]), rods(group)
        square = self._square(group, u, hung[0])
        if group.chain.sigma[0]:
            reach = square / (hung[0].length * hung[0].length)
        else:
            A, B, _ = crank(u, hung[0])
            reach = square / (A * A + B * B)
        regular = np.sqrt(reach)
        for t, rod in enumerate(hung):
            at = (joints.cos[..., 0], joints.sin[..., 0], joints.length[..., 0])
            w = self._along(group, tips[..., t, :], rod, *at)
            level = w[..., 0] * w[..., 0] + w[..., 1] * w[..., 1]
            regular = regular * np.sqrt(level / dot(w, w))
        return reach, regular

    def _square(self, group: LegGroup, u: Array, rod: Rod) -> Array:
        """The radicand of the inverse geometry, negative beyond reach."""
        if group.chain.sigma[0]:
            d = u - rod.elbow
            return rod.length * rod.length - d[..., 0] * d[..., 0] - d[..., 1] * d[..., 1]
        A, B, k = crank(u, rod)
        return A * A + B * B - k * k

    def _crank_angle(self, group: LegGroup, u: Array, rod: Rod) -> tuple[Array, Array]:
        """(cos q1, sin q1) with A cos q1 + B sin q1 = k."""
        A, B, k = crank(u, rod)
        root, square = group.branch * np.sqrt(self._square(group, u, rod)), A * A + B * B
        return (A * k - B * root) / square, (B * k + A * root) / square

    def _along(self, group: LegGroup, tip: Array, rod: Rod, c: Array, s: Array, length: Array) -> Array:
        """The vector from elbow to tip, in the axes of the knuckle's first joint at zero."""
        u = turned(in_first_frame(group, tip), c, -s)
        return mtv(rod.R, u - rod.elbow - length[..., None] * E_Z)


def crank(u: Array, rod: Rod) -> tuple[Array, Array, Array]:
    """A, B, k of |u − Rot(z, q1) e|² = ℓ² written as A cos q1 + B sin q1 = k."""
    e = rod.elbow
    A = u[..., 0] * e[:, 0] + u[..., 1] * e[:, 1]
    B = u[..., 1] * e[:, 0] - u[..., 0] * e[:, 1]
    k = 0.5 * (dot(u, u) + dot(e, e) - rod.length * rod.length) - u[..., 2] * e[:, 2]
    return A, B, k


def rods(group: LegGroup) -> list[Rod]:
    """The rods by tip."""
    found = []
    for t, last in enumerate(group.tip_frames):
        first = last if group.chain.antecedent[last] == 0 else group.chain.antecedent[last]
        R, p = placement(group.chain, first)
        offset = group.offsets[:, t]
        lift = offset[:, 2:] * R[..., 2]
        side = np.sign(group.chain.alpha[:, last]) if last > first else np.ones(len(p))
        length, heading = np.hypot(offset[:, 0], offset[:, 1]), np.arctan2(offset[:, 1], offset[:, 0])
        found.append(Rod(first, last, p + lift, R, side, length, heading))
    return found


def turned(x: Array, c: Array, s: Array) -> Array:
    """Rot(z, angle) x for the (cos, sin) of an angle."""
    return stack([c * x[..., 0] - s * x[..., 1], s * x[..., 0] + c * x[..., 1], x[..., 2]])


def turned_back(c: Array, s: Array, angle: Array) -> tuple[Array, Array]:
    """(cos, sin) of an angle less a constant one."""
    R = rotation_about_z(angle)
    c0, s0 = R[:, 0, 0], R[:, 1, 0]
    return c * c0 + s * s0, s * c0 - c * s0
