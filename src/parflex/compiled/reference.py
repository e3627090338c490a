"""Backend "numpy": the mechanics itself, on float arrays; batches in one pass."""

from collections.abc import Sequence

import numpy as np

from parflex.base.array import Array
from parflex.compiled.backend import Backend, Function, Trigger, flat_batch
from parflex.kernels.kernel import Kernel


class NumpyFunction(Function):
    """A kernel called as it stands."""

    def __init__(self, kernel: Kernel) -> None:
        self.kernel = kernel

    def __call__(self, *inputs: Array) -> tuple[Array, ...]:
        batch, rows = flat_batch(self.kernel, inputs)
        with np.errstate(divide="ignore", invalid="ignore"):  # a bad pose shows in the leg margins
            found = self.kernel.function(*rows)
        return tuple(
            np.array(np.broadcast_to(a, rows[0].shape[:1] + (n,)), dtype=float).reshape(batch + (n,))
            for a, n in zip(found, self.kernel.outputs, strict=True)
        )

    def bind(self, inputs: Sequence[Array | None], outputs: Sequence[Array | None]) -> Trigger:
        given = [np.zeros(n) if a is None else a for a, n in zip(inputs, self.kernel.inputs, strict=True)]

        def trigger() -> None:
            for out, value in zip(outputs, self(*given), strict=True):
                if out is not None:
                    out[:] = value

        return trigger


class NumpyBackend(Backend):
    """The readable reference; nothing is traced."""

    name = "numpy"

    def compile(self, kernel: Kernel) -> Function:
        return NumpyFunction(kernel)

    def version(self) -> str:
        return f"NumPy {np.__version__}"
