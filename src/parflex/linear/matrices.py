"""The matrices of a linear system, and what they are about."""

from dataclasses import dataclass, field

from parflex.base.array import Array
from parflex.linear.closed import Feedback
from parflex.linear.point import Point


@dataclass(frozen=True, eq=False)
class Matrices:
    """A (2d, 2d), B (2d, r), C (o, 2d) and D (o, r), the labels and units of inputs and outputs."""

    A: Array
    B: Array
    C: Array
    D: Array
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    input_units: tuple[str, ...]
    output_units: tuple[str, ...]
    by_acceleration: Array = field(repr=False)  # (o, d), what outputs see of accelerations
    point: Point = field(repr=False)
    feedback: Feedback | None = field(default=None, repr=False)
    base_states: int = field(default=0, repr=False)  # the last ones, turns and rates of the base

    @property
    def own(self) -> Array:
        """A without the states of the base."""
        n = len(self.A) - self.base_states
        return self.A[:n, :n]
