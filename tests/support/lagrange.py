"""The equations of motion of a robot by Lagrange's method, every derivative by automatic differentiation.

Kinetic energy, potential energy and Rayleigh's function of all bodies are written down in the coordinates
(p, ξ, q_e) of the platform and (q, e, δ) of every leg; the base moves as a function of time; hard tips are
constraints of one dense system. Nothing is shared with the library's mechanics but the tables of its bodies.

About the state the attitude of the platform is R (1 + ξ̂ + ½ ξ̂²) and that of the base (1 + φ̂ + ½ φ̂²) R_b,
φ = ω t + ½ ω̇ t²: exact to second derivatives, and no higher ones are read. Springs of revolute joints are
within half a turn of their rest, and the rests of flexures are given.
"""

from functools import cached_property
from typing import NamedTuple

import casadi as ca
import numpy as np

X, Z = ca.SX([1, 0, 0]), ca.SX([0, 0, 1])
ONE = ca.SX.eye(3)


class Answer(NamedTuple):
    """Accelerations as the library states them, and what goes with them."""

    platform: np.ndarray  # V̇_p (6,) in Σp
    elastic: np.ndarray
    contact: np.ndarray  # (tips, 3) on the platform in Σp, leg by leg
    joints: list[np.ndarray]  # q̈ of each leg
    leg_elastic: list[np.ndarray]  # ë of each leg, last those of its drives
    energy: float  # kinetic and potential, J
    floor_power: float  # W, that the motion of the base gives to the robot
    gap: float  # the largest entry of the closure of hard tips, and of its rate
    gap_rate: float


class Frame(NamedTuple):
    """A frame in the world."""

    place: ca.SX
    axes: ca.SX


