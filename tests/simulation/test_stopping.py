"""Runs that end early: what is reached is kept, and the end is an error or a warning that says why."""

import os
import signal
import threading
import traceback
import warnings

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import parflex as pf
from parflex.model.core import core_of
from parflex.simulation.integrate import integrate
from parflex.simulation.laws.law import WORKS
from parflex.simulation.loads import Loads
from parflex.simulation.observers import Observer
from parflex.simulation.steppers import stepper_of
from parflex.simulation.steppers.cyrk_steps import CyrkSteps

GOAL = np.array([0.055, -0.046, 0.124, -0.298, 0.244, 0.103])  # m, and a rotation vector, from home
TIMES = np.linspace(0, 0.2, 21)
ENDS_HERE = r"the run stopped at t = \S+ s: "


@pytest.fixture(scope="module", params=["vm", "native"])
def model(model_of, request):
    """Integrated step by step from Python by SciPy, and a hundred steps at a time by machine code."""
    return model_of(3, request.param)


@pytest.fixture(scope="module")
def forces(model):
    return model.equilibrium(*model.robot.home_pose)[1]


def partial(run: pf.Result, rows: int = 2) -> bool:
    """Whether the rows before the end are there, and good."""
    data = run.dataset
    whole = bool(np.all(np.isfinite(data.position)))
    return run.partial and data.attrs["partial"] == 1 and rows <= data.sizes["time"] <= len(TIMES) and whole


def line_of(error: BaseException) -> str:
    """The line of code where an error was raised."""
    return str(traceback.extract_tb(error.__traceback__)[-1].line)


def controller_error(model, forces):
    def controller(t, state):
        return forces if t < 0.1 else undefined_name  # noqa: F821

    return {"forces_or_controller": controller}


def load_error(model, forces):
    def wrenches(t):
        return [] if t < 0.1 else undefined_name  # noqa: F821

    return {"forces_or_controller": forces, "wrenches": wrenches}


@pytest.mark.parametrize("given", [controller_error, load_error])
def test_errors_of_a_callers_functions_are_raised(model, forces, given):
    """With the line that raised them, and with what was reached."""
    with pytest.raises(pf.RunStopped, match=ENDS_HERE + "NameError") as stop:
        pf.simulate(model, state=model.robot.home, t=TIMES, **given(model, forces))
    assert isinstance(stop.value.__cause__, NameError)
    assert "undefined_name" in line_of(stop.value.__cause__)
    assert partial(stop.value.result)
    assert "NameError" in stop.value.result.stopped
    assert stop.value.result.dataset.time[-1] == pytest.approx(0.09, abs=0.011)


@pytest.mark.parametrize("given", [controller_error, load_error])
def test_a_partial_result_may_be_asked_for(model, forces, given):
    with pytest.warns(pf.PartialRun, match=ENDS_HERE + "NameError") as said:
        run = pf.simulate(model, state=model.robot.home, t=TIMES, on_stop="return", **given(model, forces))
    assert partial(run)
    assert said[0].filename == __file__


@pytest.mark.parametrize("good", [0, 1, 2])
def test_errors_at_the_start_are_raised_likewise(model, forces, good):
    """At the first call, and at those by which an integrator chooses its first step."""
    calls = []

    def controller(t, state):
        calls.append(t)
        return forces if len(calls) <= good else {}["gone"]

    with pytest.raises(pf.RunStopped, match="KeyError") as stop:
        pf.simulate(model, controller, model.robot.home, TIMES)
    assert isinstance(stop.value.__cause__, KeyError)
    assert "gone" in line_of(stop.value.__cause__)
    assert partial(stop.value.result, rows=1)
    assert stop.value.result.dataset.sizes["time"] == 1


def test_a_start_that_is_refused_is_no_run(model):
    with pytest.raises(pf.InputError, match="gave shape") as refused:
        pf.simulate(model, lambda t, state: np.zeros(2), model.robot.home, TIMES)
    assert not isinstance(refused.value, pf.RunStopped)


