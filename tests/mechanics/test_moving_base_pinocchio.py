"""A floor that moves against Pinocchio: the KKT system of legs on a free flyer that accelerates as given."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from scipy.spatial.transform import Rotation

import parflex as pf
import zoo
from measures import relative
from pin_robot import PinRobot, passive

AGREED = 1e-11  # two solutions in 64 bits
SAMPLES = {"paper": zoo.paper, "eight legs": lambda: zoo.ups(8, 0), "odd": lambda: zoo.odd(1, 0)}
WORLD = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED


def moving_base(seed):
    rng = np.random.default_rng(seed)
    R = Rotation.from_rotvec(rng.normal(size=3)).as_matrix()
    return pf.BaseMotion(rng.normal(size=3), R, rng.normal(size=6), 5.0 * rng.normal(size=6))


def placed(rotation, position, v, omega):
    """Configuration and velocity of a free flyer, from velocities in world axes."""
    q = [*position, *pin.Quaternion(rotation).coeffs()]
    return np.array(q), np.concatenate([rotation.T @ v, rotation.T @ omega])


def kkt(robot, base, s):
    """The state in the world, V̇_p, and contact forces in Σp leg by leg, of one state of the sample."""
    sample, model = robot.sample, robot.model
    R, (v, w), (a, wd) = base.rotation, np.split(base.twist, 2), np.split(base.acceleration, 2)
    local = sample.platform[s]
    rotation, away = R @ local.rotation, R @ np.asarray(local.position)
    speed = rotation @ local.twist[:3] + v + np.cross(w, away)
    spin = rotation @ local.twist[3:] + w
    q, qd, load = np.zeros(model.nq), np.zeros(model.nv), np.zeros(model.nv)
    joints = [joint for leg in sample.legs for joint in leg.joints]
    q[:7], qd[:6] = placed(rotation, base.position + away, speed, spin)
    q[7:14], qd[6:12] = placed(R, base.position, v, w)
    q[robot.places + 2] = np.concatenate([leg[s] for leg in sample.q])
    qd[robot.places] = np.concatenate([leg[s] for leg in sample.qd])
    load[robot.places[[bool(joint.mu) for joint in joints]]] = sample.forces[s]
    load[robot.places] -= passive(sample, q[robot.places + 2], qd[robot.places])
    data = model.createData()
    M = np.array(pin.crba(model, data, q))
    M = np.triu(M) + np.triu(M, 1).T
    nle = pin.nonLinearEffects(model, data, q, qd)
    pin.forwardKinematics(model, data, q, qd, np.zeros(model.nv))
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacements(model, data)
    J, drift = [], []
    for first, last in robot.ends:
        rows = [pin.getFrameJacobian(model, data, end, WORLD)[:3] for end in (first, last)]
        moved = [pin.getFrameClassicalAcceleration(model, data, end, WORLD).linear for end in (first, last)]
        J.append(rotation.T @ (rows[0] - rows[1]))  # in Σp
        drift.append(rotation.T @ (moved[0] - moved[1]))
    J, drift = np.vstack(J), np.concatenate(drift)
    given = np.concatenate([R.T @ a - np.cross(qd[9:12], qd[6:9]), R.T @ wd])  # Pinocchio's are spatial
    free = np.delete(np.arange(model.nv), np.arange(6, 12))
    A = np.block([[M[np.ix_(free, free)], -J[:, free].T], [J[:, free], np.zeros((len(J), len(J)))]])
    right = np.concatenate([(load - nle)[free] - M[free, 6:12] @ given, -drift - J[:, 6:12] @ given])
    found = np.linalg.lstsq(A, right, rcond=1e-14)[0]
    Vd = found[:6] + np.concatenate([np.cross(qd[3:6], qd[:3]), np.zeros(3)])
    state = replace(local, position=base.position + away, rotation=rotation, twist=qd[:6])
    return state, Vd, found[len(free) :].reshape(-1, 3)


@pytest.mark.parametrize("name", SAMPLES)
def test_six_components_at_any_rates(name):
    """Rigid platforms; the paper's robot, one of eight legs, one of odd legs, that carry their joints."""
    sample = SAMPLES[name]()
    robot = PinRobot(sample, floating=True)
    robot.ends = []
    for number, contact in enumerate(robot.contacts):
        ends = (contact.joint1_id, contact.joint1_placement), (contact.joint2_id, contact.joint2_placement)
        pair = [
            robot.model.addFrame(pin.Frame(f"{number}.{k}", joint, place, pin.FrameType.OP_FRAME))
            for k, (joint, place) in enumerate(ends)
        ]
        robot.ends.append(pair)
    model = pf.Model(pf.Robot(sample.legs, sample.body, sample.gravity, sample.home_pose), "numpy")
    for s in range(2):
        base = moving_base(s)
        state, Vd, f = kkt(robot, base, s)
        found = model.direct(state, sample.forces[s], base=base)
        assert relative(found.platform, Vd) <= AGREED
        assert relative(found.contact_forces[robot.attachments], f) <= AGREED
        back = model.inverse(state, Vd, base=base) if model.robot.n_forces == 6 else None
        assert back is None or relative(back.forces, sample.forces[s]) <= 1e-9
