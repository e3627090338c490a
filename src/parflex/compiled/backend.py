"""Backends: each turns a kernel into a function that runs on float arrays."""

import math
import threading
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.kernels.kernel import Kernel, Vectors

Trigger = Callable[[], None]
Given = Mapping[str, Array]


class Workspace(NamedTuple):
    """Inputs and outputs of one thread, and the call that goes from one to the other."""

    inputs: Vectors
    outputs: Vectors
    trigger: Trigger


class Function(ABC):
    """A kernel ready to run. Shared by threads; `bind` gives each caller a workspace of its own.

    Inputs that are not given are zero.
    """

    kernel: Kernel
    readable = False  # True of the mechanics itself, which takes milliseconds

    def __call__(self, **inputs: Array) -> Vectors:
        """Outputs (…, m_i) for inputs (…, n_i), whose leading axes broadcast together."""
        return self._batched(self._rows, inputs)

    def each(self, **inputs: Array) -> Vectors:
        """The outputs, without compiling anything further to be quicker about it."""
        return self._batched(self._each, inputs)

    def run(self, **inputs: Array) -> Vectors:
        """The outputs; quicker than a call for single vectors (n_i,), by way of this thread's workspace."""
        if any(a.ndim > 1 for a in inputs.values()):
            return self(**inputs)
        arguments, results, trigger = self.workspace
        for name, argument in arguments.items():
            argument[:] = inputs.get(name, 0.0)
        trigger()
        return {name: result.copy() for name, result in results.items()}

    @property
    def workspace(self) -> Workspace:
        """The workspace of this thread."""
        own = self.__dict__.get("_own") or self.__dict__.setdefault("_own", threading.local())
        if not hasattr(own, "workspace"):
            kernel = self.kernel
            inputs, outputs = (
                {k: np.zeros(n) for k, n in s.items()} for s in (kernel.inputs, kernel.outputs)
            )
            own.workspace = Workspace(inputs, outputs, self.bind(inputs, outputs))
        found: Workspace = own.workspace
        return found

    @abstractmethod
    def bind(self, inputs: Given, outputs: Given) -> Trigger:
        """A call without arguments that reads and writes these float64 vectors, which it keeps alive.

        An output that is not given is not stored.
        """

    @abstractmethod
    def _rows(self, rows: list[Array]) -> list[Array]:
        """Outputs (B, m_i) for contiguous inputs (B, n_i), in the kernel's order."""

    def _each(self, rows: list[Array]) -> list[Array]:
        return self._rows(rows)

    def _batched(self, run: Callable[[list[Array]], list[Array]], inputs: Given) -> Vectors:
        batch = np.broadcast_shapes(*(a.shape[:-1] for a in inputs.values()))
        rows = [
            np.ascontiguousarray(np.broadcast_to(a, batch + (n,)).reshape(math.prod(batch), n), dtype=float)
            for a, n in zip(in_order(self.kernel.inputs, inputs), self.kernel.inputs.values(), strict=True)
        ]
        found = zip(self.kernel.outputs, run(rows), strict=True)
        return {name: a.reshape(batch + a.shape[1:]) for name, a in found}


def in_order(sizes: Mapping[str, int], given: Given, fill: Callable[[int], Array] = np.zeros) -> list[Array]:
    """The given vectors in the order of a kernel's names, `fill(n)` for those that are not given.

    Raises InputError for a name that the kernel does not have.
    """
    if not given.keys() <= sizes.keys():
        raise InputError(f"{sorted(given.keys() - sizes.keys())} are none of {list(sizes)}")
    return [given[name] if name in given else fill(n) for name, n in sizes.items()]


class Backend(ABC):
    """A way of running kernels."""

    name: str

    @abstractmethod
    def compile(self, kernel: Kernel) -> Function:
        """The kernel, ready to run; may take a moment."""

    @abstractmethod
    def keeps(self, kernel: Kernel) -> bool:
        """True where compiling the kernel takes no time that a caller would notice."""

    @abstractmethod
    def version(self) -> str:
        """Name and version of what runs the kernels."""
