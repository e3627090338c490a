"""Forces and moments in the joints, against Newton and Euler for each link on its own."""

from functools import cache

import numpy as np
import pytest

import cases
import oracle
import parflex as pf
import zoo
from measures import relative
from rewriting import one_tree, reframed

LIBRARY = 1e-9  # the accuracy the library promises
DIFFERENCES = 1e-7  # what is left of h⁴ of sixth derivatives, and of round-off over h²

SAMPLES = {
    "paper": zoo.paper,
    "odd0": lambda: zoo.odd(0, 0),
    "odd3, 3 modes": lambda: zoo.odd(3, 3),
    "loads, 3 modes": lambda: zoo.ups(6, 3, loads=True),
    "limber": lambda: zoo.ups(6, 0, limber=True),
    **{f"{n}-flex with loads": lambda n=n: zoo.with_loads(cases.case(n, "flex")) for n in cases.NAMES},
    "rus6 otherwise": lambda: reframed(cases.case("rus6", "rigid")),
    "delta3 as one tree": lambda: one_tree(cases.case("delta3", "rigid")),
}


@cache
def sample_of(name):
    return SAMPLES[name]()


@cache
def model_of(name):
    return pf.Model(sample_of(name).robot, "numpy")


@pytest.fixture(params=SAMPLES)
def name(request):
    return request.param


def test_along_the_axis(name):
    """S Γ − friction − spring − IA q̈, in the words of the oracle."""
    sample, model = sample_of(name), model_of(name)
    found = model.reactions(sample.states, sample.forces)
    qdd = model.joint_accelerations(sample.states, sample.forces)
    first = 0
    for i, leg in enumerate(sample.legs):
        driven = [joint.mu for joint in leg.joints]
        forces = np.zeros((len(sample.forces), len(driven)))
        forces[:, np.flatnonzero(driven)] = sample.forces[:, first : first + sum(driven)]
        first += sum(driven)
        loads = np.array([oracle.joint_loads(leg, *at) for at in zip(sample.q[i], sample.qd[i], strict=True)])
        rotors = [joint.IA for joint in leg.joints] * qdd[i]
        slides = np.array([joint.sigma for joint in leg.joints])
        axial = np.where(slides, found.force[i][..., 2], found.moment[i][..., 2])
        assert relative(axial, forces - loads - rotors) <= LIBRARY


def test_each_link_on_its_own(name):
    """What a link receives through its joint is its own inertia, less its weight, and what it hands on to
    other links and the platform. Inertia by differences of the oracle's trees along q + t q̇ + t² q̈/2."""
    sample, model = sample_of(name), model_of(name)
    found = model.reactions(sample.states, sample.forces)
    qdd, direct = sample.direct.qdd, sample.direct
    for s in (0, 2):
        R = sample.platform.rotation[s]
        for i, leg in enumerate(sample.legs):
            forces, moments = links_alone(leg, sample.q[i][s], sample.qd[i][s], qdd[i][s], sample.gravity)
            turns, tips, _ = oracle.tree(leg, sample.q[i][s])
            o = origins(leg, sample.q[i][s])
            force = np.einsum("jab,jb->ja", turns, found.force[i][s])
            moment = np.einsum("jab,jb->ja", turns, found.moment[i][s])
            for j, joint in enumerate(leg.joints):
                if joint.antecedent:
                    a = joint.antecedent - 1
                    forces[a] += force[j]
                    moments[a] += moment[j] + np.cross(o[j] - o[a], force[j])
            for tip, place in zip(leg.tips, tips, strict=True):
                push, a = R @ direct.contact_forces[s, tip.attachment], tip.frame - 1
                forces[a] += push
                moments[a] += np.cross(place - o[a], push)
            assert relative(force, forces) <= DIFFERENCES
            assert relative(moment, moments) <= DIFFERENCES


def origins(leg, q):
    """World places (n, 3) of the link frames."""
    tips = tuple(pf.Tip(j + 1) for j in range(len(leg.joints)))
    return oracle.tree(pf.Leg(leg.rotation, leg.origin, leg.joints, tips), q)[1]


