"""Vectors that surroundings impose on a robot over time: its base's motion, the rests of its springs."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import finite
from parflex.base.errors import InputError
from parflex.kernels.kernel import Kernel
from parflex.kernels.moved_base import AT_REST, BASE, moved_base, with_base
from parflex.kernels.moved_rests import REST, moved_rests
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.spring_rests import with_rests
from parflex.robot.base_motion import BaseMotion
from parflex.robot.robot import Robot
from parflex.simulation.surroundings.base_samples import BaseSamples

BaseFunction = Callable[[float], BaseMotion]
RestFunction = Callable[[float], tuple[ArrayLike, ArrayLike]]


class Imposed(ABC):
    """A vector (size,) that kernels read as one more input, as a function of time that somebody gives.

    `kernel` makes the kernel that reads it, of a mechanism, a builder and its arguments; `changed` is the
    mechanism of a vector. Raises InputError where what is given is no function.
    """

    name: ClassVar[str]  # of the input
    kernel: ClassVar[Callable[..., Kernel]]
    changed: ClassVar[Callable[..., Mechanism]]

    def __init__(self, function: Any, size: int) -> None:
        if not callable(function):
            what, name = type(function).__name__, self.name
            raise InputError(f"{name} is {what}; give a function of time, {name}(t)")
        self.function, self.size = function, size
        self._last: tuple[float, Array] | None = None  # observers ask for the time of the last evaluation

    def __call__(self, t: float) -> Array:
        """The vector at a time; raises InputError where the function gives none."""
        if self._last is None or self._last[0] != t:
            self._last = (t, self.vector(self.function(t)))
        return self._last[1]

    def at(self, t: float, x: Array) -> Array:
        """The vector at a time, whatever the state is."""
        return self(t)

    def rows(self, t: Array) -> Array:
        """(T, size) at times (T,)."""
        return np.array([self(float(time)) for time in t]).reshape(len(t), self.size)

    def check_covers(self, times: Array) -> None:
        """Raise InputError for times (T,) at which it is known to give nothing."""
        return

    @property
    def longest(self) -> float:
        """The longest step (s) that steps over nothing; infinite where nothing is known of it."""
        return np.inf

    @abstractmethod
    def vector(self, given: Any) -> Array:
        """The flat vector of what the function gives."""


class MovingBase(Imposed):
    """The base's motion (19,), of a function of time that gives BaseMotions."""

    name = BASE
    kernel = staticmethod(moved_base)
    changed = staticmethod(with_base)

    def __init__(self, function: Any) -> None:
        super().__init__(function, len(AT_REST))

    def vector(self, given: Any) -> Array:
        if not isinstance(given, BaseMotion):
            raise InputError(f"base(t) gave {type(given).__name__}; give a BaseMotion")
        if given.batch:
            raise InputError(f"base(t) gave a batch {given.batch} of motions; give a single one")
        return given.flat

    def rows(self, t: Array) -> Array:
        return self.function(t).flat if isinstance(self.function, BaseSamples) else super().rows(t)

    def check_covers(self, times: Array) -> None:
        if isinstance(self.function, BaseSamples):
            self.function(times[[0, -1]])

    @property
    def longest(self) -> float:
        return self.function.longest if isinstance(self.function, BaseSamples) else np.inf


class MovingRests(Imposed):
    """The rests of springs and their rates (2 s,), of a function of time that gives both."""

    name = REST
    kernel = staticmethod(moved_rests)
    changed = staticmethod(with_rests)

    def __init__(self, function: Any, robot: Robot) -> None:
        super().__init__(function, 2 * len(robot.springs))
        if not robot.springs:
            raise InputError("rest is given, but no joint of the robot has a spring (k > 0); leave it out")

    def vector(self, given: Any) -> Array:
        s = self.size // 2
        if not isinstance(given, (tuple, list)) or len(given) != 2:
            raise InputError(
                f"rest(t) gave {type(given).__name__}; give a pair, rests ({s},) and their rates"
            )
        parts = [finite(f"rest(t)[{k}]", part) for k, part in enumerate(given)]
        for k, part in enumerate(parts):
            if part.shape != (s,):
                raise InputError(
                    f"rest(t)[{k}] has shape {part.shape}; give ({s},), one for each spring of the robot, in "
                    f"the order of robot.springs"
                )
        return np.concatenate(parts)


IMPOSED: dict[str, type[Imposed]] = {kind.name: kind for kind in (MovingBase, MovingRests)}
