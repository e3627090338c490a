"""Observers look at a run after each advance of its stepper: closure, singularities, crawl, progress."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from parflex.analysis.health import OFF, check_state
from parflex.analysis.watch import Watch
from parflex.base.array import Array
from parflex.base.progress import Progress
from parflex.kernels.projection import projection
from parflex.mechanics.closure import CLOSED
from parflex.model.core import Core
from parflex.simulation.steppers.stepper import Stepper
from parflex.simulation.surroundings.standpoint import Standpoint

DIVERGES = "the step size vanished: it diverges"
PROJECTIONS = 5  # at most, of one state onto the closure
STRAINED = (
    "the legs cannot follow: a gap of {:.2g} m to the attachment of leg {} does not close, since more of the "
    "closure equations depend on others at home than here (model.mobility counts them): some freedoms are "
    "for small motions alone; hold the platform against these, or give the legs the joints they lack"
)
SMALLEST, PATIENCE = 1e-6, 1000  # a mean step below this part of the run, over so many, ends it


@dataclass
class Advance:
    """The gain of one advance: y (k, size) at the output times (k,) that were passed, and the stepper."""

    stepper: Stepper
    times: Array
    rows: Array
    reached: float  # s
    stopped: str = ""  # why the run ends here


class Observer(ABC):
    """Something that looks at a run."""

    def begin(self, y: Array) -> None:
        """Look at the start, or change it; raises InputError where the run cannot start there."""
        return

    @abstractmethod
    def see(self, advance: Advance) -> None:
        """Look at an advance: change its rows and the stepper's y, or say that the run ends here."""

    def explain(self) -> str:
        """The reason why the stepper may be stuck; empty where none is known."""
        return ""

    def diagnosis(self) -> str:
        """The cause behind whatever ended the run; empty where none is known."""
        return ""

    def last_states(self) -> tuple[Array, Array]:
        """Times (k,) and y (k, size) that show how the run came to its end, where it has a diagnosis."""
        return np.zeros(0), np.zeros((0, 0))


class Closure(Observer):
    """States are put back onto the closure of the legs, in the metric of the robot's mass."""

    def __init__(self, core: Core, standpoint: Standpoint, start: float) -> None:
        self._standpoint, self._start = standpoint, start
        self._functions = core.functions
        function = core.functions(projection)
        self._x = np.zeros(function.kernel.inputs["x"])
        found = {name: np.zeros(n) for name, n in function.kernel.outputs.items()}
        self._moved, self._health = found["projected"], found["health"]
        self._run = function.bind({"x": self._x}, found)
        self._tolerance = CLOSED * core.mechanism.size
        self._at, dependent = core.mechanism.health, function.kernel.mechanism.solved_rows.dropped
        self._open = OFF * min(1.0, core.mechanism.size) if len(dependent) else np.inf

    def begin(self, y: Array) -> None:
        self._x[:] = self._standpoint.seen(self._start, y[: len(self._x)])
        self._run()
        check_state(self._functions, self._x, self._health)
        self.close(self._start, y)

    def see(self, advance: Advance) -> None:
        for number, row in enumerate(advance.rows):
            if why := self.close(advance.times[number], row):
                advance.rows, advance.reached = advance.rows[:number], advance.times[number]
                advance.stopped = why
                return
        advance.stopped = self.close(advance.stepper.t, advance.stepper.y)
        advance.stepper.moved()

    def close(self, t: float, y: Array) -> str:
        """Put the state in y (size,) on the closure, by at most so many projections; says what stays open."""
        x = y[: len(self._x)]
        self._x[:] = self._standpoint.seen(t, x)
        for _ in range(PROJECTIONS):
            self._run()
            if not np.max(np.abs(self._health[self._at.gap.start :])) > self._tolerance:
                break
            self._x[:] = self._moved
        x[:] = self._standpoint.carried(t, self._x)
        gaps = np.abs(self._health[self._at.gap])
        if not np.max(gaps) > self._open:
            return ""
        return STRAINED.format(np.max(gaps), self._at.gap_legs[np.argmax(gaps)] + 1)


class Singularities(Observer):
    """The run ends before a singularity that the law's watch sees."""

    def __init__(self, watch: Watch, size: int, standpoint: Standpoint, start: float) -> None:
        self._watch, self._size = watch, size
        self._standpoint, self._start = standpoint, start

    def begin(self, y: Array) -> None:
        self._watch.look(self._standpoint.seen(self._start, y[: self._size])[None])

    def see(self, advance: Advance) -> None:
        states = np.vstack([advance.rows, advance.stepper.y])[:, : self._size]
        times = np.append(advance.times, advance.stepper.t)
        before, advance.stopped = self._watch.look(self._standpoint.seen(times, states))
        if before < len(advance.rows):
            advance.rows, advance.reached = advance.rows[:before], advance.times[before]

    def explain(self) -> str:
        return self._watch.explain()


class Crawl(Observer):
    """The run ends where its steps have become so small that it would never end."""

    def __init__(self, start: float, end: float, explain: Callable[[], str]) -> None:
        self._least, self._explain = SMALLEST * PATIENCE * (end - start), explain
        self._steps, self._t = 0, start

    def see(self, advance: Advance) -> None:
        stepper = advance.stepper
        if stepper.steps - self._steps >= PATIENCE:
            if stepper.t - self._t < self._least:
                advance.stopped = self._explain() or DIVERGES
            self._steps, self._t = stepper.steps, stepper.t


class Bar(Observer):
    """A progress bar shows the time that was reached."""

    def __init__(self, bar: Progress, start: float) -> None:
        self._bar, self._start = bar, start

    def see(self, advance: Advance) -> None:
        self._bar.to(advance.reached - self._start)
