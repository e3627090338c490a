"""Backend "vm": kernels traced into CasADi graphs and run by its virtual machine."""

from collections.abc import Sequence

import casadi
import numpy as np

from parflex.base.array import Array
from parflex.base.errors import NO_INERTIA, SingularPose
from parflex.compiled.backend import Backend, Function, Trigger, flat_batch
from parflex.compiled.symbol import symbols, vector
from parflex.kernels.kernel import Kernel


def trace(kernel: Kernel) -> casadi.Function:
    """The CasADi graph of a kernel."""
    inputs, outputs = traced(kernel)
    return casadi.Function(kernel.name, inputs, outputs, {"cse": True})


def traced(kernel: Kernel) -> tuple[list[casadi.SX], list[casadi.SX]]:
    """The kernel itself, run on a batch of one state of symbols: inputs and outputs."""
    inputs = [symbols(f"i{i}", size) for i, size in enumerate(kernel.inputs)]
    try:
        outputs = kernel.function(*(array[None] for _, array in inputs))
    except ZeroDivisionError:  # a constant pivot of an inertia matrix
        raise SingularPose(f"at any state, {NO_INERTIA}") from None
    return [sx for sx, _ in inputs], [vector(array) for array in outputs]


class VmFunction(Function):
    """A traced kernel. CasADi keeps no reference to the arrays it is given; the triggers do."""

    def __init__(self, kernel: Kernel) -> None:
        self.kernel = kernel
        self.graph = trace(kernel)

    def __call__(self, *inputs: Array) -> tuple[Array, ...]:
        batch, rows = flat_batch(self.kernel, inputs)
        arguments, results, trigger = self.workspace
        count = rows[0].shape[0]
        found = [np.empty((count, n)) for n in self.kernel.outputs]
        for i in range(count):
            for argument, row in zip(arguments, rows, strict=True):
                argument[:] = row[i]
            trigger()
            for store, result in zip(found, results, strict=True):
                store[i] = result
        return tuple(a.reshape(batch + a.shape[1:]) for a in found)

    def bind(self, inputs: Sequence[Array | None], outputs: Sequence[Array | None]) -> Trigger:
        buffer, run = self.graph.buffer()
        for i, a in enumerate(inputs):
            if a is not None and a.size:
                buffer.set_arg(i, a.data)
        for i, a in enumerate(outputs):
            if a is not None and a.size:
                buffer.set_res(i, a.data)
        kept = (buffer, tuple(inputs), tuple(outputs))

        def trigger(_kept: object = kept) -> None:
            run()

        return trigger


class VmBackend(Backend):
    """CasADi's virtual machine; needs no compiler."""

    name = "vm"

    def compile(self, kernel: Kernel) -> Function:
        return VmFunction(kernel)

    def version(self) -> str:
        return f"CasADi {casadi.__version__} virtual machine"
