"""A control law as it is compiled: its kernel, the derivative, and the rows that the kernel reads."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from parflex.analysis.watch import Watch
from parflex.base.array import Array
from parflex.kernels.kernel import Kernel
from parflex.mechanics.output import Output

WORKS = 3  # of actuators, external wrenches and damping, of every run: integrated beside the state


class Inputs(NamedTuple):
    """The vectors that the kernel of a motion reads."""

    x: Array  # (size,), and behind it the law's memory
    time: Array  # (1,) s
    row: Array  # of the law
    load: Array  # (6 + N,) a generalised force, beside the constant wrenches
    pushes: Array  # (6 L,) the constant wrenches


class Outputs(NamedTuple):
    """The vectors that the kernel of a motion gives."""

    forces: Array  # Γ (m,)
    rate: Array  # ẋ (size,), and that of the memory
    powers: Array  # (works,) W of actuators, wrenches and damping, and of what moves the surroundings
    contact: Array  # contact forces by tip (3k,)
    health: Array


class Replay(NamedTuple):
    """The forces and the motion of a law at times (T,): all rows (T, …)."""

    forces: Array  # Γ (T, m)
    rate: Array  # ẋ (T, size)
    contact: Array  # contact forces by tip (T, 3k)
    load: Array  # external generalised forces (T, 6 + N)
    imposed: dict[str, Array]  # the motion of the surroundings, as the kernel reads it
    raised: BaseException | None = None  # the first thing that a caller's function raised


@dataclass(frozen=True)
class Law:
    """A controller gives this to be compiled, with the rows of numbers by which the compiled law acts.

    kernel and derivative are functions (mechanism, *outputs, places) that make the kernels of the motion
    under the law and of its ∂ẋ/∂x. The first of the rows (r, n) holds from the beginning, and from each
    of the times `starts` on the next.
    """

    kernel: Callable[..., Kernel]
    derivative: Callable[..., Kernel]
    rows: Array
    starts: Array = field(default_factory=lambda: np.zeros(0))  # (r − 1,) s
    outputs: tuple[Output, ...] = ()
    differentiable: bool = True  # whether the derivative holds for this robot and these outputs
    memory: int = 0  # numbers that it integrates for itself, zero at the start
    watch: Watch | None = None  # what looks out for singularities during one simulation
