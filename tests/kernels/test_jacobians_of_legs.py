"""Derivatives of the models of robots with bending legs and flexures at tips, against central differences
of the models themselves: legs that bend beside rigid ones, and one that carries its joints in the state."""

from functools import cache

import numpy as np
import pytest

import flexlegs
import parflex as pf
from differences import by_column, by_differences, difference, moved
from flexlegs import NAMES
from parflex.kernels import models as kernels
from parflex.kernels.motion import derivative
from parflex.kernels.motion_jacobian import by_flat_state
from parflex.model.core import Core, core_of
from parflex.simulation.laws import controller_of
from parflex.simulation.loads import Loads
from soft import CASES, pulled_off, softened

DIFFERENCES = 1e-7  # central ones, extrapolated once: of their own error
STEPS = {  # the models are nearly quadratic in the rates; bending shapes turn far by little
    "position": 3e-4,
    "rotation": 3e-4,
    "velocity": 3e-3,
    "omega": 3e-3,
    "elastic": 1e-4,
    "elastic_rate": 3e-3,
    "joints": 3e-5,
    "joint_rates": 1e-3,
}

pytestmark = pytest.mark.filterwarnings("ignore::parflex.DynamicSingularity")


@cache
def robot_of(name: str, kind: str) -> tuple[pf.Robot, pf.State, np.ndarray]:
    """A robot, as it is stored or mixed, a state on its closure in motion, and forces."""
    robot = flexlegs.mixed(name) if kind == "mixed" else flexlegs.robot(name)
    return robot, flexlegs.moving(robot, 1), np.linspace(-50.0, 80.0, robot.n_forces)


@pytest.fixture(
    scope="module", params=[(name, kind) for name in NAMES for kind in ("stored", "mixed")], ids=str
)
def case(request):
    return robot_of(*request.param)


def accelerations(
    core: Core, x: np.ndarray, forces: np.ndarray, load: np.ndarray | float = 0.0
) -> np.ndarray:
    """(V̇_p, q̈_e, s̈) of a flat state by the direct model, of a rate of the components of v_p."""
    at, load = core.mechanism.layout.at, np.zeros(6 + core.mechanism.platform.modes) + load
    rate = core.functions(derivative)(x=x, forces=forces, load=load)["rate"]
    twist, c = rate[at.twist].copy(), x[at.twist]
    twist[:3] += np.cross(c[3:], c[:3])
    return np.concatenate([twist, rate[at.elastic_rate], rate[at.joint_rates]])


def by_motions(core: Core, answer, steps=STEPS) -> np.ndarray:
    """∂ of a function of a flat state's small motion, with a step for each kind of motion."""
    motions, columns = core.mechanism.layout.motions, []
    for part, step in zip(motions, (steps[name] for name in motions._fields), strict=True):
        along = np.eye(core.mechanism.layout.motion_size)[part]
        columns.append(difference(lambda d, along=along: answer(d @ along), len(along), step))
    return np.concatenate(columns, axis=-1)


def test_the_cases_are_what_they_say():
    """Some legs bend, others do not, one of them carries its joints, some tips are flexures."""
    for name in NAMES:
        layout = core_of(pf.Model(flexlegs.mixed(name), "numpy")).mechanism.layout
        assert sorted(set(layout.joints)) == [0, len(flexlegs.mixed(name).legs[-1].joints)]
        assert 0 in layout.elastic
        assert sum(layout.elastic) > 0
        held = [tip.flexure is not None for leg in flexlegs.mixed(name).legs for tip in leg.tips]
        assert 0 < sum(held) < len(held)


