"""A program as LLVM IR: straight-line code over one state, or over several per instruction, and loops.

Long graphs are cut into parts, functions that hand values on in memory, so that the time LLVM takes
grows with their length and not faster.
"""

from math import ceil
from typing import NamedTuple

import casadi
import numpy as np

from parflex.base.array import Array
from parflex.compiled.native.instructions import ARITY, INTRINSIC, Code, literal, suffix, vector_type
from parflex.compiled.native.loops import Loop, Program, Source

PART = 15_000  # operations of a function, at most


class Places(NamedTuple):
    """The places of a loop's arguments and results in the scratch, in values, and the number of rows that
    it treats at once."""

    arguments: int
    results: int
    lanes: int  # rows of the loop per instruction; 1 where the lanes are states
    padded: int  # rows, up to whole instructions


def module(program: Program, lanes: int, widest: int) -> str:
    """IR of `run(pointers, start, blocks)`.

    pointers holds the addresses of the graph's inputs (B, n_i), then of its outputs (B, m_i), rows
    contiguous; `blocks` times `lanes` rows are computed from row `start` on. Loops treat `widest` rows
    at once where a block is one state.
    """
    graph, size = program.graph, program.graph.sz_w()
    places: list[Places] = []
    for loop in program.loops:
        wide = min(widest, 1 << (loop.rows - 1).bit_length()) if lanes == 1 else 1
        padded = wide * ceil(loop.rows / wide)
        results = size + loop.own_shared + loop.own_columns * padded
        places.append(Places(size, results, wide, padded))
        size = results + loop.outputs * padded
    size += widest  # the last instruction of a loop may read beyond its rows
    count = graph.n_instructions()
    length = ceil(count / ceil(count / PART)) if count else 1
    last = last_uses(graph)
    literals: dict[int, str] = {}
    starts = range(0, count, length)
    parts = [
        Main(program, lanes, places, literals).text(number, first, min(first + length, count), last)
        for number, first in enumerate(starts)
    ]
    widths = {lanes, *(place.lanes for place in places)}
    declared = [
        f"declare {vector_type(n)} @llvm.{name}.{suffix(n)}({vector_type(n)})"
        for n in sorted(widths)
        for name in INTRINSIC.values()
    ]
    declared += [f"declare double @{name}({', '.join(['double'] * n)})" for name, n in ARITY.items()]
    loops = [Body(loop, number, places, lanes).text() for number, loop in enumerate(program.loops)]
    return "\n".join([*declared, *loops, *parts, driver(size * lanes, lanes, len(parts))])


def driver(scratch: int, lanes: int, parts: int) -> str:
    """The loop over the blocks, which calls part after part."""
    calls = [f"call void @part{i}(ptr %pointers, i64 %row, ptr %scratch)" for i in range(parts)]
    return "\n".join(
        [
            "define void @run(ptr %pointers, i64 %start, i64 %blocks) {",
            "entry:",
            f"%scratch = alloca double, i64 {max(scratch, 1)}, align 64",
            "br label %test",
            "test:",
            "%block = phi i64 [0, %entry], [%next, %body]",
            "%more = icmp slt i64 %block, %blocks",
            "br i1 %more, label %body, label %done",
            "body:",
            f"%offset = mul i64 %block, {lanes}",
            "%row = add i64 %start, %offset",
            *calls,
            "%next = add i64 %block, 1",
            "br label %test",
            "done:",
            "ret void",
            "}",
        ]
    )


def last_uses(graph: casadi.Function) -> dict[int, int]:
    """The last instruction that uses a value, for each instruction that defines one."""
    holder: dict[int, int] = {}  # by work slot, the instruction that filled it
    last: dict[int, int] = {}
    for k in range(graph.n_instructions()):
        op = graph.instruction_id(k)
        if op != casadi.OP_INPUT:
            for slot in graph.instruction_input(k):
                if slot in holder:
                    last[holder[slot]] = k
        if op != casadi.OP_OUTPUT:
            holder[graph.instruction_output(k)[0]] = k
    return last


