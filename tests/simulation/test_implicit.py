"""What an implicit integrator asks for: derivatives of the motion under a law, and what they spare."""

from dataclasses import replace

import numpy as np
import pytest

import parflex as pf
import zoo
from differences import by_column, by_differences
from measures import random_forces, random_states
from parflex.model.core import core_of
from parflex.simulation.laws import controller_of
from parflex.simulation.laws.bound import BoundLaw
from parflex.simulation.loads import Loads
from parflex.simulation.steppers.scipy_steps import SciPySteps

DIFFERENCES = 1e-6  # of their own error
EXACT = 1e-10  # two backends, in 64 bits
LOADS = (pf.Wrench(3, (100.0, 0, -300), (0, 10.0, 20)), pf.Wrench(7, (0, 50.0, 0), frame="platform"))
TIMES = np.linspace(0, 0.2, 21)

LAWS = {
    "forces": lambda model, forces: forces,
    "joint controller": lambda model, forces: pf.JointPD(model, model.robot.home, 1e5, 1e3, forces),
    "computed torque": lambda model, forces: pf.ComputedTorque(model, way(model), kp=400.0, kd=40.0),
}

pytestmark = pytest.mark.filterwarnings("ignore:.*beyond a dynamic singularity", "ignore:.*degenerate pair")


def way(model: pf.Model) -> pf.Trajectory:
    return pf.Trajectory.through(model.robot.home, [((0.02, 0, 0.01), (0, 0.02, 0))], 0.1, rest=(0.02, 0.02))


def law_of(kind: str, model: pf.Model, forces: np.ndarray, wrenches=LOADS) -> BoundLaw:
    return controller_of(model, LAWS[kind](model, forces)).bind(model, Loads(model, wrenches))


@pytest.mark.parametrize("kind", LAWS)
@pytest.mark.parametrize("modes", [0, 10])
def test_jacobian_against_differences(model_of, kind, modes):
    """Under wrenches on nodes in both frames; at a quaternion of length 1.1, as an integrator may try."""
    model = model_of(modes)
    law = law_of(kind, model, random_forces(model, 1, 1)[0])
    x = core_of(model).flat(random_states(model.robot, 1, 2)[0])
    x[3:7] *= 1.1
    assert law.differentiable
    assert by_column(law.jacobian(0.06, x), by_differences(law, 0.06, x)) <= DIFFERENCES


@pytest.mark.parametrize("kind", LAWS)
@pytest.mark.parametrize("backend", ["vm", "native"])
def test_backends_agree(model_of, kind, backend):
    """Traced and compiled, the derivative is that of the reference."""
    forces = random_forces(model_of(3), 1, 3)[0]
    x = core_of(model_of(3)).flat(random_states(model_of(3).robot, 1, 4)[0])
    reference, compiled = (law_of(kind, model_of(3, name), forces) for name in ("numpy", backend))
    assert by_column(compiled.jacobian(0.06, x), reference.jacobian(0.06, x)) <= EXACT


ROBOTS = {
    "8 legs, 3 modes": lambda: zoo.ups(8, 3),
    "friction and springs": lambda: zoo.ups(6, 3, loads=True),
    "rps3": lambda: zoo.with_loads(zoo.cases.case("rps3", "flex")),
    "delta3": lambda: zoo.with_loads(zoo.cases.case("delta3", "flex")),
    "rus6": lambda: zoo.with_loads(zoo.cases.case("rus6", "flex")),
}


@pytest.mark.parametrize("name", ROBOTS)
def test_robots_of_other_kinds(name):
    """Turning actuators, spare ones, friction, fewer freedoms: springs of various stiffness."""
    sample = ROBOTS[name]()
    model = pf.Model(sample.robot, "numpy")
    m = sample.robot.n_forces
    stiffness, damping = np.linspace(1e3, 5e3, m), np.linspace(10.0, 50.0, m)
    hold = pf.JointPD(model, sample.states[1], stiffness, damping, sample.forces[0])
    law = hold.bind(model, Loads(model, ()))
    x = core_of(model).flat(sample.states[0])
    assert law.differentiable
    assert by_column(law.jacobian(0.0, x), by_differences(law, 0.0, x)) <= DIFFERENCES


class CountedLaw(BoundLaw):
    """A law that counts how often right-hand sides and Jacobians are asked for."""

    rates = jacobians = 0

    def rate(self, t, x):
        self.rates += 1
        return super().rate(t, x)

    def jacobian(self, t, x):
        self.jacobians += 1
        return super().jacobian(t, x)


