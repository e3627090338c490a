"""The oracle and the library against stored reference cases, and the same robots written otherwise."""

from dataclasses import replace
from functools import cache
from itertools import combinations

import numpy as np
import pytest

import cases
import oracle
import parflex as pf
from cases import KINDS, NAMES
from measures import actuated, relative
from parflex.mechanics import chain
from parflex.mechanics.platform import platform_terms
from parflex.model.core import core_of
from parflex.views.sketch import sketch
from rewriting import REWRITINGS, one_tree, reframed
from sample import FIELDS, Sample, with_joints

# Soft platforms have states in which they accelerate against their actuators; the library says so.
pytestmark = pytest.mark.filterwarnings("ignore:.*beyond a dynamic singularity")

# The cases were computed in 80 bits; the scaled condition of their systems is below 20.
ORACLE = 1e-11  # two solutions in 64 bits: round-off leaves 1e-13
LIBRARY = 1e-9  # the accuracy the library promises; round-off leaves 1e-12
STILL = 1e-9  # what is left of gravity's m/s² and of K q_e / m where all is in balance
RUN = 1e-8  # over half a second at rtol 1e-11; the stored runs are good to 1e-9 and better
CLOSED = 1e-10  # m and m/s: the simulator projects onto the closure

BACKENDS = ("numpy", "vm")
ANSWERS = {
    "platform": "platform",
    "elastic": "elastic",
    "forces": "forces",
    "contact_forces": "contact_platform",
}


@pytest.fixture(params=[(name, kind) for name in NAMES for kind in KINDS], ids="-".join)
def which(request):
    """Name and kind of a case."""
    return request.param


@cache
def model(name: str, kind: str, backend: str) -> pf.Model:
    return pf.Model(cases.case(name, kind).robot, backend)


def errors_of(word, answer, stored):
    """Errors of a direct or inverse model's answer against what is stored of it."""
    keys = {field: f"{word}_{key}" for field, key in ANSWERS.items() if hasattr(answer, field)}
    return {
        key: relative(getattr(answer, field), stored[key]) for field, key in keys.items() if key in stored
    }


def in_its_size(found, expected):
    """The error of what is small, such as a bend, in parts of its largest value."""
    size = np.max(np.abs(expected), initial=1e-300)
    return relative(np.asarray(found) / size, np.asarray(expected) / size)


def check(errors, tolerance, at_least=1):
    """All errors below the tolerance, and as many of them as there are things to compare."""
    assert len(errors) >= at_least, errors
    assert max(errors.values()) <= tolerance, errors


# --- the oracle ---


def test_oracle_reproduces_case(which):
    """Direct and inverse models, with joint accelerations."""
    sample, stored = cases.case(*which), cases.arrays(*which)
    errors = errors_of("direct", sample.direct, stored) | errors_of("inverse", sample.inverse, stored)
    for word, answer in {"direct": sample.direct, "inverse": sample.inverse}.items():
        if f"{word}_qdd" in stored:
            errors[f"{word}_qdd"] = relative(np.stack(answer.qdd, axis=1), stored[f"{word}_qdd"])
    check(errors, ORACLE, at_least=6)


def test_oracle_reproduces_leg_and_platform_models(which):
    """A, b, J, J̇q̇ of each leg and M, c of the platform, which the oracle has in world axes."""
    sample, stored = cases.case(*which), cases.arrays(*which)
    found = {"leg_A": [], "leg_c": [], "leg_J": [], "leg_Jdqd": [], "platform_M": [], "platform_c": []}
    for s in range(len(sample.forces)):
        joints = [(leg, q[s], qd[s]) for leg, q, qd in zip(sample.legs, sample.q, sample.qd, strict=True)]
        terms = zip(*(oracle.leg_dynamics(*leg, sample.gravity) for leg in joints), strict=True)
        for name, values in zip(("leg_A", "leg_c", "leg_J", "leg_Jdqd"), terms, strict=True):
            found[name].append(np.array(values))
        M, c = sample.cloud.dynamics(sample.platform[s], sample.gravity)
        turn = np.eye(len(M))
        turn[:3, :3] = turn[3:6, 3:6] = sample.platform[s].rotation
        found["platform_M"].append(turn.T @ M @ turn)
        found["platform_c"].append(turn.T @ c)
    check({k: relative(np.array(v), stored[k]) for k, v in found.items() if k in stored}, ORACLE, at_least=5)


