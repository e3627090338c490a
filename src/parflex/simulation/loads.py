"""The wrenches that act on a platform during a simulation."""

from collections.abc import Callable, Sequence

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.mechanics.wrench import generalised_force, places_of, pushed, pushes_of
from parflex.model.core import core_of
from parflex.model.model import Model
from parflex.robot.layout import coordinates
from parflex.robot.state import State
from parflex.robot.wrench import Wrench

Wrenches = Sequence[Wrench] | Callable[[float], Sequence[Wrench]]


class Loads:
    """Constant wrenches, or a function of time that gives them.

    Constant ones are read by the compiled motion: `places` and `pushes` (6 L,). What a function
    gives is turned into generalised forces (6 + N,) at every call.

    Raises InputError for a batch of wrenches, and as `wrench.generalised_force`.
    """

    def __init__(self, model: Model, wrenches: Wrenches) -> None:
        self._core, self._body = core_of(model), model.robot.platform
        self._function = wrenches if callable(wrenches) else None
        self._none = np.zeros(6 + self._body.modes)
        constant: Sequence[Wrench] = () if callable(wrenches) else wrenches
        self._force(model.robot.home, constant)
        self.places, self.pushes = places_of(constant), pushes_of(constant)

    @property
    def steady(self) -> bool:
        """True where they are constant."""
        return self._function is None

    def __call__(self, t: float, x: Array) -> Array:
        """(6 + N,), without the constant ones."""
        if self._function is None:
            return self._none
        return self._force(self._core.state(x), self._function(t))

    def at(self, t: Array, x: Array) -> tuple[Array, BaseException | None]:
        """(T, 6 + N) at times (T,) and flat states, without the constant ones; as `at_times`."""
        if self.steady:
            return np.tile(self._none, (len(t), 1)), None
        return at_times(self, t, x, len(self._none))

    def constant(self, x: Array) -> Array:
        """(T, 6 + N) of the constant ones at flat states (T, size)."""
        c = coordinates(x, self._core.mechanism.layout)
        return pushed(self._body, self.places, self.pushes, c.rotation, c.elastic)

    def _force(self, state: State, wrenches: Sequence[Wrench]) -> Array:
        w = generalised_force(self._body, state, wrenches)
        if w.ndim != 1:
            raise InputError(f"wrenches are a batch {w.shape[:-1]}; a simulation takes single ones")
        return w


def at_times(
    function: Callable[[float, Array], Array], t: Array, x: Array, size: int
) -> tuple[Array, BaseException | None]:
    """Rows (T, size) of a function of times (T,) and flat states (T, n), and the first thing that it raised.

    Rows where it raises something are not numbers; after Ctrl-C it is not called any more.
    """
    rows, raised = np.full((len(t), size), np.nan), None
    for i, time in enumerate(t):
        try:
            rows[i] = function(time, x[i])
        except KeyboardInterrupt as interrupt:
            return rows, interrupt
        except Exception as error:  # a caller's function may raise anything; the other rows are worth keeping
            raised = raised or error
    return rows, raised