class CountedPD(pf.JointPD):
    """Springs and dampers whose calls are counted, perhaps as if their derivative were not known."""

    exact = True

    def bind(self, model, loads):
        law = replace(self.law(model), differentiable=self.exact)
        vars(self)["counted"] = CountedLaw(law, model, loads)
        return self.counted


class DifferencedPD(CountedPD):
    exact = False


def held_stiffly(model: pf.Model, kind=pf.JointPD):
    """Joints held by stiff springs and dampers, and a start off their rest."""
    start, forces = model.equilibrium(*model.robot.home_pose)
    return kind(model, start, 1e8, 1e6, forces), model.robot.home


def test_exact_derivatives_spare_right_hand_sides(model_of):
    """As many steps as with differences, of which each costs a right-hand side per coordinate; and the
    same motion as by an explicit method, within what their tolerances promise."""
    model = model_of(3, "vm")
    hold, start = held_stiffly(model)
    options = {"rtol": 1e-7, "atol": 1e-9, "method": "Radau"}
    reference = pf.simulate(model, hold, start, TIMES, rtol=1e-10, atol=1e-12).dataset
    runs, counts = [], []
    for kind in (CountedPD, DifferencedPD):
        counted, _ = held_stiffly(model, kind)
        runs.append(pf.simulate(model, counted, start, TIMES, **options))
        counts.append(counted.counted)
    for run in runs:
        assert not run.partial
        assert np.max(np.abs(run.dataset.position - reference.position)) <= 1e-8
        assert np.max(np.abs(run.dataset.elastic - reference.elastic)) <= 1e-8
    exact, differences = counts
    assert exact.jacobians > 1
    per_jacobian = (differences.rates - exact.rates) / differences.jacobians
    assert per_jacobian > 0.9 * core_of(model).mechanism.layout.size


def test_a_work_does_not_end_a_stiff_run():
    """Relaxation oscillations with a work beside the state, which asks for more derivatives than the some
    315 after which SciPy's own differences overflow along the work."""
    asked = 0

    def rate(t, y):
        return np.array([y[1], 100.0 * (1 - y[0] ** 2) * y[1] - y[0], y[1] ** 2])

    def slopes(t, y):
        nonlocal asked
        asked += 1
        by_state = [[0, 1], [-200.0 * y[0] * y[1] - 1, 100.0 * (1 - y[0] ** 2)], [0, 2 * y[1]]]
        return np.hstack([by_state, np.zeros((3, 1))])

    end, tolerances = 2000.0, {"rtol": 1e-5, "atol": 1e-8, "max_step": np.inf}
    start = np.array([2.0, 0.0, 0.0])
    stepper = SciPySteps("Radau", rate, slopes, 0.0, start, end, tolerances, lambda t: np.inf)
    while stepper.t < end:
        stepper.advance(np.zeros(0))
    assert asked > 316
    assert np.all(np.isfinite(stepper.y))


def test_a_callers_function_is_differenced(model_of):
    """Stiff springs as a caller's function move the platform as the controller does."""
    model = model_of(0, "vm")
    hold, start = held_stiffly(model)
    law = hold.bind(model, Loads(model, ()))

    def called(t, state):
        return law.forces(t, core_of(model).flat(state))

    one, other = (
        pf.simulate(model, given, start, TIMES, method="Radau", rtol=1e-7, atol=1e-9).dataset
        for given in (hold, called)
    )
    assert np.max(np.abs(one.position - other.position)) <= 1e-8
    assert not controller_of(model, called).bind(model, Loads(model, ())).differentiable


@pytest.mark.parametrize("law", ["forces", "joint controller"])
def test_carried_joints(law):
    """The derivative of a robot whose legs' joints are in its state."""
    sample = zoo.odd(0, 0)
    model = pf.Model(sample.robot, "vm")
    m = sample.robot.n_forces
    given = sample.forces[0]
    if law == "joint controller":
        given = pf.JointPD(model, sample.states[1], np.linspace(1e3, 5e3, m), np.linspace(10.0, 50.0, m))
    law = controller_of(model, given).bind(model, Loads(model, ()))
    x = core_of(model).flat(sample.states[0])
    assert law.differentiable
    assert by_column(law.jacobian(0.0, x), by_differences(law, 0.0, x)) <= DIFFERENCES