def test_states_are_on_the_closure(which):
    sample = cases.case(*which)
    for s, q in enumerate(zip(*sample.q, strict=True)):
        assert max(sample.open(sample.platform[s], q)) <= 1e-14


@pytest.mark.parametrize("rewriting", REWRITINGS)
def test_rewritten_robot_is_the_same_robot(which, rewriting):
    """By the oracle; at other joint values it would not be."""
    sample = cases.case(*which)
    other = rewriting(sample)
    for found, wanted in ((other.direct, sample.direct), (other.inverse, sample.inverse)):
        errors = {name: relative(getattr(found, name), getattr(wanted, name)) for name in ANSWERS}
        errors["qdd"] = relative(
            np.abs(np.concatenate(found.qdd, axis=-1)), np.abs(np.concatenate(wanted.qdd, axis=-1))
        )
        check(errors, ORACLE)
    tables = [[(j.gamma, j.b, j.theta, j.r) for j in leg.joints] for leg in other.legs]
    assert np.all(np.concatenate(tables)[:, 0] != 0)


# --- the library: its parts ---


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", NAMES)
def test_platform_model(name, kind):
    sample, stored = cases.case(name, kind), cases.arrays(name, kind)
    state, body = sample.platform, sample.body
    gravity = np.swapaxes(state.rotation, -1, -2) @ sample.gravity
    terms = platform_terms(body, state.twist[:, 3:], state.elastic, state.elastic_rate, gravity)
    M = [np.concatenate([terms.A_rr, terms.A_re], axis=-1)]
    m_ee = np.broadcast_to(body.m_ee, (len(gravity), *body.m_ee.shape))
    M += [np.concatenate([np.swapaxes(terms.A_re, -1, -2), m_ee], axis=-1)]
    errors = {"platform_M": relative(np.concatenate(M, axis=-2), stored["platform_M"])}
    if "platform_c" in stored:
        errors["platform_c"] = relative(np.concatenate([terms.c_r, terms.c_e], axis=-1), stored["platform_c"])
    check(errors, LIBRARY)


def test_leg_models(which):
    """A, c; J, J̇q̇ and the tips, turned into the world."""
    sample, stored = cases.case(*which), cases.arrays(*which)
    system = core_of(model(*which, "numpy")).system(sample.states)
    R = np.asarray(sample.platform.rotation)[:, None]
    errors = {}
    for number, leg in enumerate(system.legs):
        mine = list(leg.group.legs)
        rows = leg.J.reshape(*leg.J.shape[:-2], -1, 3, leg.J.shape[-1])
        drift = leg.Jdqd.reshape(*leg.Jdqd.shape[:-1], -1, 3)
        tips = [
            leg.group.origin + (leg.group.rotation @ chain.tip_position(leg.frames, tip)[..., None])[..., 0]
            for tip in leg.group.points(leg.joints.bend)
        ]
        found = {
            "leg_A": leg.A,
            "leg_c": leg.c,
            "leg_J": (R[:, :, None] @ rows).reshape(leg.J.shape),
            "leg_Jdqd": (R[:, :, None] @ drift[..., None]).reshape(leg.Jdqd.shape),
            "leg_tip": np.concatenate(tips, axis=-1),
        }
        errors |= {f"{k}[{number}]": relative(v, stored[k][:, mine]) for k, v in found.items()}
    check(errors, LIBRARY, at_least=5)


def test_energies(which):
    stored, numpy_model = cases.arrays(*which), model(*which, "numpy")
    kinetic, *potential = numpy_model.energies(cases.case(*which).states)
    errors = {"kinetic": relative(kinetic, stored["kinetic_energy"])}
    if "potential_energy" in stored:
        errors["potential"] = relative(sum(potential), stored["potential_energy"])
    check(errors, LIBRARY)


def test_joints(which):
    """Joint positions and rates from the platform, with the stored joints as a start and without any."""
    check_joints(cases.case(*which), model(*which, "numpy"))


