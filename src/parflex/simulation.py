"""Simulation: the direct model integrated in time, driven by forces or a controller (Fig. 3)."""

from collections.abc import Callable, Sequence
from math import isfinite
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import DOP853

from parflex.array import Array
from parflex.check import all_of_type, exactly, positive
from parflex.closure import CLOSED, size_of
from parflex.compiled import kernels
from parflex.control import Controller, Law, as_law
from parflex.errors import InputError
from parflex.legs.base import MARGINS
from parflex.progress import Progress
from parflex.record import record
from parflex.result import Result
from parflex.singular import check_finite
from parflex.state import State, Wrench, unpack
from parflex.wrench import generalised_force

if TYPE_CHECKING:
    from parflex.model import Model

Loads = Sequence[Wrench] | Callable[[float], Sequence[Wrench]]
SMALLEST_RTOL = 100 * np.finfo(float).eps
SMALLEST, PATIENCE = 1e-6, 1000  # steps below this part of the run, so many in a row, end it
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
    wrenches: Loads = (),
    max_step: float | None = None,
) -> Result:
    """The motion from `state` on, at the times t (T,) s, by an eighth-order adaptive method.

    Driven by forces (m,), a `Controller`, or a function (t, state) -> forces (m,), which is called
    again at the output times; wrenches on platform nodes are constant, or a function of time. rtol
    and atol bound the local error, max_step (s) the step, by default a fiftieth of the run so that
    no short event is stepped over. The works of actuators, wrenches and damping are integrated with
    the state.

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
    model = model.of(state)
    start = model.flat(state)
    if start.ndim != 1:
        raise InputError(f"state is a batch {start.shape[:-1]}; simulate one state at a time")
    law = as_law(model, forces_or_controller)
    loads = wrench_law(model, wrenches)
    longest = (times[-1] - times[0]) / 50 if max_step is None else positive("max_step", max_step)
    tolerances = {"rtol": rtol, "atol": atol, "max_step": longest}
    run = integrate(law, loads, start, times, tolerances, Closure(model))
    u = at_output_times(run, law, model.robot.n_forces)
    w = at_output_times(run, loads, 6 + model.robot.platform.modes)
    if not run.stopped and not (np.all(np.isfinite(u)) and np.all(np.isfinite(w))):
        run = run._replace(stopped="after the run: forces or wrenches failed when called for the record")
    trajectory = forces_or_controller.trajectory if isinstance(forces_or_controller, Controller) else None
    return record(model, run, u, w, trajectory, {"integrator": "DOP853", **tolerances})


def integrate(
    law: Law,
    loads: Callable[[float, Array], Array],
    start: Array,
    times: Array,
    tolerances: dict[str, float],
    closure: "Closure",
) -> Run:
    """Steps of the integrator, each put back on the closure, read out at the output times."""
    rate = RightHandSide(law, loads)
    y = np.concatenate([closure.first(start), np.zeros(WORKS)])
    law.watch(start)
    rate.first(times[0], y)
    rows, done, reached_t, slow, stopped = [y], 1, times[0], 0, ""
    with Progress("simulate", times[-1] - times[0]) as bar:
        try:
            solver = DOP853(rate, times[0], y, times[-1], **tolerances)
            while solver.status == "running" and done < len(times):
                solver.step()
                if solver.status == "failed":
                    stopped = str(rate.refused or law.explain() or "the step size vanished: it diverges")
                    break
                if closure(solver.y):
                    solver.f = rate(solver.t, solver.y)
                law.watch(solver.y[:-WORKS])
                reached = int(np.searchsorted(times, solver.t, side="right"))
                if reached > done:
                    read = solver.dense_output()
                    rows += [closure.on(read(time)) for time in times[done:reached]]
                    done = reached
                reached_t, rate.refused = solver.t, None
                slow = slow + 1 if solver.step_size < SMALLEST * (times[-1] - times[0]) else 0
                if slow > PATIENCE:
                    stopped = law.explain() or "the step size vanished: it diverges"
                    break
                bar.to(reached_t - times[0])
        except KeyboardInterrupt:
            stopped = "interrupted"
        except Exception as error:  # whatever a caller's controller raises must not cost the run
            stopped = f"{type(error).__name__}: {error}"
    if stopped:
        stopped = f"at t = {reached_t:.6g} s: {stopped}"
    kept = np.array(rows)
    x = kept[:, :-WORKS]
    x[:, 3:7] /= np.linalg.norm(x[:, 3:7], axis=1, keepdims=True)
    return Run(times[: len(kept)], x, kept[:, -WORKS:], stopped)


class Closure:
    """The closure of the legs, onto which states are put back in the metric of the robot's mass."""

    def __init__(self, model: "Model") -> None:
        self._model, self._robot = model, model.robot
        self._open = not all(group.closed for group in model.robot.groups)
        if self._open:
            function = model.function(kernels.projection)
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
        return self.on(y)[:-WORKS]

    def on(self, y: Array) -> Array:
        """y with its state on the closure."""
        self(y)
        return y

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


class RightHandSide:
    """ẏ for y = (flat state, works).

    Where the model or the controller refuses a trial state, the answer is not a number: the
    integrator then shortens its step, and ends when that does not help.
    """

    def __init__(self, law: Law, loads: Callable[[float, Array], Array]) -> None:
        self._law, self._loads = law, loads
        self.refused: InputError | None = None  # why, since somebody last set it to None

    def first(self, t: float, y: Array) -> Array:
        """As a call, but what refuses the state is raised."""
        x = y[:-WORKS]
        found = np.concatenate(self._law.rate(t, x, self._loads(t, x)))
        if not isfinite(found.sum()):
            check_finite(found)
        return found

    def __call__(self, t: float, y: Array) -> Array:
        if not isfinite(y.sum()):  # a later stage of a step that was refused already
            return np.full(len(y), np.nan)
        try:
            return self.first(t, y)
        except InputError as error:
            self.refused = error
            return np.full(len(y), np.nan)


def wrench_law(model: "Model", wrenches: Loads) -> Callable[[float, Array], Array]:
    """External generalised forces (6 + N,) as a function of time and flat state."""
    body = model.robot.platform
    if not callable(wrenches) and len(all_of_type("wrenches", wrenches, Wrench)) == 0:
        none = np.zeros(6 + body.modes)
        return lambda t, x: none

    def loads(t: float, x: Array) -> Array:
        given = wrenches(t) if callable(wrenches) else wrenches
        w = generalised_force(body, unpack(x, model.robot.layout), given)
        if w.ndim != 1:
            raise InputError(f"wrenches are a batch {w.shape[:-1]}; a simulation takes single ones")
        return w

    return loads


def at_output_times(run: Run, function: Callable[[float, Array], Array], size: int) -> Array:
    """Rows (T, size) of a law or load at the output times.

    Where a run stopped because the function failed, so may its last rows: they are not numbers.
    """
    rows: list[Array] = []
    for t, x in zip(run.t, run.x, strict=True):
        try:
            rows.append(np.array(function(t, x)))
        except (Exception, KeyboardInterrupt):  # whatever happens now, the run is worth keeping
            rows.append(np.full(size, np.nan))
    return np.array(rows).reshape(len(run.t), size)
