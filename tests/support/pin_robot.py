"""A sample with a rigid platform as a Pinocchio model: legs and a free body, held together at the tips."""

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from oracle import screw
from rewriting import pose
from sample import Sample


class Motion(NamedTuple):
    """V̇_p (S, 6), q̈ (S, n) of all legs side by side, and the forces of the tips on the platform (S, k, 3) by
    attachment, as `Model.direct` has them."""

    platform: np.ndarray
    qdd: np.ndarray
    contact_forces: np.ndarray


def inertia(M: float, MS, inertia_at_origin) -> pin.Inertia:
    """Pinocchio's inertia from mass, first moment and the tensor about the frame's origin."""
    com = np.asarray(MS) / M if M else np.zeros(3)
    at_com = np.asarray(inertia_at_origin) - M * (com @ com * np.eye(3) - np.outer(com, com))
    return pin.Inertia(float(M), com, at_com)


def fixed(R, p) -> pin.SE3:
    return pin.SE3(np.asarray(R, dtype=float), np.asarray(p, dtype=float))


def depth_first(leg) -> list[int]:
    """Joint numbers (from 1) such that every branch is finished before the next, which Pinocchio needs."""
    order: list[int] = []
    stack = [0]
    while stack:
        number = stack.pop()
        order.append(number)
        stack += [j for j, joint in enumerate(leg.joints, start=1) if joint.antecedent == number][::-1]
    return order[1:]


class PinRobot:
    """The model, where its joints are, and its 3-D contacts."""

    def __init__(self, sample: Sample, floating: bool = False) -> None:
        """With a floating base the legs hang on a second free flyer, which has no mass."""
        self.sample, self.model, self.base = sample, pin.Model(), 0
        self.model.gravity.linear = np.asarray(sample.gravity, dtype=float)
        moments = sample.body.moments
        tensor = np.trace(moments.P0) * np.eye(3) - moments.P0
        self.platform = self.model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "platform")
        self.model.appendBodyToJoint(
            self.platform, inertia(moments.m, moments.MS0, tensor), pin.SE3.Identity()
        )
        if floating:
            self.base = self.model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "base")
        legs = [self.add_leg(number, leg) for number, leg in enumerate(sample.legs)]
        self.places = np.array([self.model.joints[j].idx_v for leg in legs for j in leg])
        armature = np.zeros(self.model.nv)
        armature[self.places] = [joint.IA for leg in sample.legs for joint in leg.joints]
        self.model.armature = armature
        self.contacts = pin.StdVec_RigidConstraintModel()
        self.attachments = [tip.attachment for leg in sample.legs for tip in leg.tips]
        held = sample.body.attachment_points
        for leg, numbers in zip(sample.legs, legs, strict=True):
            for tip in leg.tips:
                ends = self.platform, fixed(np.eye(3), held[tip.attachment])
                ends += numbers[tip.frame - 1], fixed(np.eye(3), tip.offset)
                kind, axes = pin.ContactType.CONTACT_3D, pin.ReferenceFrame.LOCAL
                self.contacts.append(pin.RigidConstraintModel(kind, self.model, *ends, axes))

    def add_leg(self, number: int, leg) -> list[int]:
        """Pinocchio's numbers of the leg's joints, in the order of the leg."""
        known = {0: self.base}
        for j in depth_first(leg):
            joint = leg.joints[j - 1]
            row = screw(2, joint.gamma, joint.b) @ screw(0, joint.alpha, joint.d)
            row = row @ screw(2, joint.theta, joint.r)
            if joint.antecedent == 0:
                row = pose(leg.rotation, leg.origin) @ row
            kind = pin.JointModelPZ() if joint.sigma else pin.JointModelRZ()
            place = fixed(row[:3, :3], row[:3, 3])
            known[j] = self.model.addJoint(known[joint.antecedent], kind, place, f"leg {number} joint {j}")
            body = inertia(joint.M, joint.MS, joint.I)
            self.model.appendBodyToJoint(known[j], body, pin.SE3.Identity())
        return [known[j] for j in range(1, len(leg.joints) + 1)]

    def direct(self, settings: pin.ProximalSettings | None = None) -> Motion:
        """`pin.constraintDynamics` at every state of the sample; joint friction and springs are loads."""
        sample, found = self.sample, []
        actuated = self.places[[bool(joint.mu) for leg in sample.legs for joint in leg.joints]]
        for s, forces in enumerate(sample.forces):
            state = sample.platform[s]
            R, twist = np.asarray(state.rotation), np.asarray(state.twist)
            q, qd, load = np.zeros(self.model.nq), np.zeros(self.model.nv), np.zeros(self.model.nv)
            q[:7] = [*state.position, *pin.Quaternion(R).coeffs()]
            q[self.places + 1] = np.concatenate([leg[s] for leg in sample.q])
            qd[:6], qd[self.places] = twist, np.concatenate([leg[s] for leg in sample.qd])
            load[actuated] = forces
            load[self.places] -= passive(sample, q[self.places + 1], qd[self.places])
            qdd, f = self.accelerations(q, qd, load, settings)
            Vd = qdd[:6] + np.concatenate([np.cross(twist[3:], twist[:3]), np.zeros(3)])
            by_attachment = np.zeros((len(sample.body.attachments), 3))
            by_attachment[self.attachments] = f
            found.append(Motion(Vd, qdd[self.places], by_attachment))
        return Motion(*(np.array(field) for field in zip(*found, strict=True)))

    def accelerations(self, q, qd, load, settings) -> tuple[np.ndarray, list[np.ndarray]]:
        """q̈ and the contact forces of one state."""
        data, contacts = self.model.createData(), pin.StdVec_RigidConstraintData()
        for contact in self.contacts:
            contacts.append(contact.createData())
        pin.initConstraintDynamics(self.model, data, self.contacts, contacts)
        more = () if settings is None else (settings,)
        qdd = pin.constraintDynamics(self.model, data, q, qd, load, self.contacts, contacts, *more)
        return qdd.copy(), [contact.contact_force.linear.copy() for contact in contacts]


def passive(sample: Sample, q, qd) -> np.ndarray:
    """Friction and springs of all joints."""
    joints = [joint for leg in sample.legs for joint in leg.joints]
    Fv, Fs, v_s, k, q_0 = np.array([(j.Fv, j.Fs, j.v_s, j.k, j.q_0) for j in joints]).T
    return Fv * qd + Fs * qd / np.sqrt(qd**2 + v_s**2) + k * (q - q_0)