def check_joints(sample, numpy_model):
    for state in (sample.states, sample.platform):
        legs = numpy_model.joints(state)
        check({f"q[{i}]": relative(q, sample.q[i]) for i, q in enumerate(legs.q)}, LIBRARY)
        check({f"qd[{i}]": relative(qd, sample.qd[i]) for i, qd in enumerate(legs.qd)}, LIBRARY)


# --- the library: its models ---


@pytest.mark.parametrize("backend", BACKENDS)
def test_direct_model(which, backend):
    """Accelerations and contact forces."""
    sample, stored = cases.case(*which), cases.arrays(*which)
    found = model(*which, backend).direct(sample.states, sample.forces)
    assert stored["contact_unique"]
    check(errors_of("direct", found, stored), LIBRARY, at_least=3)


@pytest.mark.parametrize("backend", BACKENDS)
def test_joint_accelerations(which, backend):
    sample, stored = cases.case(*which), cases.arrays(*which)
    qdd = model(*which, backend).joint_accelerations(sample.states, sample.forces)
    check({"direct_qdd": relative(np.stack(qdd, axis=1), stored["direct_qdd"])}, LIBRARY)


@pytest.mark.parametrize("backend", BACKENDS)
def test_inverse_model(which, backend):
    """Forces, and the accelerations and contact forces that go with them."""
    sample, stored = cases.case(*which), cases.arrays(*which)
    found = model(*which, backend).inverse(sample.states, sample.target, sample.output)
    check(errors_of("inverse", found, stored), LIBRARY, at_least=2)


@pytest.mark.parametrize("backend", BACKENDS)
def test_joints_need_not_be_given(which, backend):
    """The posture of each leg is start enough for these states."""
    sample, stored = cases.case(*which), cases.arrays(*which)
    found = model(*which, backend).direct(sample.platform, sample.forces)
    check(errors_of("direct", found, stored), LIBRARY, at_least=3)


@pytest.mark.parametrize("kind", ["rigid", "flex"])
@pytest.mark.parametrize("name", NAMES)
def test_stored_equilibrium_is_at_rest(name, kind):
    state, stored = equilibrium(name, kind)
    found = model(name, kind, "numpy").direct(state, stored["static_forces"])
    assert np.max(np.abs(found.platform)) <= STILL
    assert np.max(np.abs(found.elastic), initial=0.0) <= STILL
    check({"f": relative(found.contact_forces, stored["static_contact_platform"])}, LIBRARY)


@pytest.mark.parametrize("kind", ["rigid", "flex"])
@pytest.mark.parametrize("name", NAMES)
def test_static_equilibrium(name, kind):
    """Asked for at the pose of the stored one, which for three freedoms fits only with its bend."""
    wanted, stored = equilibrium(name, kind)
    state, forces = model(name, kind, "numpy").equilibrium(wanted.position, wanted.rotation)
    errors = {field: relative(getattr(state, field), getattr(wanted, field)) for field in FIELDS}
    errors["elastic"] = in_its_size(state.elastic, wanted.elastic)
    check(errors | {"forces": relative(forces, stored["static_forces"])}, LIBRARY)


def equilibrium(name, kind):
    """The stored equilibrium as a state, and the arrays it came from."""
    stored = cases.arrays(name, kind)
    q, bend = stored["static_q"], stored["static_elastic"]
    pose = pf.State(stored["static_position"], stored["static_rotation"], np.zeros(6), bend, 0 * bend)
    return with_joints(pose, q, 0 * q), stored


# --- runs ---


@cache
def run(name: str, kind: str):
    """The stored run again."""
    stored = cases.trajectory(name, kind)
    start = pf.State(*(stored[field][0] for field in FIELDS))
    start = with_joints(start, stored["q"][0], stored["qd"][0])
    virtual = model(name, kind, "vm")
    return pf.simulate(virtual, stored["forces"], start, stored["t"], rtol=1e-11, atol=1e-13)


