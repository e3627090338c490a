"""Ways to go on in time: what a simulation asks of an integrator."""

from abc import ABC, abstractmethod
from collections.abc import Callable

import numpy as np
from scipy import integrate

from parflex.base.array import Array
from parflex.base.errors import InputError

CLOSE = 1e-12  # of the time, that is no step
METHODS = ("DOP853", "RK45", "Radau")  # which begin each step from the point alone
IMPLICIT = ("Radau",)  # of these: they ask for ∂f/∂y


class Stuck(Exception):
    """The step size has vanished."""


class Stepper(ABC):
    """An integration of ẏ = f(t, y) that has reached y (size,) at time t."""

    t: float
    y: Array
    steps: int  # taken so far

    @property
    @abstractmethod
    def refused(self) -> InputError | None:
        """Why f had no value at a trial of the last advance, if it had none."""

    @abstractmethod
    def advance(self, times: Array) -> Array:
        """Go on, at most to the last of the times; rows (k, size) at the first k, which were passed.

        Raises Stuck where no step is small enough; t and y are then where it ended.
        """

    @abstractmethod
    def moved(self) -> None:
        """To be called when somebody has changed y."""


class RightHandSide:
    """ẏ for an integrator.

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
    """One step of one of SciPy's methods at a time, of any function, which is smooth `until` some time.

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
