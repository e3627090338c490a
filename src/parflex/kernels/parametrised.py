"""Kernels that take the robot's parameters θ (P,) as one more, last input; and such ones at given θ."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from parflex.base.array import Array
from parflex.kernels.kernel import Kernel
from parflex.mechanics.designs import placed
from parflex.robot.parameters import Parameters

Build = Callable[..., Kernel]


@dataclass(frozen=True)
class Parametrised(Kernel):
    """A kernel whose last input is θ (…, P)."""

    own: Array  # θ of the robot itself

    def probe(self, count: int) -> list[Array]:
        """As of any kernel, with parameters near the robot's own."""
        *inputs, _ = super().probe(count)
        more = np.random.default_rng(1).uniform(0.0, 1e-2, (count, len(self.own)))
        return [*inputs, self.own + more * np.where(self.own == 0, 0.1, self.own)]


def parametrised(parameters: Parameters, build: Build, *chosen: object) -> Kernel:
    """What `build` makes of the robot and of what else it takes, for any θ."""
    plain = build(parameters.first, *chosen)

    def at(theta: Array) -> Callable[..., tuple[Array, ...]]:
        return build(placed(parameters, theta), *chosen).function

    return for_any(parameters, plain, at)


def for_any(parameters: Parameters, plain: Kernel, at: Callable[[Array], Callable[..., Any]]) -> Kernel:
    """The kernel whose function for θ (P,) is `at(θ)`, otherwise like a plain one."""

    def function(*inputs: Array) -> tuple[Array, ...]:
        *given, theta = inputs
        if len(theta) == 1:
            only: tuple[Array, ...] = at(theta[0])(*given)
            return only
        designs, which = np.unique(theta, axis=0, return_inverse=True)
        found = [np.empty((len(theta), n)) for n in plain.outputs]
        for i, design in enumerate(designs):
            rows = which == i
            for whole, part in zip(found, at(design)(*(a[rows] for a in given)), strict=True):
                whole[rows] = part
        return tuple(found)

    return Parametrised(
        plain.name,
        function,
        (*plain.inputs, parameters.size),
        plain.outputs,
        (*plain.subject, parameters.names),
        parameters.own,
    )