@pytest.mark.parametrize("kind", ["rigid", "flex"])
@pytest.mark.parametrize("name", NAMES)
def test_run(name, kind):
    stored, result = cases.trajectory(name, kind), run(name, kind)
    assert not result.partial, result.stopped
    data = result.dataset
    errors = {field: relative(data[field].values, stored[field]) for field in FIELDS}
    errors["elastic"] = in_its_size(data.elastic.values, stored["elastic"])
    errors["joint"] = relative(data.joint.values, stored["q"])
    errors["kinetic"] = relative(data.energy_kinetic.values, stored["kinetic_energy"])
    potential = data.energy_gravity.values + data.energy_strain.values
    errors["potential"] = relative(potential, stored["potential_energy"])
    check(errors, RUN)


def opening(sample, data):
    """How far the legs are from the platform, in place or velocity, at each time of a run."""
    platform, joint = [data[field].values for field in FIELDS], data.joint.values
    times = range(data.sizes["time"])
    return [max(sample.open(pf.State(*(values[i] for values in platform)), joint[i])) for i in times]


@pytest.mark.parametrize("kind", ["rigid", "flex"])
@pytest.mark.parametrize("name", NAMES)
def test_run_stays_on_the_closure(name, kind):
    sample, data = cases.case(name, kind), run(name, kind).dataset
    assert max(opening(sample, data)) <= CLOSED


# --- legs whose joints are part of the state ---


@cache
def carried(name: str, kind: str, rewriting) -> Sample:
    return rewriting(cases.case(name, kind))


@cache
def carried_model(name: str, kind: str, rewriting, backend: str) -> pf.Model:
    return pf.Model(carried(name, kind, rewriting).robot, backend)


@pytest.mark.parametrize("rewriting", REWRITINGS)
@pytest.mark.parametrize("name", NAMES)
def test_rewritten_legs_are_carried(name, rewriting):
    """They have no closed form: the flat state holds q, q̇ of every joint."""
    sample = carried(name, "rigid", rewriting)
    x = carried_model(name, "rigid", rewriting, "numpy").compiled().pack(sample.states[0])
    assert len(x) == 13 + 2 * sum(len(leg.joints) for leg in sample.legs)


@pytest.mark.parametrize("rewriting", REWRITINGS)
def test_models_of_carried_legs(which, rewriting):
    check_carried(*which, rewriting, "numpy")


@pytest.mark.parametrize(
    ("name", "kind", "rewriting"),
    [*((name, "flex", reframed) for name in NAMES), ("rps3", "rigid", one_tree)],
)
def test_compiled_models_of_carried_legs(name, kind, rewriting):
    check_carried(name, kind, rewriting, "vm")


def check_carried(name, kind, rewriting, backend):
    """Direct and inverse models."""
    sample, stored = carried(name, kind, rewriting), cases.arrays(name, kind)
    found = carried_model(name, kind, rewriting, backend)
    direct = found.direct(sample.states, sample.forces)
    inverse = found.inverse(sample.states, sample.target, sample.output)
    check(errors_of("direct", direct, stored) | errors_of("inverse", inverse, stored), LIBRARY, at_least=5)


@pytest.mark.parametrize("rewriting", REWRITINGS)
def test_carried_joints(which, rewriting):
    """Joint positions, rates and accelerations; positions start from the postures."""
    sample = carried(*which, rewriting)
    numpy_model = carried_model(*which, rewriting, "numpy")
    check_joints(sample, numpy_model)
    qdd = numpy_model.joint_accelerations(sample.states, sample.forces)
    check({f"qdd[{i}]": relative(a, sample.direct.qdd[i]) for i, a in enumerate(qdd)}, LIBRARY)


@pytest.mark.parametrize("name", NAMES)
def test_run_of_carried_legs(name):
    """The first 0.1 s of the stored run of the rigid robot, with joints that are integrated and projected."""
    stored = {k: v[:21] for k, v in cases.trajectory(name, "rigid").items() if np.ndim(v) and len(v) == 101}
    sample = carried(name, "rigid", reframed)
    posture = [np.asarray(leg.posture) for leg in sample.legs]
    platform = pf.State(*(stored[field][0] for field in FIELDS))
    start = with_joints(platform, posture, oracle_rates(sample, platform, posture))
    virtual = carried_model(name, "rigid", reframed, "vm")
    forces = cases.trajectory(name, "rigid")["forces"]
    result = pf.simulate(virtual, forces, start, stored["t"], rtol=1e-11, atol=1e-13)
    assert not result.partial, result.stopped
    data = result.dataset
    check({field: relative(data[field].values, stored[field]) for field in FIELDS}, RUN)
    assert max(opening(sample, data)) <= CLOSED


