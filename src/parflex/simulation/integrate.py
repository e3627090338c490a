"""The integration of a run: a stepper advances, observers look, rows at the output times are kept."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError, OutOfReach, SingularPose
from parflex.robot.layout import Layout
from parflex.simulation.laws.law import WORKS
from parflex.simulation.observers import DIVERGES, Advance, Observer
from parflex.simulation.steppers.stepper import Stepper, Stuck

INTERRUPTED = "interrupted"


@dataclass
class Run:
    """The output times (T,) of a run, and what was reached of it."""

    times: Array
    rows: list[Array]  # y (k, size) at the first output times, advance by advance
    reached: float  # s
    stopped: str = ""  # when and why it ended early; empty where it did not
    cause: BaseException | None = None  # what was raised by others, if that ended it
    done: int = 1  # rows
    n_works: int = WORKS  # numbers behind the states in the rows

    @property
    def left(self) -> Array:
        """The output times that are still to be reached; none of a run that has stopped."""
        return self.times[:0] if self.stopped else self.times[self.done :]

    def take(self, advance: Advance) -> None:
        """Keep what an advance brought."""
        self.rows.append(advance.rows)
        self.done += len(advance.rows)
        self.reached = advance.reached
        if advance.stopped:
            self.stop(advance.stopped)

    def stop(self, why: str, cause: BaseException | None = None, when: str = "") -> None:
        """Say why the run ends, by default at the time reached."""
        when = when or f"at t = {self.reached:.6g} s"
        self.stopped, self.cause = f"{when}: {why}", cause

    def fail(self, error: BaseException, when: str = "") -> None:
        """Say that an error ends the run."""
        if isinstance(error, KeyboardInterrupt):
            self.stop(INTERRUPTED, error, when)
        elif isinstance(error, InputError):
            self.stop(str(error), None, when)
        else:
            self.stop(f"{type(error).__name__}: {error}", error, when)

    def keep(self, t: Array, y: Array) -> None:
        """Add states (k, size) between the output times, those at times (k,) that lie beyond the last one."""
        later = t > self.times[self.done - 1]
        self.times = np.concatenate([self.times[: self.done], t[later]])
        self.rows.append(y[later])
        self.done = len(self.times)

    @property
    def t(self) -> Array:
        """The times (k,) of the states: output times, and others before the end of a run that diverged."""
        return self.times[: self.done]

    @cached_property
    def x(self) -> Array:
        """Flat states (k, size) at these times."""
        x = np.concatenate(self.rows)[:, : -self.n_works]
        quaternion = Layout(0).at.quaternion
        x[:, quaternion] /= np.linalg.norm(x[:, quaternion], axis=1, keepdims=True)
        return x

    @cached_property
    def works(self) -> Array:
        """Works (k, w) J at these times, of actuators, wrenches, damping and what moves the surroundings."""
        return np.concatenate(self.rows)[:, -self.n_works :]


def integrate(
    times: Array,
    y: Array,
    begin: Callable[[], Stepper],
    observers: Sequence[Observer],
    works: int = WORKS,
) -> Run:
    """The run from y (size,) on, the last so many of which are works, as far as it comes.

    Raises InputError where the start is refused; whatever else happens is told by the run.
    """
    run = Run(times, [y[None].copy()], times[0], n_works=works)
    stepper: Stepper | None = None
    try:
        stepper = begin()
        while len(left := run.left):
            rows = stepper.advance(left)
            advance = Advance(stepper, left[: len(rows)], rows, stepper.t)
            for observer in observers:
                observer.see(advance)
            run.take(advance)
    except Stuck:
        assert stepper is not None
        refused = stepper.refused
        explained = str(refused or first(observer.explain() for observer in observers) or DIVERGES)
        run.stop(diagnosis(observers, refused) or explained)
    except (Exception, KeyboardInterrupt) as error:  # what others raise must not cost what was reached
        if stepper is None and isinstance(error, InputError):
            raise
        if cause := diagnosis(observers, error):
            run.stop(cause)
        else:
            run.fail(error)
    for observer in observers:
        if run.stopped and run.cause is None and observer.diagnosis():
            run.keep(*observer.last_states())
    return run


def diagnosis(observers: Sequence[Observer], error: BaseException | None) -> str:
    """The cause that an observer knows behind what ended a run; empty where none does.

    Errors other than those of poses are causes themselves.
    """
    if error is not None and not isinstance(error, (OutOfReach, SingularPose)):
        return ""
    return first(observer.diagnosis() for observer in observers)


def first(words: Iterable[str]) -> str:
    """The first text that is not empty, or an empty one."""
    return next(filter(None, words), "")
