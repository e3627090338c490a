"""Derivatives of the models: against CasADi's automatic differentiation through the solve, against
differences of the models, and against each other."""

import casadi
import numpy as np
import pytest

import chains
import parflex as pf
import zoo
from differences import by_column, difference, moved
from measures import random_forces, random_states, relative
from parflex.compiled.vm import trace
from parflex.kernels import models as kernels
from parflex.mechanics.redundancy import solvable
from parflex.model.core import core_of

EXACT = 1e-10  # two exact derivatives, in 64 bits
DIFFERENCES = 2e-6  # extrapolated central differences: of their own error

KINDS = {
    "8 legs, 3 modes": lambda: zoo.ups(8, 3),
    "loads, 3 modes": lambda: zoo.ups(6, 3, loads=True),
    "odd0, 0 modes": lambda: zoo.odd(0, 0),
    "odd1, 3 modes": lambda: zoo.odd(1, 3),
    "three rods": zoo.three_rods,
    "rps3": lambda: zoo.with_loads(zoo.cases.case("rps3", "flex")),
    "delta3": lambda: zoo.with_loads(zoo.cases.case("delta3", "flex")),
    "rus6": lambda: zoo.with_loads(zoo.cases.case("rus6", "flex")),
} | {str(kind): lambda kind=kind: chains.sample(kind, 2, 1) for kind in chains.some()[::3]}

pytestmark = pytest.mark.filterwarnings("ignore:.*beyond a dynamic singularity")


@pytest.mark.parametrize("modes", [0, 3])
@pytest.mark.parametrize("backend", ["numpy", "vm", "native"])
def test_against_automatic_differentiation(model_of, modes, backend):
    """CasADi differentiates the traced solve; its quaternion columns become rotation vectors."""
    model = model_of(modes, backend)
    state, forces = random_states(model.robot, 1, 3)[0], random_forces(model, 1, 4)[0]
    graph = trace(kernels.direct(solvable(model.robot)))
    x, u, w = (casadi.SX.sym(name, graph.numel_in(i)) for i, name in enumerate("xuw"))
    answer = casadi.vertcat(*graph(x, u, w)[:2])
    exact = casadi.Function("exact", [x, u, w], [casadi.jacobian(answer, v) for v in (x, u, w)])
    flat = core_of(model).flat(state)
    by_x, by_u, by_w = (np.array(a) for a in exact(flat, forces, np.zeros(6 + modes)))
    s, v = flat[3], flat[4:7]
    turn = 0.5 * np.vstack([-v, s * np.eye(3) + np.cross(v, np.eye(3)).T])
    expected = np.hstack([by_x[:, :3], by_x[:, 3:7] @ turn, by_x[:, 7:]])
    found = model.direct_jacobian(state, forces)
    assert by_column(found.state, expected) <= EXACT
    assert by_column(found.forces, by_u) <= EXACT
    assert by_column(found.load, by_w) <= EXACT


@pytest.mark.parametrize("kind", KINDS)
def test_direct_against_differences(kind):
    """On robots of any kind; every motion of the flat state, whether or not the closure allows it."""
    sample = KINDS[kind]()
    model = pf.Model(sample.robot, "numpy")
    run = core_of(pf.Model(sample.robot, "vm")).functions(kernels.direct)
    state, forces = sample.states[0], sample.forces[0]
    x = core_of(model).flat(state)

    def answer(flat, u):
        found = run(x=flat, forces=u)
        return np.concatenate([found["platform"], found["elastic"]])

    found = model.direct_jacobian(state, forces)
    expected = difference(lambda d: answer(moved(x, d), forces), found.state.shape[-1])
    assert by_column(found.state, expected) <= DIFFERENCES
    expected = difference(lambda d: answer(x, forces + d), len(forces), 1.0)
    assert by_column(found.forces, expected) <= EXACT


def test_wrenches_are_held_in_their_frame(model_of):
    """A force in world axes turns in those of the platform; its point moves as the platform bends."""
    model = model_of(3)
    state, forces = random_states(model.robot, 1, 5)[0], random_forces(model, 1, 6)[0]
    loads = [
        pf.Wrench(3, (100.0, 0, -300), (0, 10.0, 20)),
        pf.Wrench(7, (0, 50.0, 0), (5.0, 0, 0), frame="platform"),
    ]
    x = core_of(model).flat(state)

    def answer(d):
        found = model.direct(core_of(model).state(moved(x, d)), forces, loads)
        return np.concatenate(found[:2])

    found = model.direct_jacobian(state, forces, loads)
    assert by_column(found.state, difference(answer, found.state.shape[-1])) <= DIFFERENCES
    bare = model.direct_jacobian(state, forces)
    assert np.max(np.abs(found.state - bare.state)) > 0.1


