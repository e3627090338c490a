"""SciPy's integrators, one step at a time, for any function."""

from collections.abc import Callable

import numpy as np
from scipy import integrate

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.simulation.steppers.stepper import Stepper, Stuck

CLOSE = 1e-12  # a shorter step, relative to the time, is none
IMPLICIT = ("Radau",)  # methods that ask for ∂f/∂y


class RightHandSide:
    """The function ẏ = rate(t, y) as an integrator takes it.

    Where `rate` refuses a trial state, the answer is not a number: the integrator then shortens
    its step, and ends when that does not help.
    """

    def __init__(self, rate: Callable[[float, Array], Array]) -> None:
        self._rate = rate
        self.refused: InputError | None = None  # why, since somebody last set it to None

    def __call__(self, t: float, y: Array) -> Array:
        if not np.isfinite(y.sum()):  # a later stage of a step that was refused already
            return np.full(len(y), np.nan)
        try:
            return self._rate(t, y)
        except InputError as error:
            self.refused = error
            return np.full(len(y), np.nan)


class SciPySteps(Stepper):
    """One step of one of SciPy's methods at a time; from any time on, the function is smooth `until` another.

    Implicit methods read ∂f/∂y from `slopes`. SciPy's own differences step by parts of y: too little where
    a coordinate is near zero, and ever more, to infinity, along works, on which f does not depend.
    """

    def __init__(
        self,
        method: str,
        rate: Callable[[float, Array], Array],
        slopes: Callable[[float, Array], Array],
        t: float,
        y: Array,
        end: float,
        tolerances: dict[str, float],
        until: Callable[[float], float],
    ) -> None:
        self._rate, self._until, self._longest = RightHandSide(rate), until, tolerances["max_step"]
        options = {"jac": slopes} if method in IMPLICIT else {}
        self._solver = getattr(integrate, method)(self._rate, t, y, end, **tolerances, **options)
        self.t, self.y, self.steps = t, self._solver.y, 0

    def advance(self, times: Array) -> Array:
        solver = self._solver
        self._rate.refused = None
        left = self._until(solver.t) - solver.t
        if left > CLOSE * max(1.0, abs(solver.t)):
            solver.max_step = min(self._longest, left)
        solver.step()
        if solver.status == "failed":
            raise Stuck
        self.t, self.y, self.steps = solver.t, solver.y, self.steps + 1
        passed = times[: np.searchsorted(times, solver.t, side="right")]
        if len(passed) == 0:
            return np.empty((0, len(solver.y)))
        rows: Array = solver.dense_output()(passed).T
        return rows

    @property
    def refused(self) -> InputError | None:
        return self._rate.refused

    def moved(self) -> None:
        self._solver.f = self._rate(self._solver.t, self._solver.y)
