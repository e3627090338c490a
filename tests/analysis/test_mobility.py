"""Freedoms and singularities, against counts by hand, screws of textbooks, and what small motions do."""

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.linalg import null_space, subspace_angles
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

import cases
import parflex as pf
import zoo
from rewriting import reframed

UPRIGHT = np.eye(3)
SAME = 1e-7  # rad, between spaces: round-off, and the root of it where joints follow the root of a pose


@cache
def model_of(name, backend="numpy", rewriting=None):
    sample = SAMPLES[name]()
    return pf.Model((sample if rewriting is None else rewriting(sample)).robot, backend)


SAMPLES = {
    "gough-stewart": zoo.paper,
    "8 legs": lambda: zoo.ups(8, 0),
    "8 legs, 3 modes": lambda: zoo.ups(8, 3),
    "limber": lambda: zoo.ups(6, 0, limber=True),
    "three rods": zoo.three_rods,
    **{
        f"{n}-{kind}": lambda n=n, kind=kind: cases.case(n, kind)
        for n in cases.NAMES
        for kind in ("rigid", "flex")
    },
}


# --- counts ---

COUNTS = {  # freedoms, internal, actuators, rows, rank: by hand
    "gough-stewart": (6, 0, 6, 18, 18),
    "8 legs": (6, 0, 8, 24, 24),
    "8 legs, 3 modes": (6, 0, 8, 24, 24),
    "limber": (6, 2, 6, 18, 18),
    "three rods": (3, 0, 3, 27, 24),
    "rus6-rigid": (6, 0, 6, 18, 18),
    "rps3-rigid": (3, 0, 3, 9, 9),
    "rps3-flex": (3, 0, 3, 9, 9),
    "delta3-rigid": (3, 0, 3, 18, 18),
    "delta3-flex": (3, 0, 3, 18, 18),
}


def counts(found):
    return found.freedoms, found.internal, found.actuators, found.rows, found.rank


@pytest.mark.parametrize("name", COUNTS)
def test_counts(name):
    """At home, and at a bent state in motion; none of these is singular."""
    model, sample = model_of(name), SAMPLES[name]()
    for state in (model.project(model.robot.home), sample.states[1]):
        found = model.mobility(state)
        assert counts(found) == COUNTS[name]
        assert found.redundant == found.rows - found.rank
        assert found.parallel.shape == (0, 6)
        assert found.serial.shape == (0, found.actuators)
        assert found.locked.shape == (6 - found.freedoms, 6)
    assert f"{COUNTS[name][0]} freedoms" in str(found)


@pytest.mark.parametrize("name", ["rps3-rigid", "delta3-rigid", "rus6-rigid"])
def test_counts_of_carried_legs(name):
    """The tables say otherwise what the robot is; it is the same robot."""
    model = model_of(name, "numpy", reframed)
    assert counts(model.mobility(model.robot.home)) == COUNTS[name]


def spinning(robot):
    """The robot with one more passive joint per leg, about the slider's axis, through the tip."""
    spin = pf.Joint(3, 0, M=0.1, I=np.diag([0.01, 0.01, 0.01]))
    legs = [
        replace(
            leg,
            joints=(*leg.joints, spin),
            tips=(replace(leg.tips[0], frame=4),),
            posture=(*leg.posture, 0.0),
        )
        for leg in robot.legs
    ]
    return replace(robot, legs=tuple(legs))


def test_rods_that_spin_between_two_balls():
    """Each leg of a 6-SPS turns about its own axis: six motions that leave the platform still."""
    sample = zoo.ups(6, 0)
    model = pf.Model(spinning(sample.robot), "numpy")
    found = model.mobility(model.robot.home)
    assert counts(found) == (6, 6, 6, 18, 18)
    assert "6 motions of their own" in str(found)
    plain = pf.Model(sample.robot, "numpy").inverse(sample.robot.home, np.zeros(6)).forces
    assert np.allclose(model.joints(model.robot.home).q[0][:3], sample.robot.legs[0].posture)
    assert np.allclose(
        model.inverse(model.robot.home, np.zeros(6)).forces, plain, rtol=0.05
    )  # lighter by 0.1 kg