def test_direct_against_differences(case):
    """Every motion of the flat state, whether or not the closure allows it; rows of the legs too."""
    robot, state, forces = case
    core, found = core_of(pf.Model(robot, "vm")), pf.Model(robot, "numpy").direct_jacobian(state, forces)
    x, load = core.flat(state), np.zeros(6 + robot.platform.modes)
    expected = by_motions(core, lambda d: accelerations(core, moved(x, d), forces))
    assert by_column(np.concatenate([found.state, found.carried]), expected) <= DIFFERENCES
    expected = difference(lambda d: accelerations(core, x, forces + d), len(forces), 1.0)
    assert by_column(np.concatenate([found.forces, found.carried_forces]), expected) <= DIFFERENCES
    expected = difference(lambda d: accelerations(core, x, forces, d), len(load), 1.0)
    assert by_column(np.concatenate([found.load, found.carried_load]), expected) <= DIFFERENCES


RATES = {  # stiff soft tips ask for a longer step, by round-off, and friction at low rates for a shorter
    "gs_flexlegs": 1e-3,
    "delta_flexarms_foreshortening": 4e-3,
}


@pytest.mark.parametrize(("name", "which"), CASES)
def test_soft_tips_against_differences(name, which):
    """By every motion, by forces and loads, and by the stiffness and damping of a soft tip."""
    robot = softened(flexlegs.mixed(name), which)
    of_tip = "legs[{}].tips[{}].flexure.translation".format(*which[-1])
    model = pf.Model(robot, "numpy", parameters=[of_tip, f"{of_tip}_damping"])
    core, state, forces = core_of(model), pulled_off(robot, 1), np.linspace(-50.0, 80.0, robot.n_forces)
    found, x = model.direct_jacobian(state, forces), core.flat(state)
    steps = STEPS | {"joint_rates": RATES[name]}
    expected = by_motions(core, lambda d: accelerations(core, moved(x, d), forces), steps)
    assert by_column(np.concatenate([found.state, found.carried]), expected) <= DIFFERENCES
    theta = core.functions.theta

    def designed(d: np.ndarray) -> np.ndarray:
        other = core.functions(kernels.direct, theta=theta + d)
        answer = other(x=x, forces=forces, load=np.zeros(6 + robot.platform.modes))
        return np.concatenate([answer["platform"], answer["elastic"]])

    expected = difference(designed, len(theta), 1.0)  # linear in both
    assert by_column(found.parameters, expected) <= DIFFERENCES


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("backend", ["vm", "native"])
def test_backends_agree(name, backend):
    robot, state, forces = robot_of(name, "mixed")
    reference, found = (pf.Model(robot, b).direct_jacobian(state, forces) for b in ("numpy", backend))
    for one, other in zip(found, reference, strict=True):
        assert one.shape == other.shape
        if other.size:
            assert by_column(one, other) <= 1e-10


def test_along_motions_that_the_closure_allows(case):
    """A state moved and projected on the closure: the change of all accelerations is the derivative's."""
    robot, state, forces = case
    model, core = pf.Model(robot, "numpy"), core_of(pf.Model(robot, "vm"))
    found, x = model.direct_jacobian(state, forces), core.flat(state)
    rng, step = np.random.default_rng(2), 1e-4
    motions, way = core.mechanism.layout.motions, rng.normal(size=found.state.shape[-1])
    way[motions.elastic], way[motions.joints] = 0.1 * way[motions.elastic], 0.1 * way[motions.joints]
    ends = [core.flat(model.project(core.state(moved(x, sign * step * way)))) for sign in (1, -1, 0.5, -0.5)]
    fast = [accelerations(core, y, forces) for y in ends]
    change = (4 * (fast[2] - fast[3]) / step - (fast[0] - fast[1]) / (2 * step)) / 3
    ways = [motion_between(core, x, y) for y in ends]
    along = (4 * (ways[2] - ways[3]) / step - (ways[0] - ways[1]) / (2 * step)) / 3
    expected = np.concatenate([found.state, found.carried]) @ along
    assert np.max(np.abs(change - expected)) <= DIFFERENCES * np.max(np.abs(expected))