def test_errors_at_the_record_are_raised_likewise(model, forces):
    """The whole motion is there; the forces of the rows where the controller fails are not numbers."""
    latest = [0.0]

    def controller(t, state):
        if t < latest[0] - 0.1:  # it is called again for the record
            raise RuntimeError("unplugged")
        latest[0] = max(latest[0], t)
        return forces

    with pytest.raises(
        pf.RunStopped, match="after the run, when called for the record: RuntimeError"
    ) as stop:
        pf.simulate(model, controller, model.robot.home, TIMES)
    assert "unplugged" in line_of(stop.value.__cause__)
    data = stop.value.result.dataset
    assert partial(stop.value.result, rows=len(TIMES))
    failed = np.any(np.isnan(data.forces), axis=1)
    assert np.any(failed)
    assert not np.all(failed)


def test_controller_that_fails_again_afterwards_keeps_the_run(model):
    """Called once more for the record, it fails there too: those forces are not numbers."""
    calls = []

    def controller(t, s):
        calls.append(t)
        if len(calls) > 30:
            raise RuntimeError("unplugged")
        return np.zeros(6)

    with pytest.raises(pf.RunStopped, match="RuntimeError: unplugged") as stop:
        pf.simulate(model, controller, model.robot.home, TIMES)
    run = stop.value.result
    assert partial(run, rows=1)
    assert np.all(np.isnan(run.dataset.forces))


def test_first_refusal_is_the_reason(model):
    """What the controller said, not what its later calls with broken numbers led to."""

    def controller(t, s):
        if t > 0.05:
            raise pf.InputError("the battery is empty")
        return np.zeros(6)

    with pytest.warns(pf.PartialRun, match="the battery is empty"):
        run = pf.simulate(model, controller, model.robot.home, TIMES)
    assert partial(run)
    assert run.stopped.endswith("the battery is empty")


def test_a_wrong_shape_on_the_way_is_an_end_with_a_warning(model, forces):
    def controller(t, state):
        return forces if t < 0.1 else forces[:2]

    with pytest.warns(pf.PartialRun, match="gave shape"):
        assert partial(pf.simulate(model, controller, model.robot.home, TIMES))
    with pytest.raises(pf.RunStopped, match="gave shape") as stop:
        pf.simulate(model, controller, model.robot.home, TIMES, on_stop="raise")
    assert partial(stop.value.result)


def test_on_stop_is_one_of_two_words(model, forces):
    with pytest.raises(pf.InputError, match="on_stop is 'stay'; choose one of None, raise, return"):
        pf.simulate(model, forces, model.robot.home, TIMES, on_stop="stay")


@pytest.mark.parametrize("on_stop", [None, "raise", "return"])
def test_a_run_that_comes_to_its_end_says_nothing(model, forces, on_stop):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert not pf.simulate(model, forces, model.robot.home, TIMES, on_stop=on_stop).partial


def pressing(forces, after: float):
    """A controller during which Ctrl-C is pressed, once."""
    pressed = []

    def controller(t, s):
        if t >= after and not pressed:
            pressed.append(t)
            signal.raise_signal(signal.SIGINT)
        return forces

    return controller


@pytest.mark.usefixtures("interruptible")
def test_ctrl_c_keeps_what_was_reached(model, forces, tmp_path):
    with pytest.warns(pf.PartialRun, match=ENDS_HERE + "interrupted"):
        run = pf.simulate(model, pressing(forces, 0.1), model.robot.home, TIMES)
    assert partial(run)
    assert "interrupted" in run.stopped
    assert run.dataset.sizes["time"] < len(TIMES)
    back = pf.load_result(run.save(tmp_path / "run.nc"))
    assert back.partial
    assert back.stopped == run.stopped
    with pytest.raises(pf.RunStopped, match="interrupted"):
        pf.simulate(model, pressing(forces, 0.0), model.robot.home, TIMES, on_stop="raise")