def test_contact_forces_that_are_not_unique():
    """Those of the three parallel rods of each arm, by the null space of the oracle's closure."""
    sample, model = zoo.three_rods(), model_of("three rods")
    at = sample.systems[0]
    free = len(at.K) - at.sizes[-1]
    pressing = null_space(at.K[free:, :free].T, rcond=1e-9)
    by_tip = np.linalg.norm(pressing.reshape(-1, 3, pressing.shape[1]), axis=(1, 2)) > 1e-6
    held = sorted(tip.attachment for leg, used in zip(sample.legs, by_tip.reshape(3, 3), strict=True)
                  for tip, one in zip(leg.tips, used, strict=True) if one)  # fmt: skip
    found = model.mobility(sample.states[0])
    assert pressing.shape[1] == 3
    assert list(found.not_unique) == held
    assert "not unique" in str(found)
    assert model_of("gough-stewart").mobility(model_of("gough-stewart").robot.home).not_unique == ()


# --- what the legs carry ---


def test_wrenches_that_the_legs_of_a_3rps_carry():
    """Each leg keeps its tip in a plane: a force there, along its hinge (Huang's constraint wrenches)."""
    sample = cases.case("rps3", "rigid")
    for state in (sample.states[0], sample.states[5]):
        R, r = np.asarray(state.rotation), sample.body.attachment_points
        forces = hinges(sample) @ R
        wrenches = np.hstack([forces, np.cross(r, forces)])
        found = model_of("rps3-rigid").mobility(state).locked
        assert np.max(subspace_angles(found.T, wrenches.T)) <= SAME


def hinges(sample):
    """World axes (3, 3) of the first joints: z of the base frame after Rot(z, γ) Rot(x, α)."""
    turns = [
        Rotation.from_euler("ZX", [leg.joints[0].gamma, leg.joints[0].alpha]).as_matrix()
        for leg in sample.legs
    ]
    return np.array([leg.rotation @ turn[:, 2] for leg, turn in zip(sample.legs, turns, strict=True)])


def test_a_delta_carries_moments():
    """Three parallelograms keep the platform from turning: pure moments, of every direction."""
    found = model_of("delta3-rigid").mobility(cases.case("delta3", "rigid").states[3])
    assert np.max(np.abs(found.locked[:, :3])) <= 1e-12
    assert np.linalg.matrix_rank(found.locked[:, 3:]) == 3


# --- parallel singularities ---


def test_fichters_singularity():
    """At 90° of yaw the platform is free along z and about it at once: with feet at ± β, points at ± α and
    δ = α − β, leg i stretches at h v + ω R r sin(90° ± δ), which v = −ω R r cos δ / h makes zero."""
    R, r, h, beta, alpha = 0.9, 0.5, 0.8, 0.2, 0.7
    model = zoo.six_ups(R, r, h, beta, alpha, 90.0)
    home = model.robot.home
    found = model.mobility(home)
    assert counts(found) == (6, 0, 6, 18, 18)
    assert len(found.parallel) == 1
    assert len(found.serial) == 0
    twist = found.parallel[0] / found.parallel[0][5]
    assert np.allclose(twist, [0, 0, -R * r * np.cos(alpha - beta) / h, 0, 0, 1], rtol=0, atol=1e-9)
    with pytest.raises(pf.SingularPose, match="parallel singularity") as caught:
        model.inverse(home, np.zeros(6))
    printed = np.array(re.search(r"= \[(.*)\]", str(caught.value))[1].split(), dtype=float)
    assert np.allclose(printed / printed[5], twist, rtol=0, atol=2e-3)
    assert "Parallel singularity" in str(found)
    for yaw in (0.0, 60.0, 89.9):
        assert len(zoo.six_ups(R, r, h, beta, alpha, yaw).mobility(home_at(h, yaw)).parallel) == 0


