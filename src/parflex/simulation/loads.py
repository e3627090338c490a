"""The outer world of a robot during a simulation: wrenches on its platform, and surroundings that move."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from parflex.base.array import Array
from parflex.base.check import of_type
from parflex.base.errors import InputError
from parflex.kernels.moved_base import BASE
from parflex.kernels.moved_rests import REST
from parflex.kernels.parametrised import Build
from parflex.mechanics.wrench import generalised_force, places_of, pushed, pushes_of
from parflex.model.core import core_of
from parflex.model.model import Model
from parflex.robot.layout import coordinates
from parflex.robot.state import State
from parflex.robot.wrench import Wrench
from parflex.simulation.surroundings.at_times import at_times
from parflex.simulation.surroundings.imposed import (
    BaseFunction,
    Imposed,
    MovingBase,
    MovingRests,
    RestFunction,
)
from parflex.simulation.surroundings.standpoint import FIXED, Carried, Standpoint

Wrenches = Sequence[Wrench] | Callable[[float], Sequence[Wrench]]


class Loads:
    """Constant wrenches, or a function of time that gives them; and the surroundings that move.

    Constant ones are read by the compiled motion: `places` and `pushes` (6 L,). What a function
    gives is turned into generalised forces (6 + N,) at every call. `imposed` are the vectors by which
    surroundings move, by the names of the inputs that read them, in the order of the works that they do.

    Raises InputError for a batch of wrenches, and as `wrench.generalised_force`.
    """

    def __init__(
        self,
        model: Model,
        wrenches: Wrenches,
        base: BaseFunction | None = None,
        rest: RestFunction | None = None,
    ) -> None:
        self._core, self._body = core_of(model), model.robot.platform
        self._function = wrenches if callable(wrenches) else None
        self._none = np.zeros(6 + self._body.modes)
        constant: Sequence[Wrench] = () if callable(wrenches) else wrenches
        self._force(model.robot.home, constant)
        self.places, self.pushes = places_of(constant), pushes_of(constant)
        self.imposed: dict[str, Imposed] = {}
        self.standpoint: Standpoint = FIXED
        if base is not None:
            moving = MovingBase(base)
            self.imposed[BASE], self.standpoint = moving, Carried(moving)
        if rest is not None:
            self.imposed[REST] = MovingRests(rest, model.robot)

    @property
    def steady(self) -> bool:
        """True where they are constant."""
        return self._function is None

    def reading(self, build: Build, *chosen: object) -> tuple[Any, ...]:
        """The builder of a kernel that reads what is imposed, and its arguments, for `Functions`."""
        return (*(each.kernel for each in self.imposed.values()), build, *chosen)

    @property
    def longest(self) -> float:
        """The longest step (s) that does not step over what is known of the surroundings."""
        return min((each.longest for each in self.imposed.values()), default=np.inf)

    def flat(self, t: float, state: State) -> Array:
        """The flat state (size,) of one state at a time; raises as `Core.flat`, and for a batch."""
        if of_type("state", state, State).batch:
            raise InputError(f"state is a batch {state.batch}; simulate one state at a time")
        return self.standpoint.carried(t, self._core.flat(self.standpoint.state_seen(t, state)))

    def state(self, t: float, x: Array) -> State:
        """The state of a flat vector at a time, as callers' functions are given it."""
        return self.standpoint.state_carried(t, self._core.state(self.standpoint.seen(t, x)))

    def __call__(self, t: float, x: Array) -> Array:
        """(6 + N,), without the constant ones."""
        if self._function is None:
            return self._none
        return self._force(self.state(t, x), self._function(t))

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
