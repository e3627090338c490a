"""A function some of whose inputs are given once and for all."""

from dataclasses import replace

from parflex.base.array import Array
from parflex.compiled.backend import Function, Given, Trigger, Workspace
from parflex.kernels.kernel import Vectors


class At(Function):
    """A function at given values of some inputs, such as the parameters, called like one without them."""

    def __init__(self, function: Function, **given: Array) -> None:
        self.function, self.given, self.readable = function, given, function.readable
        left = {name: n for name, n in function.kernel.inputs.items() if name not in given}
        self.kernel = replace(function.kernel, inputs=left)

    def __call__(self, **inputs: Array) -> Vectors:
        return self.function(**inputs, **self.given)

    def run(self, **inputs: Array) -> Vectors:
        return self.function.run(**inputs, **self.given)

    def each(self, **inputs: Array) -> Vectors:
        return self.function.each(**inputs, **self.given)

    @property
    def workspace(self) -> Workspace:
        return self.function.workspace

    def bind(self, inputs: Given, outputs: Given) -> Trigger:
        return self.function.bind({**inputs, **self.given}, outputs)

    def _rows(self, rows: list[Array]) -> list[Array]:
        raise NotImplementedError("the function itself has the rows")
