"""Exact derivatives of a kernel at one point, by its graph: for what is asked once, and not compiled."""

from collections.abc import Mapping, Sequence

import casadi

from parflex.base.array import Array
from parflex.compiled.vm import traced
from parflex.kernels.kernel import Kernel


def slopes(kernel: Kernel, output: str, inputs: Sequence[str], given: Mapping[str, Array]) -> list[Array]:
    """∂output/∂input (o, i) of some inputs, where the inputs have the values (i,) that are given."""
    arguments, results = traced(kernel)
    names, wanted = list(kernel.inputs), results[list(kernel.outputs).index(output)]
    parts = [casadi.jacobian(wanted, arguments[names.index(name)]) for name in inputs]
    found = casadi.Function("slopes", arguments, parts).call([given[name] for name in names])
    return [part.full() for part in found]