def oracle_rates(sample, platform, q):
    """q̇ of each leg, from the tips."""
    velocities = sample.tip_motions(platform)[1]
    return [oracle.joint_rates(leg, *both) for leg, *both in zip(sample.legs, q, velocities, strict=True)]


# --- branches that states name ---


@pytest.mark.parametrize("name", NAMES)
def test_joints_of_a_state_name_the_branch(name):
    """Legs without a posture: the stored joints tell which way the elbows point, in every call."""
    sample, stored = cases.case(name, "rigid"), cases.arrays(name, "rigid")
    legs = tuple(replace(leg, posture=None) for leg in sample.robot.legs)
    bare = pf.Model(replace(sample.robot, legs=legs), "numpy")
    states = sample.states
    check(errors_of("direct", bare.direct(states, sample.forces), stored), LIBRARY, at_least=2)
    found = bare.inverse(states, sample.target, sample.output)
    check(errors_of("inverse", found, stored), LIBRARY, at_least=2)
    for q, expected in zip(bare.joints(states).q, sample.q, strict=True):
        assert relative(q, expected) <= LIBRARY
    assert relative(bare.project(states[0]).position, states[0].position) <= LIBRARY
    flat, out = bare.compiled(sample.output), np.zeros(6)
    flat.direct(flat.pack(states[1]), sample.forces[1].copy(), out)
    assert relative(out, stored["direct_platform"][1]) <= LIBRARY
    near = bare.forward(actuated(sample.robot, [q[2] for q in sample.q]), states[2])
    assert relative(near.position, states[2].position) <= LIBRARY
    lines = sketch(bare, states[3]).lines
    assert relative(lines, sketch(model(name, "rigid", "numpy"), states[3]).lines) <= LIBRARY
    moment = {"t": [0, 1e-3], "max_step": 1e-3}
    run = pf.simulate(bare, sample.forces[0], states[0], **moment)
    again = pf.simulate(model(name, "rigid", "numpy"), sample.forces[0], states[0], **moment)
    assert relative(run.dataset.position, again.dataset.position) <= LIBRARY
    assert (
        relative(bare.direct(run.state(1), sample.forces[0]).platform, run.dataset.acceleration[1]) <= LIBRARY
    )


def test_flat_models_go_from_branch_to_branch():
    """The stored elbows, those that legs without a posture have, and some of each: against the stored
    answer, and against models whose legs have them as postures."""
    sample, stored = cases.case("rus6", "rigid"), cases.arrays("rus6", "rigid")
    legs = tuple(replace(leg, posture=None) for leg in sample.robot.legs)
    bare, forces = pf.Model(replace(sample.robot, legs=legs), "numpy"), sample.forces[0].copy()
    state = replace(sample.states[0], joint_rates=None)
    own = bare.joints(replace(state, joints=None)).q
    assert all(relative(a, b) > 0.1 for a, b in zip(own, state.joints, strict=True))
    elbows = {"stored": state.joints, "own": own, "one": (state.joints[0], *own[1:])}
    wanted = {"stored": stored["direct_platform"][0]}
    for which in ("own", "one"):
        postures = tuple(replace(leg, posture=q) for leg, q in zip(legs, elbows[which], strict=True))
        stated = pf.Model(replace(sample.robot, legs=postures), "numpy")
        wanted[which] = stated.direct(replace(state, joints=None), forces).platform
    assert min(relative(a, b) for a, b in combinations(wanted.values(), 2)) > 1e-3
    flat, out = bare.compiled(sample.output), np.zeros(6)
    for which in ("stored", "own", "stored", "one", "own", "one", "stored"):
        flat.direct(flat.pack(replace(state, joints=elbows[which])), forces, out)
        assert relative(out, wanted[which]) <= LIBRARY