def motion_between(core: Core, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """The small motion from a flat state to another, to second order."""
    rows = by_flat_state(core.mechanism.layout, 0.5 * (x + y), np.eye(core.mechanism.layout.motion_size))
    return rows @ (y - x)


def test_inverse_against_differences(case):
    """Rows of V̇_p, as many as there are actuators."""
    robot, state, _ = case
    rows = (0, 1, 2, 3, 4, 5)[: robot.n_forces]
    output, target = pf.FrameOutput(rows=rows), np.linspace(-1.0, 2.0, len(rows))
    core = core_of(pf.Model(robot, "vm"))
    found, x = pf.Model(robot, "numpy").inverse_jacobian(state, target, output), core.flat(state)

    def answer(x, target):
        return core.functions(kernels.inverse, output)(x=x, target=target)["forces"]

    assert by_column(found.state, by_motions(core, lambda d: answer(moved(x, d), target))) <= DIFFERENCES
    expected = difference(lambda d: answer(x, target + d), len(target), 1.0)
    assert by_column(found.target, expected) <= DIFFERENCES


@pytest.mark.parametrize("kind", ["stored", "mixed"])
@pytest.mark.parametrize("backend", ["numpy", pytest.param("vm", marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", NAMES)
def test_parameters_against_differences(name, kind, backend):
    """Inertia, friction and springs of joints, gravity and the platform's payload: the direct model is linear
    in gravity, friction and springs."""
    robot, state, forces = robot_of(name, kind)
    names = [
        "gravity",
        "legs[0].joints[2].Fv",
        "legs[1].joints[1].k",
        "legs[2].joints[0].k",
        "legs[*].joints[0].IA",
    ]
    names += ["platform.payload[5]"]
    model = pf.Model(robot, backend, parameters=names)
    reference, core = core_of(pf.Model(robot, "vm", parameters=names)), core_of(model)
    x, theta = core.flat(state), core.functions.theta + 0.01
    linear = np.array([True] * 6 + [False] * 2)
    values = dict(zip(names, [part for _, part in core.functions.parameters.split(theta)], strict=True))
    found = model.direct_jacobian(state, forces, parameters=values)

    def answer(d):
        run = reference.functions(derivative, theta=theta + d)
        at, rate = core.mechanism.layout.at, run(x=x, forces=forces)["rate"]
        return np.concatenate([rate[at.twist], rate[at.elastic_rate], rate[at.joint_rates]])

    rows = np.concatenate([found.parameters, found.carried_parameters])
    found = np.where(linear, difference(answer, len(theta), 1.0), difference(answer, len(theta), 1e-3))
    assert by_column(rows, found) <= DIFFERENCES


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("law", ["forces", "joint controller"])
def test_motions_of_implicit_integrators(name, law):
    """∂ẋ/∂x entry by entry of the flat state, legs' coordinates and their rates among them."""
    robot, state, forces = robot_of(name, "mixed")
    model = pf.Model(robot, "vm")
    given = forces if law == "forces" else pf.JointPD(model, state, 2e3, 30.0, forces)
    bound = controller_of(model, given).bind(model, Loads(model, ()))
    x = core_of(model).flat(flexlegs.moving(robot, 3))
    assert bound.differentiable
    assert by_column(bound.jacobian(0.0, x), by_differences(bound, 0.0, x)) <= 2e-6


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_an_implicit_integrator_moves_as_an_explicit_one(name):
    """Radau with exact derivatives, and DOP853, within what their tolerances promise."""
    robot, state, forces = robot_of(name, "mixed")
    model, t = pf.Model(robot, "vm"), np.linspace(0.0, 2e-3, 3)
    one = pf.simulate(model, forces, state, t, rtol=1e-9, atol=1e-11).dataset
    other = pf.simulate(model, forces, state, t, rtol=1e-7, atol=1e-9, method="Radau").dataset
    assert not np.array_equal(one.position[0], one.position[-1])
    assert np.max(np.abs(one.position - other.position)) <= 1e-8
    assert np.max(np.abs(one.elastic - other.elastic)) <= 1e-8