@pytest.mark.parametrize("backend", ["numpy", "native"])
@pytest.mark.parametrize("output", [pf.FrameOutput(), pf.PointOutput(4, rows=(0, 1, 2, 3, 4, 5))])
def test_inverse_against_differences(model_of, backend, output):
    model = model_of(3, backend)
    state, target = random_states(model.robot, 1, 7)[0], np.arange(1.0, 7.0)
    x = core_of(model).flat(state)

    def answer(d):
        return model.inverse(core_of(model).state(moved(x, d)), target, output).forces

    found = model.inverse_jacobian(state, target, output)
    assert by_column(found.state, difference(answer, found.state.shape[-1])) <= DIFFERENCES
    expected = difference(lambda d: model.inverse(state, target + d, output).forces, 6, 1.0)
    assert by_column(found.target, expected) <= 1e-8


def test_inverse_undoes_direct(model_of):
    """Where the inverse model's forces drive the direct model, its derivative vanishes along with them."""
    model = model_of(10)
    state, target = random_states(model.robot, 1, 8)[0], np.linspace(-2, 3, 6)
    inverse = model.inverse_jacobian(state, target)
    direct = model.direct_jacobian(state, model.inverse(state, target).forces)
    gain = direct.forces[:6]
    assert relative(gain @ inverse.state, -direct.state[:6]) <= EXACT
    assert relative(gain @ inverse.target, np.eye(6)) <= EXACT


def test_batches_and_backends_agree(model_of):
    model = model_of(3, "native")
    states, forces = random_states(model.robot, 70, 9), random_forces(model, 70, 10)
    whole = model.direct_jacobian(states, forces)
    for i in (0, 69):
        single = model.direct_jacobian(states[i], forces[i])
        reference = model_of(3).direct_jacobian(states[i], forces[i])
        for a, b, c in zip(whole, single, reference, strict=True):
            assert relative(a[i], b) <= 1e-12
            assert relative(b, c) <= 1e-11


@pytest.mark.parametrize("backend", ["numpy", "vm", "native"])
def test_parameters_against_differences(backend):
    """Every kind of parameter, all at once."""
    names = [
        "gravity",
        "legs[*].joints[2].M",
        "legs[1].joints[1].MS",
        "legs[2].joints[2].I",
        "legs[*].joints[2].Fv",
        "legs[0].joints[2].k",
        "platform.frequencies",
        "platform.damping_ratio",
        "platform.payload[5]",
    ]
    model = pf.Model(pf.robots.gough_stewart(3), backend, parameters=names)
    state, forces = random_states(model.robot, 1, 11)[0], random_forces(model, 1, 12)[0]
    found = model.direct_jacobian(state, forces).parameters
    start = 0
    for name, value in model.parameters.items():
        still = not np.any(value)  # zero is the edge of what is allowed
        base = model.with_parameters({name: np.asarray(value) + 1.0}) if still else model
        columns = base.direct_jacobian(state, forces).parameters if still else found
        own = np.asarray(base.parameters[name])
        for i in np.ndindex(own.shape):
            number = start + int(np.ravel_multi_index(i, own.shape)) if own.shape else start
            directions = {tuple(i), tuple(reversed(i))} if name.endswith(".I") else {tuple(i)}
            sides = []
            for sign in (1, -1):
                changed = own.copy()
                for place in directions:
                    changed[place] += sign * 1e-3 * max(1.0, abs(own[i]))
                answer = base.direct(state, forces, parameters={name: changed})
                sides.append(np.concatenate(answer[:2]))
            step = 2e-3 * max(1.0, abs(own[i]))
            numbers = (
                {start + int(np.ravel_multi_index(p, own.shape)) for p in directions}
                if own.shape
                else {number}
            )
            expected = (sides[0] - sides[1]) / step
            got = sum(columns[:, n] for n in numbers)
            assert np.max(np.abs(got - expected)) <= 1e-5 * max(1.0, np.max(np.abs(expected))), (name, i)
        start += own.size
    assert start == found.shape[-1]


def test_what_is_refused(model_of):
    model = model_of(3)
    home, forces = model.robot.home, np.zeros(6)
    with pytest.raises(pf.InputError, match="as many rows as actuators"):
        model.inverse_jacobian(home, [1.0], pf.FrameOutput(rows=(2,)))
    with pytest.raises(pf.InputError, match="derivatives take single ones"):
        model.direct_jacobian(home, forces, [pf.Wrench(0, np.zeros((4, 3)))])
    with pytest.raises(pf.InputError, match="forces"):
        model.direct_jacobian(home, np.zeros(5))
