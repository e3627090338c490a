"""Simulation: the direct model integrated in time, driven by forces or a controller (Fig. 3)."""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from parflex.analysis.singularities import check_finite
from parflex.base.array import Array
from parflex.base.check import exactly, positive
from parflex.base.errors import InputError
from parflex.base.progress import Progress
from parflex.kernels.projection import projection
from parflex.mechanics.closure import CLOSED, size_of
from parflex.mechanics.legs.base import MARGINS
from parflex.robot.state import State
from parflex.simulation.chunks import chunks
from parflex.simulation.laws import controller_of
from parflex.simulation.laws.bound import BoundLaw
from parflex.simulation.loads import Given, Loads
from parflex.simulation.record import record
from parflex.simulation.result import Result
from parflex.simulation.stepping import METHODS, SciPySteps, Stepper, Stuck

if TYPE_CHECKING:
    from parflex.model.model import Model

SMALLEST_RTOL = 100 * np.finfo(float).eps
SMALLEST, PATIENCE = 1e-6, 1000  # a mean step below this part of the run, over so many, ends it
DIVERGES = "the step size vanished: it diverges"
PROJECTIONS = 5  # at most, of one state onto the closure
WORKS = 3  # actuators, external wrenches, damping: integrated beside the state


class Run(NamedTuple):
    """What the integration leaves: rows at the output times that were reached."""

    t: Array  # (T,)
    x: Array  # (T, size)
    works: Array  # (T, 3) J
    stopped: str  # why it ended early; empty where it did not


def simulate(
    model: "Model",
    forces_or_controller: Any,
    state: State,
    t: ArrayLike,
    rtol: float = 1e-8,
    atol: float = 1e-10,
    wrenches: Given = (),
    max_step: float | None = None,
    method: str = "DOP853",
) -> Result:
    """The motion from `state` on, at the times t (T,) s, by an adaptive method.

    method is "DOP853", of eighth order and the quickest at every useful tolerance, "RK45", or for
    modes that are stiff and heavily damped, or stiff controllers, "Radau", which is implicit.

    Driven by forces (m,), a `Controller`, or a function (t, state) -> forces (m,), which is called
    again at the output times; wrenches on platform nodes are constant, or a function of time. rtol
    and atol bound the local error, max_step (s) the step, by default a fiftieth of the run so that
    no short event is stepped over; steps end where a trajectory's segments do. The works of
    actuators, wrenches and damping are integrated with the state.

    Ctrl-C, a step size that vanishes, a pose out of reach or a singular one end the run: what was
    reached is returned, with `result.partial` true and `result.stopped` saying why.

    Raises InputError before any work for wrong shapes, times that do not increase, or a start that
    the model or controller refuses.
    """
    times = exactly("t", t, (None,))
    if len(times) < 2 or np.any(np.diff(times) <= 0):
        raise InputError("t must hold at least two times, each later than the one before")
    positive("atol", atol)
    if positive("rtol", rtol) < SMALLEST_RTOL:
        raise InputError(f"rtol is {rtol}; below {SMALLEST_RTOL} round-off prevails")
    if method not in METHODS:
        raise InputError(f"method is {method!r}; choose one of {', '.join(METHODS)}")
    model = model.of(state)
    start = model.flat(state)
    if start.ndim != 1:
        raise InputError(f"state is a batch {start.shape[:-1]}; simulate one state at a time")
    controller = controller_of(model, forces_or_controller)
    law = controller.bind(model, Loads(model, wrenches))
    longest = (times[-1] - times[0]) / 50 if max_step is None else positive("max_step", max_step)
    tolerances = {"rtol": rtol, "atol": atol, "max_step": longest}
    run = integrate(law, start, times, method, tolerances, Closure(model))
    motion = law.replay(run.t, run.x)
    if not run.stopped and not (np.all(np.isfinite(motion.forces)) and np.all(np.isfinite(motion.load))):
        run = run._replace(stopped="after the run: forces or wrenches failed when called for the record")
    settings = {"integrator": method, **tolerances}
    return Result(lambda: record(model, run, motion, controller.trajectory, settings), run.stopped)