def home_at(height, yaw):
    return pf.State((0, 0, height), Rotation.from_euler("z", yaw, degrees=True).as_matrix())


def test_freed_twists_are_motions():
    """A ring on a similar ring is free at every pose, by one twist at least: along it the legs' lengths
    change with the square of the step."""
    model = zoo.six_ups(0.9, 0.5, 0.8, np.pi / 6, np.pi / 6, 20.0)
    tilted = pf.State((0.05, -0.02, 0.8), Rotation.from_rotvec([0.1, 0.2, 0.3]).as_matrix())
    for state in (model.robot.home, tilted):
        twists = model.mobility(state).parallel
        assert len(twists) >= 1
        for twist in twists:
            changes = [np.max(np.abs(change_of_lengths(model, state, step * twist))) for step in (1e-3, 1e-4)]
            assert changes[1] <= 1e-2 * 1.05 * changes[0] + 1e-14
            assert changes[1] <= 1e-7


def change_of_lengths(model, state, step):
    R = np.asarray(state.rotation)
    moved = pf.State(state.position + R @ step[:3], R @ Rotation.from_rotvec(step[3:]).as_matrix())
    return np.array(model.joints(moved).q)[:, 2] - np.array(model.joints(state).q)[:, 2]


def test_singular_pose_in_a_batch_is_named():
    """Index and leg of a (2, 3) batch: parallel for the inverse model; the direct one has an answer."""
    model = zoo.six_ups(0.9, 0.5, 0.8, 0.2, 0.7, 90.0)
    yaws = np.array([[0.0, 20.0, 40.0], [60.0, 90.0, 70.0]])
    turns = Rotation.from_euler("z", yaws.reshape(-1, 1), degrees=True).as_matrix()
    states = pf.State((0, 0, 0.8), turns.reshape(2, 3, 3, 3))
    with pytest.raises(pf.SingularPose, match=r"pose at index \(1, 1\) is a parallel singularity"):
        model.inverse(states, np.zeros(6))
    assert model.direct(states, np.zeros(6)).platform.shape == (2, 3, 6)


# --- serial singularities ---


def stretched_rus():
    """A pose of the 6-RUS at which leg 1 is stretched: the point of the crank's circle next to the tip is a
    rod's length away from it. With it the rod, from there to the tip, in Σp."""
    sample = cases.case("rus6", "rigid")
    leg, point = sample.legs[0], sample.body.attachment_points[0]
    crank, rod = leg.joints[1].d, np.linalg.norm(leg.tips[0].offset)
    axis = hinges(sample)[0]
    lifted = np.cross(point, [0, 0, 1]) / np.linalg.norm(point)
    R = Rotation.from_rotvec(0.2 * lifted).as_matrix()

    def elbow_and_rod(z):
        u = np.array([0.0, 0.0, z]) + R @ point - leg.origin
        inward = u - (u @ axis) * axis
        return u - crank * inward / np.linalg.norm(inward)

    z = brentq(lambda z: np.linalg.norm(elbow_and_rod(z)) - rod, 0.5, 0.8, xtol=1e-15)
    return np.array([0.0, 0.0, z]), R, R.T @ elbow_and_rod(z)


