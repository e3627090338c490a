"""Backend "numpy": the mechanics itself, on float arrays; batches in one pass."""

import numpy as np

from parflex.base.array import Array
from parflex.compiled.backend import Backend, Function, Given, Trigger, in_order
from parflex.kernels.kernel import Kernel


class NumpyFunction(Function):
    """A kernel called as it stands."""

    readable = True

    def __init__(self, kernel: Kernel) -> None:
        self.kernel = kernel

    def _rows(self, rows: list[Array]) -> list[Array]:
        with np.errstate(divide="ignore", invalid="ignore"):  # a bad pose shows in the legs' health
            found = self.kernel.function(**dict(zip(self.kernel.inputs, rows, strict=True)))
        return [
            np.array(np.broadcast_to(found[name], (len(rows[0]), n)), dtype=float)
            for name, n in self.kernel.outputs.items()
        ]

    def bind(self, inputs: Given, outputs: Given) -> Trigger:
        given = in_order(self.kernel.inputs, inputs)

        def trigger() -> None:
            found = dict(zip(self.kernel.outputs, self._rows([a[None] for a in given]), strict=True))
            for name, out in outputs.items():
                out[:] = found[name][0]

        return trigger


class NumpyBackend(Backend):
    """The readable reference; nothing is traced."""

    name = "numpy"

    def compile(self, kernel: Kernel) -> Function:
        return NumpyFunction(kernel)

    def keeps(self, kernel: Kernel) -> bool:
        return True

    def version(self) -> str:
        return f"NumPy {np.__version__}"
