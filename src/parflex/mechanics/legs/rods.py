"""An actuated joint that carries rods of fixed length: RUS, PUS, RRS, PRS, and the arms of a Delta.

Each rod hangs on link 1 by a knuckle, a universal joint (two joints) or a hinge (one), and ends in
a spherical tip. The distance from knuckle to tip gives the first joint, the direction the knuckle.
"""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, cross, dot, mtv, mv, stack
from parflex.mechanics.chain import Frames, Joints, joint_seat, placement
from parflex.mechanics.legs.base import LegGroup, LegType
from parflex.mechanics.legs.universal import in_outward_axes, turned, universal
from parflex.mechanics.legs.ups import QUARTER, in_first_frame
from parflex.mechanics.recursion import E_Z
from parflex.robot.leg import Leg, deviations


class Rod(NamedTuple):
    """One rod of L legs, in the axes of link 1 unless noted; link and rod may be bent."""

    first: int  # index of the knuckle's first joint
    last: int  # of its last, the same for a hinge
    elbow: Array  # (…, L, 3), a point on the knuckle; for a hinge in the plane of the tip
    R: Array  # (…, L, 3, 3), axes of the knuckle's first joint at zero
    side: Array  # (L,), ±1, sense of the second axis
    length: Array  # (…, L) m
    tip: Array  # (…, L, 3), unit vector to the tip in the rod's own frame; of a hinge in its plane


class Rods(LegType):
    """A revolute or prismatic joint, and on its link one or several rods.

    With u the tip and e the elbow in the first frame at q_1 = 0, |u − Rot(z, q1) e| = ℓ or
    |u − e − q1 z| = ℓ; the sign of the square root is the branch. Of several rods the first gives
    q_1. The rod's elevation over the first axis of a universal joint is within ± π/2.
    """

    name = "rods"
    two_branches = True

    def recognises(self, leg: Leg) -> bool:
        """Knuckles on link 1, each a hinge or a universal joint with crossing axes, one tip each.

        Only link 1 and the rods bend.
        """
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
        rigid = not any(leg.modes[k - 1] for tip in leg.tips if (k := leg.antecedents[tip.frame - 1]) > 1)
        return every and turning and long and rigid

    def branch(self, group: LegGroup, joints: Joints, tips: Array) -> Array:
        """The sign of the square root."""
        u, rod = in_first_frame(group, tips[..., 0, :]), rods(group, joints.bend)[0]
        if group.chain.sigma[0]:
            root = (u - rod.elbow)[..., 2] - joints.length[..., 0]
        else:
            A, B, _ = crank(u, rod)
            root = A * joints.sin[..., 0] - B * joints.cos[..., 0]
        return np.where(root < 0, -1.0, 1.0)

    def joints(self, group: LegGroup, tips: Array, kept: Array) -> Joints:
        """q_1 from the first rod's length, the knuckles from the rods' directions."""
        sigma, hung = group.chain.sigma, rods(group, group.bend(kept))
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
            if rod.last > rod.first:
                full = np.sqrt(dot(w, w))
                (cos[rod.first], sin[rod.first]), second, _ = universal(w, rod.tip, rod.side, full)
                cos[rod.last], sin[rod.last] = second
            else:
                radius, x, y = np.sqrt(level_square(w)), rod.tip[..., 0], rod.tip[..., 1]
                c, s = w[..., 0] / radius, w[..., 1] / radius
                cos[rod.last], sin[rod.last] = c * x + s * y, s * x - c * y
        return Joints(stack(cos), stack(sin), stack(length), kept)

    def rates(
        self, group: LegGroup, frames: Frames, joints: Joints, tips: Array, v: Array, kept: Array
    ) -> Array:
        """q̇_1 keeps the first rod's length; the rest of the tips' velocities turns the knuckles."""
        slides, hung = group.chain.sigma[0], rods(group, joints.bend)
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
            if rod.last == rod.first:
                radius = np.sqrt(level_square(w))
                rates[rod.first] = (w[..., 0] * wd[..., 1] - w[..., 1] * wd[..., 0]) / (radius * radius)
                continue
            at = joints.cos[..., rod.first], joints.sin[..., rod.first]
            outward, rise, across = in_outward_axes(w, at, rod.side)
            v_outward, v_rise, v_across = in_outward_axes(wd, at, rod.side)
            rates[rod.first] = -rod.side * v_across / outward
            if group.chain.links[rod.last] is not None:
                v_outward = v_outward - rod.side * across * rates[rod.first]
            full = outward * outward + rise * rise
            rates[rod.last] = rod.side * (outward * v_rise - rise * v_outward) / full
        return stack(rates)

    def margins(self, group: LegGroup, joints: Joints, tips: Array) -> tuple[Array, Array]:
        """The square under the root, and the root times the rods' cosines over their first axes."""
        u, hung = in_first_frame(group, tips[..., 0, :]), rods(group, joints.bend)
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
            regular = regular * np.sqrt(level_square(w) / dot(w, w))
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
    A = u[..., 0] * e[..., 0] + u[..., 1] * e[..., 1]
    B = u[..., 1] * e[..., 0] - u[..., 0] * e[..., 1]
    k = 0.5 * (dot(u, u) + dot(e, e) - rod.length * rod.length) - u[..., 2] * e[..., 2]
    return A, B, k


def rods(group: LegGroup, bend: Array) -> list[Rod]:
    """The rods by tip, of links that are bent by (…, L, ΣN)."""
    found = []
    for point in group.points(bend):
        last = point.link
        first = last if group.chain.antecedent[last] == 0 else group.chain.antecedent[last]
        R, p = placement(group.chain, first)
        seat = joint_seat(group.chain, first, bend)
        if seat is not None:
            R, p = seat.turn @ R, seat.place + mv(seat.turn, p - seat.rest)
        side, tip = np.sign(group.chain.alpha[:, last]), point.place
        if last == first:
            p = p + tip[..., 2:] * R[..., 2]
            side, tip = np.ones(len(side)), tip * np.array([1.0, 1.0, 0.0])
        length = np.sqrt(dot(tip, tip))
        found.append(Rod(first, last, p, R, side, length, tip / length[..., None]))
    return found


def level_square(w: Array) -> Array:
    """The square of what a vector has across the third axis."""
    return w[..., 0] * w[..., 0] + w[..., 1] * w[..., 1]
