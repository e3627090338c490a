"""Kernels traced with their loops: what is done alike for many rows is traced once, for one of them.

The main graph stores the arguments of a loop as one of its outputs, and reads the results as one of its
inputs; machine code runs the loop between the two, several rows per instruction.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import casadi
import numpy as np

from parflex.array import Array, looping
from parflex.compiled.kernels import Kernel
from parflex.compiled.symbol import Symbol, symbols, vector
from parflex.compiled.vm import traced

WORTH = 1000  # operations from which on a loop is shorter than what it does


class Loop(NamedTuple):
    """One row's graph (shared, columns, table) -> outputs, and how often it runs.

    Its arguments are the shared values, then column by column what differs by row.
    """

    graph: casadi.Function
    rows: int
    shared: int
    columns: int
    table: Array  # (c, rows), constants that differ by row
    outputs: int


class Program(NamedTuple):
    """A main graph, whose inputs end with the loops' results and whose outputs begin with their
    arguments, and the loops in the order in which they run."""

    graph: casadi.Function
    loops: list[Loop]

    @property
    def operations(self) -> int:
        """Scalar operations of a run."""
        return operations(self.graph) + sum(loop.rows * operations(loop.graph) for loop in self.loops)


def program(kernel: Kernel) -> Program:
    """A kernel traced, its loops apart."""
    recorder = Recorder()
    token = looping.set(recorder)
    try:
        inputs, outputs = traced(kernel)
    finally:
        looping.reset(token)
    given, found = inputs + recorder.results, recorder.arguments + outputs
    return Program(casadi.Function(kernel.name, given, found, {"cse": True}), recorder.loops)


class Recorder:
    """Turns `array.for_each` into loops."""

    def __init__(self) -> None:
        self.loops: list[Loop] = []
        self.arguments: list[casadi.SX] = []
        self.results: list[casadi.SX] = []

    def __call__(
        self, function: Callable[..., Array], rows: Sequence[Array], shared: Sequence[Array]
    ) -> Array:
        """The results (1, R, m) of a function of rows (1, R, n_i) and of what they share."""
        count = rows[0].shape[-2]
        one, known, columns, table = Inputs(), Inputs(), [], []
        given = [common(known, array) for array in shared]
        singles = []
        for array in rows:
            flat = array.reshape(count, array.shape[-1])
            single = np.empty((1,) * (array.ndim - 1) + flat.shape[-1:], dtype=object)
            line = single.reshape(-1)
            for j, column in enumerate(flat.T):
                if not any(isinstance(value, Symbol) for value in column):
                    if all(value == column[0] for value in column):
                        line[j] = float(column[0])
                        continue
                    table.append(column.astype(float))
                    line[j] = None
                else:
                    line[j] = one.new(column)
                    columns.append(column)
            singles.append(single)
        constants = casadi.SX.sym("t", len(table))
        place = iter(range(len(table)))
        for single in singles:
            for where, value in np.ndenumerate(single):
                if value is None:
                    single[where] = Symbol(constants[next(place)])
        found = function(*singles, *given)
        entries = [v for v in found.reshape(-1) if isinstance(v, Symbol)]
        graph = casadi.Function(
            "row",
            [known.vector("s"), one.vector("c"), constants],
            [vector(np.array(entries, dtype=object))],
            {"cse": True},
        )
        if operations(graph) * count < WORTH:
            return function(*rows, *shared)
        self.arguments.append(
            vector(np.array([*known.values, *(v for c in columns for v in c)], dtype=object))
        )
        results, values = symbols(f"r{len(self.loops)}", len(entries) * count)
        self.results.append(results)
        held = np.array(table).reshape(len(table), count)
        self.loops.append(Loop(graph, count, len(known.values), len(columns), held, len(entries)))
        out = np.empty((1, count, found.shape[-1]), dtype=object)
        number = 0
        for j, value in enumerate(found.reshape(-1)):
            if isinstance(value, Symbol):
                out[0, :, j] = values[number * count : (number + 1) * count]
                number += 1
            else:
                out[0, :, j] = value
        return out


class Inputs:
    """Symbols that stand for values of the main graph."""

    def __init__(self) -> None:
        self.values: list[Any] = []
        self.symbols: list[casadi.SX] = []

    def new(self, value: Any) -> Symbol:
        """A symbol for one more value."""
        self.values.append(value)
        self.symbols.append(casadi.SX.sym("v"))
        return Symbol(self.symbols[-1])

    def vector(self, name: str) -> casadi.SX:
        """All symbols as one input."""
        return casadi.vertcat(*self.symbols) if self.symbols else casadi.SX.sym(name, 0)


def common(known: Inputs, array: Array) -> Array:
    """The array with symbols of its own, each value once; constants stay."""
    if array.dtype != object:
        return array
    seen: dict[int, Symbol] = {}
    out = np.empty(array.shape, dtype=object)
    for place, value in np.ndenumerate(array):
        if isinstance(value, Symbol):
            if id(value) not in seen:
                seen[id(value)] = known.new(value)
            value = seen[id(value)]
        out[place] = value
    return out


def operations(graph: casadi.Function) -> int:
    """Instructions that compute."""
    moves = (casadi.OP_INPUT, casadi.OP_OUTPUT, casadi.OP_CONST)
    return sum(graph.instruction_id(k) not in moves for k in range(graph.n_instructions()))