def integrate(
    law: BoundLaw, start: Array, times: Array, method: str, tolerances: dict[str, float], closure: "Closure"
) -> Run:
    """The law's motion, put back on the closure again and again, read out at the output times."""
    watch = law.law.watch

    def look(x: Array) -> tuple[int, str]:
        return watch.look(x) if watch else (len(x), "")

    def explain() -> str:
        return watch.explain() if watch else ""

    y = np.concatenate([closure.first(start), np.zeros(WORKS)])
    look(y[None, :-WORKS])
    check_finite(np.concatenate(law.rate(times[0], y[:-WORKS])))

    def rate(t: float, y: Array) -> Array:
        return np.concatenate(law.rate(t, y[:-WORKS]))

    def slopes(t: float, y: Array) -> Array:
        return np.pad(law.jacobian(t, y[:-WORKS]), (0, WORKS))

    rows, done, reached, stopped, crawl = [y[None]], 1, times[0], "", (0, times[0])
    stepper: Stepper = chunks(law, method, times[0], y, tolerances) or SciPySteps(
        method, rate, slopes, times[0], y, times[-1], tolerances, lambda t: law.stretch(t)[1]
    )
    with Progress("simulate", times[-1] - times[0]) as bar:
        try:
            while done < len(times) and not stopped:
                try:
                    found = stepper.advance(times[done:])
                except Stuck:
                    stopped = str(stepper.refused or explain() or DIVERGES)
                    break
                for row in found:
                    closure(row)
                if closure(stepper.y):
                    stepper.moved()
                before, stopped = look(np.vstack([found, stepper.y])[:, :-WORKS])
                rows.append(found[:before])
                reached = times[done + before] if before < len(found) else stepper.t
                done += len(found)
                if stepper.steps - crawl[0] >= PATIENCE:
                    if stepper.t - crawl[1] < SMALLEST * PATIENCE * (times[-1] - times[0]):
                        stopped = explain() or DIVERGES
                    crawl = (stepper.steps, stepper.t)
                bar.to(reached - times[0])
        except KeyboardInterrupt:
            stopped = "interrupted"
        except Exception as error:  # whatever a caller's controller raises must not cost the run
            stopped = f"{type(error).__name__}: {error}"
    if stopped:
        stopped = f"at t = {reached:.6g} s: {stopped}"
    kept = np.concatenate(rows)
    x = kept[:, :-WORKS]
    x[:, 3:7] /= np.linalg.norm(x[:, 3:7], axis=1, keepdims=True)
    return Run(times[: len(kept)], x, kept[:, -WORKS:], stopped)


class Closure:
    """The closure of the legs, onto which states are put back in the metric of the robot's mass."""

    def __init__(self, model: "Model") -> None:
        self._model, self._robot = model, model.robot
        self._open = not model.robot.closed
        if self._open:
            function = model.function(projection)
            self._x, self._moved, self._health = (
                np.zeros(n) for n in (*function.kernel.inputs, *function.kernel.outputs)
            )
            self._run = function.bind([self._x], [self._moved, self._health])
            self._tolerance = CLOSED * size_of(model.robot)

    def first(self, x: Array) -> Array:
        """A start, put on the closure; raises as `Model.direct` where there is none."""
        y = np.concatenate([x, np.zeros(WORKS)])
        if self._open:
            self._x[:] = x
            self._run()
            self._model.check(x, self._health)
        self(y)
        return y[:-WORKS]

    def __call__(self, y: Array) -> bool:
        """Put the state in y on the closure; whether it moved."""
        if not self._open:
            return False
        self._x[:] = y[:-WORKS]
        for _ in range(PROJECTIONS):
            self._run()
            gaps = self._health[MARGINS * len(self._robot.legs) :]
            if not np.max(np.abs(gaps)) > self._tolerance:
                break
            self._x[:] = self._moved
        y[:-WORKS] = self._x
        return True
