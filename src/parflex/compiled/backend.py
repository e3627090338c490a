"""What a backend is: it turns a kernel into something that runs on float arrays."""

import math
import threading
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence

import numpy as np

from parflex.base.array import Array
from parflex.kernels.kernel import Kernel

Trigger = Callable[[], None]
Workspace = tuple[list[Array], list[Array], Trigger]


class Function(ABC):
    """A kernel ready to run. Shared by threads; `bind` gives each caller a workspace of its own."""

    kernel: Kernel

    @abstractmethod
    def __call__(self, *inputs: Array) -> tuple[Array, ...]:
        """Outputs (…, m_i) for inputs (…, n_i) with equal leading axes."""

    def each(self, *inputs: Array) -> tuple[Array, ...]:
        """As a call, but nothing further is compiled to be quicker about it."""
        return self(*inputs)

    def run(self, *inputs: Array) -> tuple[Array, ...]:
        """As a call; quicker for single vectors (n_i,), which go by way of this thread's own."""
        if any(a.ndim > 1 for a in inputs):
            return self(*inputs)
        arguments, results, trigger = self.workspace
        for argument, given in zip(arguments, inputs, strict=True):
            argument[:] = given
        trigger()
        return tuple(result.copy() for result in results)

    @property
    def workspace(self) -> Workspace:
        """Inputs and outputs of this thread, and the call that goes from one to the other."""
        own = self.__dict__.get("_own") or self.__dict__.setdefault("_own", threading.local())
        if not hasattr(own, "workspace"):
            arguments, results = (
                [np.zeros(n) for n in sizes] for sizes in (self.kernel.inputs, self.kernel.outputs)
            )
            own.workspace = arguments, results, self.bind(arguments, results)
        found: Workspace = own.workspace
        return found

    @abstractmethod
    def bind(self, inputs: Sequence[Array | None], outputs: Sequence[Array | None]) -> Trigger:
        """A call without arguments that reads and writes these float64 vectors.

        An input that is None is zero; an output that is None is not stored. The trigger keeps the
        arrays alive.
        """


class Backend(ABC):
    """A way of running kernels."""

    name: str

    @abstractmethod
    def compile(self, kernel: Kernel) -> Function:
        """The kernel, ready to run; may take a moment."""

    @abstractmethod
    def version(self) -> str:
        """Name and version of what runs the kernels."""


def flat_batch(kernel: Kernel, inputs: Sequence[Array]) -> tuple[tuple[int, ...], list[Array]]:
    """The batch shape and the inputs as contiguous (B, n_i)."""
    batch = np.broadcast_shapes(*(a.shape[:-1] for a in inputs))
    rows = [
        np.ascontiguousarray(np.broadcast_to(a, batch + (n,)).reshape(math.prod(batch), n), dtype=float)
        for a, n in zip(inputs, kernel.inputs, strict=True)
    ]
    return batch, rows
