"""A parametrised function at given parameters."""

from collections.abc import Sequence

import numpy as np

from parflex.base.array import Array
from parflex.compiled.backend import Function, Trigger
from parflex.kernels.kernel import Kernel


class At(Function):
    """A parametrised function at given θ (…, P), called like one that has none."""

    def __init__(self, function: Function, theta: Array) -> None:
        self.function, self.theta, self.kernel = function, theta, fixed(function.kernel, theta)

    def __call__(self, *inputs: Array) -> tuple[Array, ...]:
        return self.function(*inputs, self.theta)

    def run(self, *inputs: Array) -> tuple[Array, ...]:
        return self.function.run(*inputs, self.theta)

    def each(self, *inputs: Array) -> tuple[Array, ...]:
        return self.function.each(*inputs, self.theta)

    def bind(self, inputs: Sequence[Array | None], outputs: Sequence[Array | None]) -> Trigger:
        return self.function.bind([*inputs, self.theta], outputs)


def fixed(whole: Kernel, theta: Array) -> Kernel:
    """The kernel without its last input, which is θ (…, P)."""

    def function(*inputs: Array) -> tuple[Array, ...]:
        batch = np.broadcast_shapes(*(a.shape[:-1] for a in inputs))
        return whole.function(*inputs, np.broadcast_to(theta, batch + theta.shape[-1:]))

    return Kernel(whole.name, function, whole.inputs[:-1], whole.outputs, whole.subject)