def links_alone(leg, q, qd, qdd, gravity):
    """Forces and moments about the links' origins (n, 3), in the world, that links need for their motion:
    d²/dt² (M o + R MS) − M g and d/dt (R I Rᵀ ω) + R MS × (ö − g)."""
    h = 2e-3
    steps = h * np.arange(-3, 4)
    path = [q + t * qd + 0.5 * t * t * qdd for t in steps]
    R = np.array([oracle.tree(leg, at)[0] for at in path])
    o = np.array([origins(leg, at) for at in path])
    M = np.array([joint.M for joint in leg.joints])
    MS = np.array([joint.MS for joint in leg.joints])
    inertia = np.array([joint.I for joint in leg.joints])
    second = np.array([2, -27, 270, -490, 270, -27, 2]) / (180 * h * h)
    first = np.array([-1, 9, -45, 0, 45, -9, 1]) / (60 * h)
    levers = np.einsum("tjab,jb->tja", R, MS)
    force = np.tensordot(second, M[:, None] * o + levers, 1) - M[:, None] * gravity
    turning, bending = np.tensordot(first, R, 1), np.tensordot(second, R, 1)
    omega, R = hat_of(turning @ np.swapaxes(R[3], 1, 2)), R[3]
    omegad = hat_of(bending @ np.swapaxes(R, 1, 2) + turning @ np.swapaxes(turning, 1, 2))
    world = R @ inertia @ np.swapaxes(R, 1, 2)
    spin = np.einsum("jab,jb->ja", world, omega)
    moment = np.einsum("jab,jb->ja", world, omegad) + np.cross(omega, spin)
    acceleration = np.tensordot(second, o, 1) - gravity
    return force, moment + np.cross(levers[3], acceleration)


def hat_of(A):
    """a (…, 3) of the antisymmetric part â."""
    A = 0.5 * (A - np.swapaxes(A, -1, -2))
    return np.stack([A[..., 2, 1], A[..., 0, 2], A[..., 1, 0]], axis=-1)


@pytest.mark.parametrize("which", [*((name, "flex") for name in cases.NAMES), "paper"])
def test_the_base_carries_the_weight(which):
    """At rest in equilibrium: forces, and moments about the world's origin, of all legs and the platform."""
    sample = zoo.paper() if which == "paper" else cases.case(*which)
    model = pf.Model(sample.robot, "numpy")
    state, forces = model.equilibrium(*model.robot.home_pose)
    found, q = model.reactions(state, forces), model.joints(state).q
    body, g = sample.body, sample.gravity
    if which == "paper":
        total, first = body.moments.m * g, np.cross(state.position, body.moments.m * g)
        first = first + np.cross(state.rotation @ body.moments.MS0, g)
    else:
        bent = sample.cloud.positions + np.einsum("n,nka->ka", state.elastic, sample.cloud.shapes)
        places, m = state.position + bent @ state.rotation.T, sample.cloud.masses[:, None]
        total, first = np.sum(m * g, axis=0), np.sum(np.cross(places, m * g), axis=0)
    for i, leg in enumerate(sample.legs):
        turns, o = oracle.tree(leg, q[i])[0], origins(leg, q[i])
        for j, joint in enumerate(leg.joints):
            weight = joint.M * g
            total = total + weight
            first = first + np.cross(o[j], weight) + np.cross(turns[j] @ joint.MS, g)
            if not joint.antecedent:
                force = turns[j] @ found.force[i][j]
                total = total + force
                first = first + turns[j] @ found.moment[i][j] + np.cross(o[j], force)
    weight = np.linalg.norm(body.moments.m * g)
    assert np.max(np.abs(total)) <= 1e-9 * weight
    assert np.max(np.abs(first)) <= 1e-9 * weight


@pytest.mark.parametrize("which", ["paper", "delta3-flex with loads", "rus6 otherwise"])
def test_batches_of_states_forces_and_wrenches(which):
    """Axes that only one of them has; each entry is that of a single call."""
    sample, model = sample_of(which), model_of(which)
    forces = np.random.default_rng(0).uniform(-50, 50, (3, 1, sample.forces.shape[1]))
    push = pf.Wrench(0, np.random.default_rng(1).uniform(-9, 9, (2, 3)))
    one = sample.states[1]
    many, qdd = model.reactions(one, forces, [push]), model.joint_accelerations(one, forces, [push])
    for i, leg in enumerate(sample.legs):
        assert many.force[i].shape == (3, 2, len(leg.joints), 3)
        assert qdd[i].shape == (3, 2, len(leg.joints))
    alone = [pf.Wrench(0, push.force[1])]
    single = model.reactions(one, forces[2, 0], alone)
    single_qdd = model.joint_accelerations(one, forces[2, 0], alone)
    for i in range(len(sample.legs)):
        assert relative(many.force[i][2, 1], single.force[i]) <= LIBRARY
        assert relative(many.moment[i][2, 1], single.moment[i]) <= LIBRARY
        assert relative(qdd[i][2, 1], single_qdd[i]) <= LIBRARY
    several = model.reactions(sample.states[:2], forces[2, 0])
    assert relative(several.force[0][1], model.reactions(one, forces[2, 0]).force[0]) <= LIBRARY
