"""Simulation: the direct model integrated in time, driven by forces or a controller (Fig. 3)."""

import warnings

import numpy as np
from numpy.typing import ArrayLike

from parflex.analysis.health import check_finite
from parflex.base.array import Array
from parflex.base.check import exactly, positive
from parflex.base.errors import InputError, PartialRun
from parflex.base.progress import Progress
from parflex.model.core import Core, core_of
from parflex.model.model import Model
from parflex.robot.state import State
from parflex.simulation.growth import Growth
from parflex.simulation.integrate import Run, integrate
from parflex.simulation.laws import controller_of
from parflex.simulation.laws.bound import BoundLaw
from parflex.simulation.laws.called import ForceFunction
from parflex.simulation.laws.controller import Controller
from parflex.simulation.loads import Loads, Wrenches
from parflex.simulation.observers import Bar, Closure, Crawl, Observer, Singularities
from parflex.simulation.record import record
from parflex.simulation.result import Result, RunStopped
from parflex.simulation.steppers import METHODS, stepper_of
from parflex.simulation.steppers.stepper import Stepper
from parflex.simulation.surroundings.imposed import BaseFunction, RestFunction

SMALLEST_RTOL = 100 * np.finfo(float).eps
ENDS = (None, "raise", "return")  # for on_stop


def simulate(
    model: Model,
    forces_or_controller: ArrayLike | Controller | ForceFunction,
    state: State,
    t: ArrayLike,
    *,
    rtol: float = 1e-8,
    atol: float = 1e-10,
    wrenches: Wrenches = (),
    base: BaseFunction | None = None,
    rest: RestFunction | None = None,
    max_step: float | None = None,
    method: str = "DOP853",
    on_stop: str | None = None,
) -> Result:
    """The motion from `state` on, at the times t (T,) s, by an adaptive method.

    method is "DOP853", of eighth order and the quickest at every useful tolerance, "RK45", or for
    modes that are stiff and heavily damped, or stiff controllers, "Radau", which is implicit.

    Driven by forces (m,), a `Controller`, or a function (t, state) -> forces (m,), which is called
    again at the output times; wrenches on platform nodes are constant, or a function of time. rtol
    and atol bound the local error, max_step (s) the step, by default a fiftieth of the run so that
    no short event is stepped over; steps end where a trajectory's segments do. The works of
    actuators, wrenches and damping are integrated with the state.

    base is a function of time that gives the `BaseMotion` of the robot's base, `BaseSamples` for instance;
    rest one that gives the rests of springs and their rates, (s,) each, of the joints with k > 0 in the
    order of `robot.springs`. Both are called at every evaluation. States stay in the world: one at rest
    on the base is `base(t[0]).carried(state)`. `Servo` and `JointPD` see the robot from its base,
    `ComputedTorque` in the world. The works of base and rests are integrated too; of samples of a base, no
    step is longer than five.

    A run that ends early keeps what was reached: its result is `partial`, and `stopped` says why. By
    default, an error in a caller's function (other than an InputError) raises RunStopped from that error,
    with the result as its `result`; after Ctrl-C, an InputError, a step size that vanishes, a pose out
    of reach or a singular one, the result is returned with a warning (PartialRun). on_stop="raise"
    raises RunStopped after all of these, on_stop="return" returns and warns after all of them.

    Raises InputError before any work for wrong shapes, times that do not increase, or a start that
    the model or controller refuses.
    """
    times = exactly("t", t, (None,))
    if len(times) < 2 or np.any(np.diff(times) <= 0):
        raise InputError("t must hold at least two times, each later than the one before")
    for name, value, known in (("method", method, METHODS), ("on_stop", on_stop, ENDS)):
        if value not in known:
            raise InputError(f"{name} is {value!r}; choose one of {', '.join(map(str, known))}")
    core, loads = core_of(model), Loads(model, wrenches, base, rest)
    for each in loads.imposed.values():
        each.check_covers(times)
    longest = min((times[-1] - times[0]) / 50, loads.longest) if max_step is None else max_step
    tolerances = checked_tolerances(rtol, atol, longest)
    start = loads.flat(times[0], state)
    controller = controller_of(model, forces_or_controller)
    law = controller.bind(model, loads)
    run = run_of(core, law, start, times, method, tolerances)
    replay = law.replay(run.t, run.x)
    if not run.stopped and replay.raised is not None:
        run.fail(replay.raised, "after the run, when called for the record")
    settings = {"integrator": method, **tolerances}
    result = Result(lambda: record(model, run, replay, controller, settings), run.stopped)
    return ended(result, run, on_stop)


def run_of(
    core: Core, law: BoundLaw, start: Array, times: Array, method: str, tolerances: dict[str, float]
) -> Run:
    """The law's motion from a flat state (size,) on; raises InputError where the start is refused."""
    y = np.concatenate([start, np.zeros(law.law.memory + law.works)])

    def begin() -> Stepper:
        check_finite(np.concatenate(law.rate(times[0], y[: -law.works])))
        return stepper_of(law, method, times[0], y, times[-1], tolerances)

    with Progress("simulate", times[-1] - times[0]) as bar:
        observers = observers_of(core, law, times, bar)
        for observer in observers:
            observer.begin(y)
        return integrate(times, y, begin, observers, law.works)


def checked_tolerances(rtol: float, atol: float, max_step: float) -> dict[str, float]:
    """The integrator's tolerances; raises InputError where they are not positive."""
    positive("atol", atol)
    if positive("rtol", rtol) < SMALLEST_RTOL:
        raise InputError(f"rtol is {rtol}; below {SMALLEST_RTOL} round-off prevails")
    return {"rtol": rtol, "atol": atol, "max_step": positive("max_step", max_step)}


def observers_of(core: Core, law: BoundLaw, times: Array, bar: Progress) -> list[Observer]:
    """The observers of a run, in this order: states are closed before others look at them."""
    watch, standpoint = law.law.watch, law.loads.standpoint
    found: list[Observer] = []
    if not core.mechanism.closed:
        found.append(Closure(core, standpoint, times[0]))
    if watch is not None:
        found.append(Singularities(watch, core.mechanism.layout.size, standpoint, times[0]))
    if core.mechanism.platform.modes and len(core.mechanism.attachments):
        found.append(Growth(core, law))
    crawl = Crawl(times[0], times[-1], watch.explain if watch is not None else lambda: "")
    return [*found, crawl, Bar(bar, times[0])]


def ended(result: Result, run: Run, on_stop: str | None) -> Result:
    """The result, where the run has come to its end or a partial one is wanted; else raises RunStopped."""
    if not result.partial:
        return result
    failed = run.cause is not None and not isinstance(run.cause, KeyboardInterrupt)
    if on_stop == "raise" or (on_stop is None and failed):
        raise RunStopped(result) from run.cause
    words = f"the run stopped {result.stopped}; its result holds what was reached"
    warnings.warn(words, PartialRun, stacklevel=3)
    return result
