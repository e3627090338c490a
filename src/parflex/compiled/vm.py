"""Backend "vm": kernels traced into CasADi graphs and run by its virtual machine."""

import casadi
import numpy as np

from parflex.base.array import Array
from parflex.base.errors import NO_INERTIA, SingularPose
from parflex.compiled.backend import Backend, Function, Given, Trigger
from parflex.compiled.symbol import symbols, vector
from parflex.kernels.kernel import Kernel


def trace(kernel: Kernel) -> casadi.Function:
    """The CasADi graph of a kernel."""
    inputs, outputs = traced(kernel)
    return casadi.Function(kernel.name, inputs, outputs, {"cse": True})


def traced(kernel: Kernel) -> tuple[list[casadi.SX], list[casadi.SX]]:
    """The kernel itself, run on a batch of one state of symbols: inputs and outputs.

    Raises SingularPose where some link has no inertia at any state.
    """
    made = {name: symbols(name, size) for name, size in kernel.inputs.items()}
    try:
        found = kernel.function(**{name: array[None] for name, (_, array) in made.items()})
    except ZeroDivisionError:  # a constant pivot of an inertia matrix
        raise SingularPose(f"at any state, {NO_INERTIA}") from None
    return [sx for sx, _ in made.values()], [vector(found[name]) for name in kernel.outputs]


class VmFunction(Function):
    """A traced kernel. CasADi keeps no reference to the arrays it is given; the triggers do."""

    def __init__(self, kernel: Kernel) -> None:
        self.kernel = kernel
        self.graph = trace(kernel)

    def _rows(self, rows: list[Array]) -> list[Array]:
        arguments, results, trigger = self.workspace
        found = [np.empty((len(rows[0]), n)) for n in self.kernel.outputs.values()]
        for i in range(len(rows[0])):
            for argument, row in zip(arguments.values(), rows, strict=True):
                argument[:] = row[i]
            trigger()
            for store, result in zip(found, results.values(), strict=True):
                store[i] = result
        return found

    def bind(self, inputs: Given, outputs: Given) -> Trigger:
        buffer, run = self.graph.buffer()
        for given, names, put in (
            (inputs, self.kernel.inputs, buffer.set_arg),
            (outputs, self.kernel.outputs, buffer.set_res),
        ):
            for i, name in enumerate(names):
                if name in given and given[name].size:
                    put(i, given[name].data)
        kept = (buffer, tuple(inputs.values()), tuple(outputs.values()))

        def trigger(_kept: object = kept) -> None:
            run()

        return trigger


class VmBackend(Backend):
    """CasADi's virtual machine; needs no compiler."""

    name = "vm"

    def compile(self, kernel: Kernel) -> Function:
        return VmFunction(kernel)

    def keeps(self, kernel: Kernel) -> bool:
        return False

    def version(self) -> str:
        return f"CasADi {casadi.__version__} virtual machine"
