"""The interface by which a simulation drives an integrator."""

from abc import ABC, abstractmethod

from parflex.base.array import Array
from parflex.base.errors import InputError


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
        """The error by which f refused a trial state of the last advance, if it refused one."""

    @abstractmethod
    def advance(self, times: Array) -> Array:
        """Go on, at most to the last of the times; rows (k, size) at the first k, which were passed.

        Raises Stuck where no step is small enough; t and y are then where it ended.
        """

    @abstractmethod
    def moved(self) -> None:
        """Take note that y was changed from outside."""