@pytest.mark.usefixtures("interruptible")
def test_ctrl_c_at_the_record_is_heard(model, forces):
    """It is pressed while a controller is called again: the others of its rows are not waited for."""
    latest, late = [0.0], []

    def controller(t, state):
        if t < latest[0] - 0.1:
            late.append(t)
            if len(late) == 3:
                signal.raise_signal(signal.SIGINT)
        latest[0] = max(latest[0], t)
        return forces

    with pytest.warns(pf.PartialRun, match="after the run, when called for the record: interrupted"):
        run = pf.simulate(model, controller, model.robot.home, TIMES)
    assert partial(run, rows=len(TIMES))
    assert len(late) == 3
    assert np.isnan(run.dataset.forces[-1]).all()


class Presser(Observer):
    """Ctrl-C is pressed a moment after the first advance."""

    def __init__(self) -> None:
        self.timer = threading.Timer(0.01, os.kill, (os.getpid(), signal.SIGINT))

    def see(self, advance) -> None:
        if not self.timer.ident:
            self.timer.start()


@pytest.mark.usefixtures("interruptible")
def test_ctrl_c_in_machine_code_keeps_what_was_reached(model_of):
    """Nothing of the run is Python: a signal that is sent amid it is seen between two chunks of steps."""
    model, presser = model_of(3, "native"), Presser()
    start, forces = model.equilibrium(*model.robot.home_pose)
    law = pf.JointPD(model, start, 1e6, 1e3, forces).bind(model, Loads(model, ()))
    times, y = (
        np.linspace(0, 1000, 100_001),
        np.append(core_of(model).flat(model.robot.home), np.zeros(WORKS)),
    )
    tolerances = {"rtol": 1e-8, "atol": 1e-10, "max_step": 20.0}
    stepper = stepper_of(law, "DOP853", 0.0, y, times[-1], tolerances)
    assert isinstance(stepper, CyrkSteps)
    run = integrate(times, y, lambda: stepper, [presser])
    presser.timer.join()
    assert "interrupted" in run.stopped
    assert 1 < len(run.t) == len(run.x) < len(times)


def test_leg_out_of_reach_is_named_by_both_integrators(model_of):
    """A platform thrown upwards: a slider of negative length, or a singular leg, ends the run."""
    said = []
    for backend in ("vm", "native"):
        model = model_of(0, backend)
        home = model.robot.home
        fall = pf.State(home.position, home.rotation, twist=(0.0, 0, -20.0, 0, 0, 0))
        with pytest.warns(pf.PartialRun):
            run = pf.simulate(model, np.zeros(6), fall, np.linspace(0, 0.2, 21))
        assert run.partial
        said.append(run.stopped)
        assert run.dataset.sizes["time"] >= 5  # the outputs before it are kept
    assert said[0].split(": ")[1:] == said[1].split(": ")[1:]


def test_divergence_ends_as_partial(model):
    """Pushed far beyond reason, the platform falls through its legs."""
    with pytest.warns(pf.PartialRun):
        run = pf.simulate(model, np.full(6, -4e3), model.robot.home, np.linspace(0, 3, 61))
    assert run.partial
    assert run.stopped.startswith("at t = ")
    assert np.all(np.isfinite(run.dataset.position))


@pytest.mark.parametrize("backend", ["vm", "native"])
def test_dynamic_singularity_on_the_way_ends_as_partial(model_of, backend):
    """Computed torque towards a pose beyond a dynamic singularity stops there and says so.

    The pose was found by trial: the platform bends on its way, so that not every path to a pose that
    is singular when flat meets one.
    """
    model = model_of(9, backend)
    start, _ = model.equilibrium(*model.robot.home_pose)
    goal = Rotation.from_rotvec(GOAL[3:]).as_matrix()
    home = model.robot.home
    way = pf.Trajectory(
        [home.position, home.position + GOAL[:3]], [home.rotation, goal], [0.5], rest=(0.05, 0.05)
    )
    with pytest.warns(pf.PartialRun, match="dynamic singularity"):
        run = pf.simulate(model, pf.ComputedTorque(model, way), start, np.linspace(0, way.duration, 61))
    assert run.partial
    assert "dynamic singularity" in run.stopped
    assert 10 < run.dataset.sizes["time"] < 61
    assert np.all(np.isfinite(run.dataset.forces))