@pytest.mark.parametrize("rewriting", [None, reframed])
def test_stretched_crank(rewriting):
    """The crank turns while the platform stands, and the rod's pull reaches no actuator. A pose beyond reach
    by round-off is still that pose, one beyond by 1e-5 m is not."""
    model, (place, R, rod) = model_of("rus6-rigid", "numpy", rewriting), stretched_rus()
    point = model.robot.platform.attachment_points[0]
    pull = np.append(rod, np.cross(point, rod))
    for z in (-1e-15, 0.0, 1e-15):
        found = model.mobility(pf.State(place + [0, 0, z], R))
        assert (found.freedoms, found.internal) == (5, 0)
        assert found.serial.shape == (1, 6)
        assert np.allclose(np.abs(found.serial), np.eye(6)[:1], atol=2e-6)
        assert np.max(subspace_angles(found.locked.T, pull[:, None])) <= 2e-6
        assert "Serial singularity" in str(found)
    near = model.mobility(pf.State(place - [0, 0, 1e-6], R))
    assert (near.freedoms, len(near.serial)) == (6, 0)
    with pytest.raises(pf.OutOfReach, match="leg 1"):
        model.mobility(pf.State(place + [0, 0, 1e-5], R))


def test_stretched_crank_has_no_model():
    model, (place, R, _) = model_of("rus6-rigid"), stretched_rus()
    batch = pf.State(np.stack([model.robot.home.position, place]), np.stack([UPRIGHT, R]))
    with pytest.raises(pf.InputError, match="pose at index 1: leg 1"):
        model.direct(batch, np.zeros(6))


# --- constraint singularities ---


def upside_down():
    """A flat 3-RPS turned over about x, its centre at (a, 0): where its two families of poses meet
    (Schadlbauer, Walter and Husty 2014). Tips at ρ_i r_i, Σ ρ_i = 0: the three constraint forces balance."""
    a = np.linalg.norm(cases.case("rps3", "rigid").body.attachment_points[0])
    return pf.State((a, 0.0, 0.6), np.diag([1.0, -1.0, -1.0]))


@pytest.mark.parametrize("kind", ["rigid", "flex"])
def test_constraint_singularity_of_a_3rps(kind):
    """Four freedoms and three actuators; the wrenches that are left are those of the tips' forces."""
    model, state = model_of(f"rps3-{kind}"), upside_down()
    sample = cases.case("rps3", kind)
    R, r = np.asarray(state.rotation), sample.body.attachment_points
    forces = hinges(sample) @ R
    wrenches = np.hstack([forces, np.cross(r, forces)])
    assert np.linalg.svd(wrenches, compute_uv=False)[2] <= 1e-12
    found = model.mobility(state)
    assert (found.freedoms, found.internal, found.rows) == (4, 0, 9)
    assert len(found.parallel) >= 1
    assert np.max(subspace_angles(found.locked.T, np.linalg.svd(wrenches)[2][:2].T)) <= SAME
    assert np.max(np.abs(wrenches @ found.parallel[0])) <= 1e-9


@pytest.mark.parametrize("backend", ["numpy", "vm"])
def test_constraint_singularity_has_no_direct_model(backend):
    """Nor a place in a simulation; in a batch it is named."""
    model, state = model_of("rps3-rigid", backend), upside_down()
    with pytest.raises(pf.SingularPose, match="pose is a constraint singularity"):
        model.direct(state, np.zeros(3))
    with pytest.raises(pf.SingularPose, match="pose is a constraint singularity"):
        model.inverse(state, np.zeros(3), pf.FrameOutput((2, 3, 4)))
    home = model.robot.home
    batch = pf.State(np.stack([home.position, state.position]), np.stack([home.rotation, state.rotation]))
    with pytest.raises(pf.SingularPose, match="pose at index 1 is a constraint singularity"):
        model.direct(batch, np.zeros(3))
    with pytest.raises(pf.SingularPose, match="constraint singularity"):
        pf.simulate(model, np.zeros(3), state, [0.0, 0.1])


# --- input ---


def test_mobility_takes_one_state():
    model = model_of("rps3-rigid")
    with pytest.raises(pf.InputError, match=r"state is a batch \(2,\)"):
        model.mobility(pf.State(np.stack([model.robot.home.position] * 2), UPRIGHT))
    with pytest.raises(pf.InputError, match="off the closure"):
        model.mobility(pf.State(model.robot.home.position + [0.01, 0, 0], UPRIGHT))