class Main(Code):
    """One part of the main graph.

    What other parts computed is read from memory at first use; constants need no memory.
    """

    def __init__(self, program: Program, lanes: int, places: list[Places], literals: dict[int, str]) -> None:
        super().__init__(program.graph, lanes)
        self.loops, self.places, self.literals = program.loops, places, literals
        self.made: dict[int, int] = {}  # slots that this part filled, and the instruction
        self.first_result = self.graph.n_in() - len(self.loops)

    def text(self, number: int, first: int, end: int, last: dict[int, int]) -> str:
        """The function of instructions first … end − 1."""
        for k in range(first, end):
            self.step(k)
        for slot, k in self.made.items():
            if last.get(k, -1) >= end:
                self.stored(self.values[slot], self.home(slot))
        head = f"define internal void @part{number}(ptr %pointers, i64 %row, ptr %scratch) noinline {{"
        return "\n".join([head, *self.rows(), *self.lines, "ret void", "}"])

    def rows(self) -> list[str]:
        """The addresses at which the rows of inputs and outputs begin."""
        graph = self.graph
        sizes = [graph.numel_in(i) for i in range(self.first_result)]
        sizes += [graph.numel_out(i) for i in range(len(self.loops), graph.n_out())]
        lines = [f"%row{lane} = add i64 %row, {lane}" for lane in range(self.lanes)]
        for number, size in enumerate(sizes):
            lines.append(f"%a{number} = getelementptr ptr, ptr %pointers, i64 {number}")
            lines.append(f"%b{number} = load ptr, ptr %a{number}")
            for lane in range(self.lanes):
                place = f"ptr %b{number}, i64 %s{number}_{lane}"
                lines.append(f"%s{number}_{lane} = mul i64 %row{lane}, {size}")
                lines.append(f"%p{number}_{lane} = getelementptr double, {place}")
        return lines

    def read(self, array: int, entry: int) -> str:
        if array >= self.first_result:
            loop, place = (of[array - self.first_result] for of in (self.loops, self.places))
            column, row = divmod(entry, loop.rows)
            return self.loaded(self.at(place.results + column * place.padded + row))
        value = "poison"
        for lane in range(self.lanes):
            one = self.loaded(self.place(f"%p{array}_{lane}", entry), "double")
            value = self.inserted(value, one, lane)
        return value

    def write(self, array: int, entry: int, value: str) -> None:
        if array < len(self.loops):
            loop, place = self.loops[array], self.places[array]
            column, row = divmod(entry - loop.own_shared, loop.rows)
            where, copies = entry, 1
            if entry >= loop.own_shared:
                where = loop.own_shared + column * place.padded + row
                copies += place.padded - loop.rows if row == loop.rows - 1 else 0
            for copy in range(
                copies
            ):  # padding is the last row once more: what is there by chance may be slow
                self.stored(value, self.at(place.arguments + where + copy))
            if entry == self.graph.numel_out(array) - 1:
                self.lines.append(f"call void @loop{array}(ptr %scratch)")
            return
        number = array - len(self.loops) + self.first_result
        for lane in range(self.lanes):
            place_of = self.place(f"%p{number}_{lane}", entry)
            self.lines.append(f"store double {self.extracted(value, lane)}, ptr {place_of}, align 8")

    def value(self, slot: int) -> str:
        if slot in self.literals:
            return self.literals[slot]
        if slot not in self.values:
            self.values[slot] = self.loaded(self.home(slot))
        return self.values[slot]

    def fill(self, k: int, value: str) -> None:
        slot = self.graph.instruction_output(k)[0]
        self.literals.pop(slot, None)
        self.values[slot], self.made[slot] = value, k

    def constant(self, k: int) -> None:
        slot = self.graph.instruction_output(k)[0]
        self.made.pop(slot, None)
        self.values.pop(slot, None)
        self.literals[slot] = self.number(self.graph.instruction_constant(k))

    def home(self, slot: int) -> str:
        """The address of a slot in memory."""
        return self.at(slot)

    def at(self, position: int) -> str:
        """A place in the scratch."""
        return self.place("%scratch", position * self.lanes)


class Body(Code):
    """A loop as a function of the scratch memory."""

    def __init__(self, loop: Loop, number: int, places: list[Places], states: int) -> None:
        super().__init__(loop.graph, places[number].lanes if states == 1 else states)
        self.loop, self.number_of, self.places, self.states = loop, number, places, states
        self.where = places[number]

    def text(self) -> str:
        """The table of constants and the function."""
        for k in range(self.graph.n_instructions()):
            self.step(k)
        name, step = f"table{self.number_of}", self.where.lanes
        return "\n".join(
            [
                *self.constants(name),
                f"define internal void @loop{self.number_of}(ptr %scratch) noinline {{",
                "entry:",
                "br label %body",
                "body:",
                "%row = phi i64 [0, %entry], [%next, %body]",
                *self.lines,
                f"%next = add i64 %row, {step}",
                f"%more = icmp slt i64 %next, {self.loop.rows}",
                "br i1 %more, label %body, label %done",
                "done:",
                "ret void",
                "}",
            ]
        )

    def constants(self, name: str) -> list[str]:
        """The table, its columns up to whole instructions."""
        table = self.loop.table
        if not table.size:
            return []
        wide: Array = np.pad(table, ((0, 0), (0, self.where.padded - self.loop.rows)), "edge")
        words = ", ".join(f"double {literal(value)}" for value in wide.reshape(-1))
        return [f"@{name} = internal constant [{wide.size} x double] [{words}], align 64"]

    def read(self, array: int, entry: int) -> str:
        if array == 0:
            place = self.at(self.found(self.loop.shared[entry], 0, 1))
            return self.in_all_lanes(self.loaded(place, "double")) if self.states == 1 else self.loaded(place)
        if array == 1:
            own = self.loop.own_shared
            return self.loaded(self.at(self.found(self.loop.columns[entry], own, self.where.padded), True))
        start = self.place(f"@table{self.number_of}", entry * self.where.padded)
        place = self.place(start, "%row")
        return self.loaded(place) if self.states == 1 else self.in_all_lanes(self.loaded(place, "double"))

    def write(self, array: int, entry: int, value: str) -> None:
        self.stored(value, self.at(self.where.results + entry * self.where.padded, by_row=True))

    def found(self, source: Source, before: int, padded: int) -> int:
        """The address of an argument: among the loop's own, or in the output of another loop."""
        if source.loop is None:
            return self.where.arguments + before + source.entry * padded
        other = self.places[source.loop]
        return other.results + source.entry * other.padded + source.row

    def at(self, position: int, by_row: bool = False) -> str:
        """A place in the scratch, in the loop's present row or where all rows look."""
        start = self.place("%scratch", position * self.states)
        if not by_row:
            return start
        offset = "%row" if self.states == 1 else self.new(f"mul i64 %row, {self.states}")
        return self.place(start, offset)
