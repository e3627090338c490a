"""MuJoCo (Apache 2.0): rigid platforms, legs tied to the plate by soft `connect` constraints."""

import mujoco
import numpy as np

from benchmarks.rivals.base import Rival, Task, actuated, joints_at
from oracle import screw
from pin_robot import depth_first
from sample import Sample

HARDEST = 0.9999  # mjMAXIMP: of a closure's acceleration this part is enforced, the rest is soft
SOLIMP = [HARDEST, HARDEST, 1.0, 0.5, 2.0]


class Mujoco(Rival):
    """Body frames are the link frames; the actuators' forces are applied to the joints as they are."""

    name = "MuJoCo"
    tolerance = 1e-2  # soft closures
    remark = (
        f"has soft closures, here at the largest impedance that it allows, {HARDEST}: in the direct model "
        "1e-4 of each closure's inverse inertia yields to its force; mj_inverse cannot tell actuators from "
        "closures, so the inverse model is made of its Jacobian, mass matrix and bias in NumPy, closures hard"
    )

    def __init__(self, sample: Sample) -> None:
        super().__init__(sample)
        spec = mujoco.MjSpec()
        spec.compiler.autolimits = False
        spec.compiler.boundmass, spec.compiler.boundinertia = 0.0, 0.0
        spec.option.gravity = sample.gravity
        plate = spec.worldbody.add_body(name="platform")
        plate.add_freejoint()
        moments = sample.body.moments
        give(plate, moments.m, moments.MS0, np.trace(moments.P0) * np.eye(3) - moments.P0)
        for number, leg in enumerate(sample.legs):
            add_leg(spec, number, leg, sample.body.attachment_points)
        self.model = spec.compile()
        option = self.model.opt
        option.disableflags = mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT
        option.disableflags |= mujoco.mjtDisableBit.mjDSBL_SENSOR | mujoco.mjtDisableBit.mjDSBL_ACTUATION
        option.enableflags = mujoco.mjtEnableBit.mjENBL_DIAGEXACT
        option.jacobian, option.solver = mujoco.mjtJacobian.mjJAC_DENSE, mujoco.mjtSolver.mjSOL_NEWTON
        option.tolerance = 1e-14
        named = [
            self.model.joint(f"{number} {j}")
            for number, leg in enumerate(sample.legs)
            for j in range(1, len(leg.joints) + 1)
        ]
        self.q_at = np.array([joint.qposadr[0] for joint in named])
        self.v_at = np.array([joint.dofadr[0] for joint in named])
        self.driven = self.v_at[actuated(sample)]

    def state(self, s: int) -> mujoco.MjData:
        """Positions and velocities; those of a free joint are in world axes, ω in the body's."""
        data, state = mujoco.MjData(self.model), self.sample.platform[s]
        q, qd = joints_at(self.sample, s)
        R, twist = np.asarray(state.rotation), np.asarray(state.twist)
        data.qpos[:3] = state.position
        mujoco.mju_mat2Quat(data.qpos[3:7], R.ravel())
        data.qpos[self.q_at], data.qvel[self.v_at] = q, qd
        data.qvel[:3], data.qvel[3:6] = R @ twist[:3], twist[3:]
        return data

    def direct(self, s: int) -> dict[str, Task]:
        data, R = self.state(s), np.asarray(self.sample.platform[s].rotation)
        data.qfrc_applied[self.driven] = self.sample.forces[s]
        answer = lambda: np.concatenate([R.T @ data.qacc[:3], data.qacc[3:6]])  # noqa: E731
        return {"mj_forward": Task(lambda: mujoco.mj_forward(self.model, data), answer)}

    def inverse(self, s: int) -> dict[str, Task]:
        """With T = ∂(all rates)/∂V_p from the closures' Jacobian: (Tᵀ S) Γ = Tᵀ (M q̈ + bias).

        On the closure the reference acceleration that MuJoCo wants is −J̇q̇: hard closures, no softness left.
        """
        model, data, legs = self.model, self.state(s), self.v_at
        R, wanted = np.asarray(self.sample.platform[s].rotation), self.sample.target[s]
        T, qdd, load = np.zeros((model.nv, 6)), np.zeros(model.nv), np.zeros(model.nv)
        T[:3, :3], T[3:6, 3:] = R, np.eye(3)
        qdd[:6] = np.concatenate([R @ wanted[:3], wanted[3:]])
        kept, columns = np.zeros(len(self.driven)), len(legs)

        def call() -> None:
            mujoco.mj_fwdPosition(model, data)
            mujoco.mj_fwdVelocity(model, data)
            J = data.efc_J.reshape(-1, model.nv)
            known = np.empty((columns, 7))
            known[:, :6] = J[:, :6] @ T[:6]
            known[:, 6] = J[:, :6] @ qdd[:6] - data.efc_aref
            solved = np.linalg.solve(J[:, legs], -known)
            T[legs], qdd[legs] = solved[:, :6], solved[:, 6]
            mujoco.mj_mulM(model, data, load, qdd)
            load[:] += data.qfrc_bias
            kept[:] = np.linalg.solve(T[self.driven].T, T.T @ load)

        return {"mj_fwdVelocity, efc_J, NumPy": Task(call, kept.copy)}


def give(body: "mujoco.MjsBody", mass: float, MS: np.ndarray, inertia: np.ndarray) -> None:
    """Mass, first moment and the tensor about the frame's origin."""
    com = np.asarray(MS) / mass
    at_com = np.asarray(inertia) - mass * (com @ com * np.eye(3) - np.outer(com, com))
    body.mass, body.ipos, body.explicitinertial = mass, com, True
    body.fullinertia = [*np.diagonal(at_com), at_com[0, 1], at_com[0, 2], at_com[1, 2]]


def add_leg(spec: "mujoco.MjSpec", number: int, leg, held: np.ndarray) -> None:
    """The leg's tree, and its tips tied to the plate."""
    bodies = {0: spec.worldbody}
    base = np.eye(4)
    base[:3, :3], base[:3, 3] = leg.rotation, leg.origin
    for j in depth_first(leg):
        joint = leg.joints[j - 1]
        row = screw(2, joint.gamma, joint.b) @ screw(0, joint.alpha, joint.d)
        row = row @ screw(2, joint.theta, joint.r)
        row = base @ row if joint.antecedent == 0 else row
        quat = np.zeros(4)
        mujoco.mju_mat2Quat(quat, np.ascontiguousarray(row[:3, :3]).ravel())
        body = bodies[joint.antecedent].add_body(name=f"link {number} {j}", pos=row[:3, 3], quat=quat)
        kind = mujoco.mjtJoint.mjJNT_SLIDE if joint.sigma else mujoco.mjtJoint.mjJNT_HINGE
        body.add_joint(name=f"{number} {j}", type=kind, axis=[0, 0, 1], armature=joint.IA)
        give(body, joint.M, joint.MS, joint.I)
        bodies[j] = body
    for t, tip in enumerate(leg.tips):
        ends = f"tip {number} {t}", f"held {number} {t}"
        bodies[tip.frame].add_site(name=ends[0], pos=tip.offset)
        spec.body("platform").add_site(name=ends[1], pos=held[tip.attachment])
        tie = spec.add_equality(type=mujoco.mjtEq.mjEQ_CONNECT, objtype=mujoco.mjtObj.mjOBJ_SITE)
        tie.name1, tie.name2, tie.solimp = *ends, SOLIMP
