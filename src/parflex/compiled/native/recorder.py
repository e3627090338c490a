"""Loops as they are met while a kernel is traced: one row's expressions, and what they stand for."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import casadi
import numpy as np

from parflex.base.array import Array
from parflex.base.unroll import leaves, looping, regrown
from parflex.compiled.symbol import Symbol

WORTH = 8000  # operations from which on a loop is shorter than what it does
QUICKER = 60  # from which on several rows of it per instruction are quicker


class Recorder:
    """Turns `unroll.each` into loops."""

    def __init__(self, lanes: int) -> None:
        self.loops: list[Recorded] = []
        self.lanes = lanes

    def __call__(self, function: Callable[..., Any], rows: Sequence[Array], shared: Sequence[Array]) -> Any:
        """The results (1, …, R, *shape) of a function of rows (1, …, R, n_i) and of what they share."""
        alone = looping.set(None)  # a loop has no loops within
        try:
            return self._recorded(function, rows, shared)
        finally:
            looping.reset(alone)

    def _recorded(self, function: Callable[..., Any], rows: Sequence[Array], shared: Sequence[Array]) -> Any:
        """The results, by a loop where it is worth one."""
        count = rows[0].shape[-2]
        known, one, constants = Inputs(), Inputs(), Inputs()
        given = [common(known, array) for array in shared]
        singles = []
        for array in rows:
            single = np.empty((1,) * (array.ndim - 1) + array.shape[-1:], dtype=object)
            for j, column in enumerate(array.reshape(count, array.shape[-1]).T):
                single[..., j] = stand_in(column, one, constants)
            singles.append(single)
        tree = function(*singles, *given)
        outputs = [value.x for leaf in leaves(tree) for value in leaf.flat if isinstance(value, Symbol)]
        loop = Recorded(count, known, one, constants, outputs, [])
        if operations(loop.graph) * count < (WORTH if self.lanes == 1 else QUICKER):
            return function(*rows, *shared)
        self.loops.append(loop)
        place = max(1, *(array.ndim - 2 for array in rows))  # constants may lack the axis of the one state
        return regrown(tree, (self._spread(loop, leaf, place) for leaf in leaves(tree)))

    @staticmethod
    def _spread(loop: "Recorded", leaf: Array, place: int) -> Array:
        """Symbols (1, …, R, *shape) of the loop's results that stand for a leaf (1, …, 1, *shape) of one row;
        the place is that of R."""
        out = np.empty((loop.rows, leaf.size), dtype=object)
        for j, value in enumerate(leaf.flat):
            out[:, j] = value
            if isinstance(value, Symbol):
                column = casadi.SX.sym("r", loop.rows).elements()
                loop.results.append(column)
                out[:, j] = [Symbol(x) for x in column]
        return out.reshape((*leaf.shape[:place], loop.rows, *leaf.shape[place + 1 :]))


class Inputs:
    """Symbols, and the values of the main graph or columns of values that they stand for."""

    def __init__(self) -> None:
        self.values: list[Any] = []
        self.symbols: list[casadi.SX] = []

    def new(self, value: Any) -> Symbol:
        """A symbol for one more."""
        self.values.append(value)
        self.symbols.append(casadi.SX.sym("v"))
        return Symbol(self.symbols[-1])

    def keep(self, used: set[int]) -> None:
        """Drop the values that nobody uses."""
        stay = [i for i, name in enumerate(names(self.symbols)) if name in used]
        self.values, self.symbols = [self.values[i] for i in stay], [self.symbols[i] for i in stay]


@dataclass
class Recorded:
    """A loop: its expressions, their inputs, and the symbols that stand for its results."""

    rows: int
    known: Inputs  # shared values
    one: Inputs  # columns of values
    constants: Inputs  # columns of numbers
    outputs: list[casadi.SX]
    results: list[list[casadi.SX]]  # of each output, row by row

    @property
    def graph(self) -> casadi.Function:
        """The function of shared values, columns and numbers that gives the outputs."""
        inputs = [column_of(given.symbols) for given in (self.known, self.one, self.constants)]
        return casadi.Function("row", inputs, [column_of(self.outputs)], {"cse": True})

    def prune(self, live: set[int]) -> None:
        """Keep what is used of the outputs, and what they need of the inputs."""
        stay = [k for k, column in enumerate(self.results) if not live.isdisjoint(names(column))]
        self.outputs, self.results = [self.outputs[k] for k in stay], [self.results[k] for k in stay]
        used = free(self.outputs)
        for given in (self.known, self.one, self.constants):
            given.keep(used)


def stand_in(column: Array, one: Inputs, constants: Inputs) -> Any:
    """The value that stands for a column in a single row: a number that all rows share, or a symbol."""
    if any(isinstance(value, Symbol) for value in column):
        return one.new(column)
    if all(value == column[0] for value in column):
        return float(column[0])
    return constants.new(column.astype(float))


def common(known: Inputs, array: Array) -> Array:
    """The array with symbols of its own, each value once; constants stay."""
    if array.dtype != object:
        return array
    seen: dict[int, Symbol] = {}
    out = np.empty(array.shape, dtype=object)
    for place, value in np.ndenumerate(array):
        if isinstance(value, Symbol):
            name = value.x.element_hash()
            if name not in seen:
                seen[name] = known.new(value)
            value = seen[name]
        out[place] = value
    return out


def free(expressions: Sequence[casadi.SX]) -> set[int]:
    """The symbols in them, by name."""
    return set(names(casadi.symvar(column_of(expressions))))


def names(symbols: Iterable[casadi.SX]) -> list[int]:
    """The numbers by which symbols are told apart."""
    return [symbol.element_hash() for symbol in symbols]


def column_of(expressions: Sequence[casadi.SX]) -> casadi.SX:
    """One below the other."""
    return casadi.vertcat(*expressions) if expressions else casadi.SX(0, 1)


def operations(graph: casadi.Function) -> int:
    """Instructions that compute."""
    moves = (casadi.OP_INPUT, casadi.OP_OUTPUT, casadi.OP_CONST)
    return sum(graph.instruction_id(k) not in moves for k in range(graph.n_instructions()))
