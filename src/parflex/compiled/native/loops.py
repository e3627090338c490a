"""Kernels traced with their loops: what is done alike for many rows is traced once, for one of them.

The main graph stores the arguments of a loop as one of its outputs, and reads the results as one of its
inputs; machine code runs the loop between the two, several rows per instruction. What is a result of an
earlier loop is read where that has left it.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import casadi
import numpy as np

from parflex.base.array import Array
from parflex.base.unroll import looping
from parflex.compiled.native.recorder import Recorded, Recorder, column_of, free, names, operations
from parflex.compiled.symbol import Symbol, vector
from parflex.compiled.vm import traced
from parflex.kernels.kernel import Kernel


class Source(NamedTuple):
    """The place at which a loop finds an argument: among its own, which the main graph stores, or, `row`
    rows down, in an output of an earlier loop."""

    loop: int | None
    entry: int
    row: int = 0


class Loop(NamedTuple):
    """One row's graph (shared, columns, table) -> outputs, and how often it runs.

    Its own arguments are shared values, then column by column what differs by row.
    """

    graph: casadi.Function
    rows: int
    shared: list[Source]
    columns: list[Source]
    table: Array  # (c, rows), constants that differ by row
    outputs: int

    @property
    def own_shared(self) -> int:
        """The number of the loop's own arguments that all rows share."""
        return sum(source.loop is None for source in self.shared)

    @property
    def own_columns(self) -> int:
        """The number of the loop's own arguments that are columns."""
        return sum(source.loop is None for source in self.columns)


class Program(NamedTuple):
    """A main graph, whose inputs end with the loops' results and whose outputs begin with their
    arguments, and the loops in the order in which they run."""

    graph: casadi.Function
    loops: list[Loop]

    @property
    def operations(self) -> int:
        """Scalar operations of a run."""
        return operations(self.graph) + sum(loop.rows * operations(loop.graph) for loop in self.loops)


def program(kernel: Kernel, lanes: int = 1) -> Program:
    """A kernel traced, its loops apart; `lanes` rows of a loop share an instruction."""
    recorder = Recorder(lanes)
    token = looping.set(recorder)
    try:
        inputs, outputs = traced(kernel)
    finally:
        looping.reset(token)
    alive = in_use(recorder.loops, outputs)
    loops, arguments = linked(alive)
    results = [column_of([x for column in loop.results for x in column]) for loop in alive]
    graph = casadi.Function(kernel.name, inputs + results, arguments + outputs, {"cse": True})
    return Program(graph, loops)


def in_use(recorded: list[Recorded], outputs: list[casadi.SX]) -> list[Recorded]:
    """The loops whose results somebody reads, without those that nobody does."""
    live = free(outputs)
    for loop in reversed(recorded):
        loop.prune(live)
        live |= free([vector(np.array([*loop.known.values, *(v for c in loop.one.values for v in c)]))])
    return [loop for loop in recorded if loop.outputs]


def linked(recorded: list[Recorded]) -> tuple[list[Loop], list[casadi.SX]]:
    """The loops, knowing where they find what they read, and what the main graph stores for them."""
    made = {
        name: Source(number, entry, row)
        for number, loop in enumerate(recorded)
        for entry, column in enumerate(loop.results)
        for row, name in enumerate(names(column))
    }
    loops, arguments = [], []
    for loop in recorded:
        single: list[Any] = []
        wide: list[Any] = []
        shared = [place_of(made, [value]) or one_more(single, value) for value in loop.known.values]
        columns = [place_of(made, column) or one_more(wide, column) for column in loop.one.values]
        table = np.array(loop.constants.values).reshape(-1, loop.rows)
        loops.append(Loop(loop.graph, loop.rows, shared, columns, table, len(loop.outputs)))
        own = single + [value for column in wide for value in column]
        arguments.append(vector(np.array(own or [0.0], dtype=object)))
    return loops, arguments


def place_of(made: dict[int, Source], column: Sequence[Any]) -> Source | None:
    """The place of values that lie below one another in the output of a loop; None where they do not."""
    places = [made.get(value.x.element_hash()) if isinstance(value, Symbol) else None for value in column]
    first = places[0]
    if first is None or any(place != first._replace(row=first.row + i) for i, place in enumerate(places)):
        return None
    return first


def one_more(own: list[Any], value: Any) -> Source:
    """The place of one more argument of a loop's own."""
    own.append(value)
    return Source(None, len(own) - 1)