def hat(a):
    return ca.blockcat([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def vee(M):
    return 0.5 * ca.vertcat(M[2, 1] - M[1, 2], M[0, 2] - M[2, 0], M[1, 0] - M[0, 1])


def turned_a_little(a):
    return ONE + hat(a) + 0.5 * hat(a) @ hat(a)


def cayley(a):
    return ONE + (hat(a) + 0.5 * hat(a) @ hat(a)) / (1 + 0.25 * ca.dot(a, a))


def turned(axis, angle):
    return ONE + ca.sin(angle) * hat(axis) + (1 - ca.cos(angle)) * hat(axis) @ hat(axis)


def half_square(a, matrix):
    return 0.5 * ca.dot(a, ca.SX(np.asarray(matrix, dtype=float)) @ a)


def drives(leg):
    """The joints, from 0, that have a compliance in series."""
    return [j for j, joint in enumerate(leg.joints) if getattr(joint, "drive_stiffness", None) is not None]


def sizes(robot):
    """The number of coordinates of each leg."""
    return [len(leg.joints) + sum(leg.modes) + len(drives(leg)) for leg in robot.legs]


class Lagrange:
    """The oracle of a robot."""

    def __init__(self, robot):
        self.robot, self.N = robot, robot.platform.modes
        self.first = np.cumsum([6 + self.N, *sizes(robot)])
        self.x, self.v = (ca.SX.sym(name, int(self.first[-1])) for name in "xv")
        self.t, self.forces = ca.SX.sym("t"), ca.SX.sym("u", robot.n_forces)
        self.flow = ca.SX.sym("f")  # one: how fast time goes for what moves by itself, which is the base
        self.start, self.base = ca.SX.sym("s", 12), ca.SX.sym("b", 24)
        self.kinetic = self.potential = self.rayleigh = ca.SX(0)
        self.push, self.gaps, self.soft, self.tips = ca.SX.zeros(self.x.shape), [], [], []
        self.platform = self.with_platform()
        left = list(ca.vertsplit(self.forces)) if robot.n_forces else []
        for i, leg in enumerate(robot.legs):
            self.with_leg(int(self.first[i]), leg, left)

    def rate(self, y):
        """ẏ of an expression in coordinates and time."""
        by_time = ca.jacobian(ca.vec(y), self.t)
        return ca.jtimes(y, self.x, self.v) + self.flow * ca.reshape(by_time, *y.shape)

    def spin(self, axes):
        """ω, in the world."""
        return vee(self.rate(axes) @ axes.T)

    def with_body(self, moments, frame, e, ed):
        """Enter a flexible body by its moments."""
        P1, P2, S = (np.asarray(part) for part in (moments.P1, moments.P2, moments.S))
        v, w = frame.axes.T @ self.rate(frame.place), frame.axes.T @ self.spin(frame.axes)
        second, MS, sway = ca.SX(np.asarray(moments.P0)), ca.SX(np.asarray(moments.MS0)), ca.SX.zeros(3)
        about, modal = ca.SX.zeros(3), ca.SX(0)
        for k in range(len(P1)):
            G = ca.SX(P1[k])
            for j in range(len(P1)):
                G += e[j] * P2[k, j]
                modal += ed[k] * ed[j] * np.trace(P2[k, j])
            second += e[k] * (P1[k].T + G)
            MS, sway, about = MS + S[:, k] * e[k], sway + S[:, k] * ed[k], about + 2 * ed[k] * vee(G)
        inertia = ca.trace(second) * ONE - second
        moving = 0.5 * moments.m * v + ca.cross(w, MS) + sway
        self.kinetic += ca.dot(v, moving) + ca.dot(w, 0.5 * inertia @ w + about) + 0.5 * modal
        self.with_weight(moments.m, MS, frame)

    def with_rigid(self, joint, frame):
        """Enter a rigid link."""
        v, w = frame.axes.T @ self.rate(frame.place), frame.axes.T @ self.spin(frame.axes)
        MS = ca.SX(np.asarray(joint.MS, dtype=float))
        self.kinetic += ca.dot(v, 0.5 * joint.M * v + ca.cross(w, MS)) + half_square(w, joint.I)
        self.with_weight(joint.M, MS, frame)

    def with_weight(self, m, MS, frame):
        gravity = ca.SX(np.asarray(self.robot.gravity))
        self.potential -= ca.dot(gravity, m * frame.place + frame.axes @ MS)

    def with_modes(self, body, e, ed):
        self.potential += 0.5 * ca.dot(ca.SX(body.stiffness) * e, e)
        self.rayleigh += 0.5 * ca.dot(ca.SX(body.damping) * ed, ed)

    def with_platform(self):
        body, end = self.robot.platform, 6 + self.N
        R = ca.reshape(self.start[3:], 3, 3) @ turned_a_little(self.x[3:6])
        frame = Frame(self.start[:3] + self.x[:3], R)
        e, ed = self.x[6:end], self.v[6:end]
        self.with_body(body.moments, frame, e, ed)
        self.with_modes(body, e, ed)
        return frame

    @cached_property
    def ground(self):
        """Σ0 in the world."""
        p, R, v, w, a, wd = (
            self.base[i:j] for i, j in ((0, 3), (3, 12), (12, 15), (15, 18), (18, 21), (21, 24))
        )
        t = self.t
        axes = turned_a_little(w * t + 0.5 * wd * t * t) @ ca.reshape(R, 3, 3)
        return Frame(p + v * t + 0.5 * a * t * t, axes)

    def with_leg(self, first, leg, left):
        """Enter a leg whose coordinates begin at `first`; its forces are taken from those that are left."""
        place, at, deflected = first + len(leg.joints), [], {}
        for modes in leg.modes:
            at.append(slice(place, place + modes))
            place += modes
        bends = [self.x[span] for span in at]
        for j in drives(leg):
            deflected[j] = place
            place += 1
        o, R = self.ground
        frames = [Frame(o + R @ ca.SX(np.asarray(leg.origin)), R @ ca.SX(np.asarray(leg.rotation)))]
        for j, joint in enumerate(leg.joints):
            frames.append(self.next_frame(leg, j, self.x[first + j], frames, bends))
            if joint.body is None:
                self.with_rigid(joint, frames[-1])
            else:
                e, ed = bends[j], self.v[at[j]]
                self.with_body(joint.body.moments, frames[-1], e, ed)
                self.with_modes(joint.body, e, ed)
            self.with_joint(joint, first + j, deflected.get(j), left)
        for coupling in getattr(leg, "couplings", ()):
            joints = [first + j - 1 for j in coupling.joints]
            away = self.x[joints] - ca.SX(np.asarray(coupling.rest))
            self.potential += half_square(away, coupling.stiffness)
            self.rayleigh += half_square(self.v[joints], coupling.damping)
        for k, tip in enumerate(leg.tips):
            self.with_tip(tip, self.seated(leg, tip.frame, leg.seats.tips[k], tip.offset, frames, bends))

    def next_frame(self, leg, j, q, frames, bends):
        """The frame of joint j: Rot(z,γ) Trans(z,b) Rot(x,α) Trans(x,d) Rot(z,θ) Trans(z,r), on its seat."""
        joint = leg.joints[j]
        angle, length = (joint.theta, joint.r + q) if joint.sigma else (joint.theta + q, joint.r)
        across, tilted = turned(Z, joint.gamma), turned(X, joint.alpha)
        place = joint.b * Z + across @ (tilted @ (joint.d * X + length * Z))
        axes = across @ tilted @ turned(Z, angle)
        return self.seated(leg, joint.antecedent, leg.seats.joints[j], place, frames, bends, axes)

    @staticmethod
    def seated(leg, link, attachment, place, frames, bends, axes=ONE):
        """A frame at a place of a link, carried along by an attachment where the link bends."""
        o, R = frames[link]
        place = place if isinstance(place, ca.SX) else ca.SX(np.asarray(place, dtype=float))
        if attachment >= 0:
            body, e = leg.joints[link - 1].body, bends[link - 1]
            rest, shapes, turns, H = (
                table[attachment]
                for table in (
                    body.attachment_points,
                    body.attachment_shapes,
                    body.attachment_turns,
                    body.attachment_shortening,
                )
            )
            tilt = cayley(ca.SX(turns) @ e)
            bent = [half_square(e, H[axis]) for axis in range(3)]
            place = ca.SX(rest) + ca.SX(shapes) @ e + ca.vertcat(*bent) + tilt @ (place - ca.SX(rest))
            axes = tilt @ axes
        return Frame(o + R @ place, R @ axes)

    def with_joint(self, joint, at, deflected, left):
        """Enter rotor, spring, friction and force of a joint, which act at its motor."""
        motor, rate = self.x[at], self.v[at]
        if deflected is not None:
            motor, rate = motor - self.x[deflected], rate - self.v[deflected]
            self.potential += 0.5 * joint.drive_stiffness * self.x[deflected] ** 2
            self.rayleigh += 0.5 * joint.drive_damping * self.v[deflected] ** 2
        self.kinetic += 0.5 * joint.IA * rate**2
        self.potential += 0.5 * joint.k * (motor - joint.q_0) ** 2
        self.rayleigh += 0.5 * joint.Fv * rate**2 + joint.Fs * ca.sqrt(rate**2 + joint.v_s**2)
        if joint.mu:
            force = left.pop(0)
            self.push[at] += force
            if deflected is not None:
                self.push[deflected] -= force

    def with_tip(self, tip, section):
        """Enter the tip of a leg: a constraint, or a soft one, and its flexure."""
        body, number = self.robot.platform, tip.attachment
        e, (o, R) = self.x[6 : 6 + self.N], self.platform
        shapes, flexure = ca.SX(body.attachment_shapes[number]), tip.flexure
        away = section.place - o - R @ (ca.SX(body.attachment_points[number]) + shapes @ e)
        if flexure is not None:
            own = R @ cayley(ca.SX(body.attachment_turns[number]) @ e) if self.N else R
            Q = (
                own.T
                @ section.axes
                @ ca.SX(np.asarray(np.eye(3) if flexure.rest is None else flexure.rest)).T
            )
            self.potential += half_square(4 * vee(Q) / (1 + ca.trace(Q)), flexure.stiffness)
            w = own.T @ (self.spin(section.axes) - self.spin(own))
            self.rayleigh += half_square(w, flexure.damping)
            self.rayleigh += flexure.friction * ca.sqrt(ca.dot(w, w) + flexure.friction_speed**2)
        if flexure is None or getattr(flexure, "translation", None) is None:
            self.gaps.append(away)
            self.tips.append(("hard", len(self.gaps) - 1))
            return
        D = np.zeros((3, 3)) if flexure.translation_damping is None else flexure.translation_damping
        gap = own.T @ away
        self.potential += half_square(gap, flexure.translation)
        self.rayleigh += half_square(self.rate(gap), D)
        pull = ca.SX(np.asarray(flexure.translation)) @ gap + ca.SX(np.asarray(D)) @ self.rate(gap)
        self.soft.append(R.T @ own @ pull)
        self.tips.append(("soft", len(self.soft) - 1))

    @cached_property
    def parts(self):
        """The system and what else is read, as a function of numbers."""
        x, v, t = self.x, self.v, self.t
        momentum = ca.gradient(self.kinetic, v)
        drift = ca.jtimes(momentum, x, v) + ca.jacobian(momentum, t)
        force = (
            ca.gradient(self.kinetic - self.potential, x) - drift - ca.gradient(self.rayleigh, v) + self.push
        )
        gap = ca.vertcat(ca.SX(0, 1), *self.gaps)
        G = ca.jacobian(gap, x)
        rate = G @ v + ca.jacobian(gap, t)
        bias = ca.jacobian(rate, x) @ v + ca.jacobian(rate, t)
        energy = self.kinetic + self.potential
        slopes = [ca.gradient(energy, x), ca.gradient(energy, v), ca.jacobian(energy, t)]
        lost = ca.dot(ca.gradient(self.rayleigh, v) - self.push, v) + ca.jacobian(self.rayleigh, self.flow)
        soft = ca.horzcat(ca.SX(3, 0), *self.soft)
        given = [x, v, t, self.flow, self.start, self.base, self.forces]
        found = [ca.jacobian(momentum, v), force, G, bias, gap, rate, energy, *slopes, lost, soft]
        return ca.Function("lagrange", given, found)

    def __call__(self, state, forces, base=None):
        """The accelerations at one state that names all joints, under forces (m,)."""
        R, (x, v) = np.asarray(state.rotation), self.coordinates(state)
        ground = [np.zeros(3), np.eye(3).T.reshape(-1), np.zeros(12)]
        if base is not None:
            ground = [base.position, np.asarray(base.rotation).T.reshape(-1), base.twist, base.acceleration]
        start = np.concatenate([state.position, R.T.reshape(-1)])
        found = self.parts(x, v, 0.0, 1.0, start, np.concatenate(ground), forces)
        M, force, G, bias, gap, rate, energy, by_x, by_v, by_t, lost, soft = (
            np.array(part) for part in found
        )
        k = len(G)
        system = np.block([[M, -G.T], [G, np.zeros((k, k))]])
        found = np.linalg.lstsq(system, np.concatenate([force, -bias])[:, 0], rcond=1e-14)[0]
        xdd, pulls = found[: len(x)], found[len(x) :].reshape(-1, 3)
        of_tips = [soft[:, n] if kind == "soft" else -R.T @ pulls[n] for kind, n in self.tips]
        legs = np.split(xdd[self.first[0] :], self.first[1:-1] - self.first[0])
        counts = [len(leg.joints) for leg in self.robot.legs]
        return Answer(
            np.concatenate([R.T @ xdd[:3], xdd[3:6]]),
            xdd[6 : 6 + self.N],
            np.array(of_tips),
            [leg[:n] for leg, n in zip(legs, counts, strict=True)],
            [leg[n:] for leg, n in zip(legs, counts, strict=True)],
            float(energy[0, 0]),
            float(by_x[:, 0] @ v + by_v[:, 0] @ xdd + by_t[0, 0] + lost[0, 0]),
            float(np.max(np.abs(gap), initial=0.0)),
            float(np.max(np.abs(rate), initial=0.0)),
        )

    def coordinates(self, state):
        """x and v (n,) of a state."""
        R, twist, still = np.asarray(state.rotation), np.asarray(state.twist), np.zeros(self.N)
        x, v = [np.zeros(6), still + state.elastic], [R @ twist[:3], twist[3:], still + state.elastic_rate]
        for i, leg in enumerate(self.robot.legs):
            count = sum(leg.modes) + len(drives(leg))
            for parts, q, e in (
                (x, state.joints, state.leg_elastic),
                (v, state.joint_rates, state.leg_elastic_rate),
            ):
                bend = np.zeros(count) if e is None or e[i] is None else e[i]
                parts += [q[i], bend]
        return np.concatenate(x), np.concatenate(v)


def errors(answer, model, state, forces, base=None):
    """The largest error of each part of the direct model's answer, relative to the oracle's largest entry."""
    found = model.direct(state, forces) if base is None else model.direct(state, forces, base=base)
    held = [tip.attachment for leg in model.robot.legs for tip in leg.tips]
    pairs = {
        "platform": (found.platform, answer.platform),
        "elastic": (found.elastic, answer.elastic),
        "joints": (np.concatenate(found.leg_joints), np.concatenate(answer.joints)),
        "leg_elastic": (np.concatenate(found.leg_elastic), np.concatenate(answer.leg_elastic)),
        "contact": (found.contact_forces[held], answer.contact),
    }
    return {
        name: float(np.max(np.abs(a - b), initial=0.0) / np.max(np.abs(b), initial=1e-300))
        for name, (a, b) in pairs.items()
    }
