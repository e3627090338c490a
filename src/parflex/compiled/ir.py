"""A CasADi graph as LLVM IR: straight-line code over one state, or over several per instruction.

Long graphs are cut into parts, functions that hand values on in memory, so that the time LLVM takes
grows with their length and not faster.
"""

from math import ceil

import casadi
import numpy as np

PART = 10_000  # operations of a function, at most
ARITHMETIC = {
    casadi.OP_ADD: "fadd",
    casadi.OP_SUB: "fsub",
    casadi.OP_MUL: "fmul",
    casadi.OP_DIV: "fdiv",
}
OF_ITSELF = {casadi.OP_SQ: "fmul", casadi.OP_TWICE: "fadd"}  # x x, x + x
LIBRARY = {casadi.OP_SIN: "sin", casadi.OP_COS: "cos", casadi.OP_ATAN2: "atan2"}
ARITY = {"sin": 1, "cos": 1, "atan2": 2}
CONTRACT = "contract"  # a multiplication and an addition may become one instruction


def module(graph: casadi.Function, lanes: int) -> str:
    """IR of `run(pointers, start, blocks)`.

    pointers holds the addresses of the graph's inputs (B, n_i), then of its outputs (B, m_i), rows
    contiguous; `blocks` times `lanes` rows are computed from row `start` on.
    """
    count = graph.n_instructions()
    size = ceil(count / ceil(count / PART)) if count else 1
    last = last_uses(graph)
    literals: dict[int, str] = {}
    parts = [
        Part(graph, lanes, literals).text(number, first, min(first + size, count), last)
        for number, first in enumerate(range(0, count, size))
    ]
    vector = vector_type(lanes)
    declared = [f"declare {vector} @llvm.sqrt.{suffix(lanes)}({vector})"]
    declared += [f"declare double @{name}({', '.join(['double'] * n)})" for name, n in ARITY.items()]
    return "\n".join([*declared, *parts, driver(graph.sz_w() * lanes, lanes, len(parts))])


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
    """For each instruction that defines a value, the last one that uses it."""
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


class Part:
    """The lines of one function; `values` maps the graph's work slots to IR values.

    What other parts computed is read from memory at first use; constants need no memory.
    """

    def __init__(self, graph: casadi.Function, lanes: int, literals: dict[int, str]) -> None:
        self.graph, self.lanes, self.literals = graph, lanes, literals
        self.type = vector_type(lanes)
        self.lines: list[str] = []
        self.values: dict[int, str] = {}
        self.made: dict[int, int] = {}  # slots that this part filled, and the instruction
        self.count = 0

    def text(self, number: int, first: int, end: int, last: dict[int, int]) -> str:
        """The function of instructions first … end − 1."""
        write = {casadi.OP_INPUT: self.load, casadi.OP_OUTPUT: self.store, casadi.OP_CONST: self.constant}
        for k in range(first, end):
            write.get(self.graph.instruction_id(k), self.compute)(k)
        for slot, k in self.made.items():
            if last.get(k, -1) >= end:
                self.keep(slot)
        head = f"define internal void @part{number}(ptr %pointers, i64 %row, ptr %scratch) noinline {{"
        return "\n".join([head, *self.places(), *self.lines, "ret void", "}"])

    def places(self) -> list[str]:
        """Where the rows of inputs and outputs begin."""
        graph, lines = self.graph, []
        sizes = [graph.numel_in(i) for i in range(graph.n_in())]
        sizes += [graph.numel_out(i) for i in range(graph.n_out())]
        lines += [f"%row{lane} = add i64 %row, {lane}" for lane in range(self.lanes)]
        for number, size in enumerate(sizes):
            lines.append(f"%a{number} = getelementptr ptr, ptr %pointers, i64 {number}")
            lines.append(f"%b{number} = load ptr, ptr %a{number}")
            for lane in range(self.lanes):
                place = f"ptr %b{number}, i64 %s{number}_{lane}"
                lines.append(f"%s{number}_{lane} = mul i64 %row{lane}, {size}")
                lines.append(f"%p{number}_{lane} = getelementptr double, {place}")
        return lines

    def new(self, line: str) -> str:
        """A fresh name for the value of a line."""
        self.count += 1
        self.lines.append(f"%v{self.count} = {line}")
        return f"%v{self.count}"

    def value(self, slot: int) -> str:
        """What the slot holds."""
        if slot in self.literals:
            return self.literals[slot]
        if slot not in self.values:
            self.values[slot] = self.new(f"load {self.type}, ptr {self.home(slot)}, align 8")
        return self.values[slot]

    def fill(self, k: int, value: str) -> None:
        """Note the value that an instruction gives its slot."""
        slot = self.graph.instruction_output(k)[0]
        self.literals.pop(slot, None)
        self.values[slot], self.made[slot] = value, k

    def keep(self, slot: int) -> None:
        """Hand a slot on to later parts."""
        self.lines.append(f"store {self.type} {self.values[slot]}, ptr {self.home(slot)}, align 8")

    def home(self, slot: int) -> str:
        """Where a slot lies in memory."""
        return self.new(f"getelementptr double, ptr %scratch, i64 {slot * self.lanes}")

    def load(self, k: int) -> None:
        """One entry of an input, of all rows of the block."""
        array, entry = self.graph.instruction_input(k)
        value = "poison"
        for lane in range(self.lanes):
            place = self.new(f"getelementptr double, ptr %p{array}_{lane}, i64 {entry}")
            value = self.inserted(value, self.new(f"load double, ptr {place}, align 8"), lane)
        self.fill(k, value)

    def store(self, k: int) -> None:
        """One entry of an output."""
        array, entry = self.graph.instruction_output(k)
        value = self.value(self.graph.instruction_input(k)[0])
        for lane in range(self.lanes):
            one = self.extracted(value, lane)
            start = f"%p{array + self.graph.n_in()}_{lane}"
            place = self.new(f"getelementptr double, ptr {start}, i64 {entry}")
            self.lines.append(f"store double {one}, ptr {place}, align 8")

    def constant(self, k: int) -> None:
        """A number, exactly."""
        slot = self.graph.instruction_output(k)[0]
        self.made.pop(slot, None)
        self.values.pop(slot, None)
        self.literals[slot] = self.number(self.graph.instruction_constant(k))

    def compute(self, k: int) -> None:
        """One operation."""
        op, kind = self.graph.instruction_id(k), self.type
        given = [self.value(slot) for slot in self.graph.instruction_input(k)]
        if op in ARITHMETIC:
            value = self.new(f"{ARITHMETIC[op]} {CONTRACT} {kind} {given[0]}, {given[1]}")
        elif op in OF_ITSELF:
            value = self.new(f"{OF_ITSELF[op]} {CONTRACT} {kind} {given[0]}, {given[0]}")
        elif op == casadi.OP_INV:
            value = self.new(f"fdiv {CONTRACT} {kind} {self.number(1.0)}, {given[0]}")
        elif op == casadi.OP_NEG:
            value = self.new(f"fneg {kind} {given[0]}")
        elif op == casadi.OP_SQRT:
            value = self.new(f"call {kind} @llvm.sqrt.{suffix(self.lanes)}({kind} {given[0]})")
        elif op in LIBRARY:
            value = self.called(LIBRARY[op], given)
        else:
            raise NotImplementedError(f"operation {op} of CasADi has no translation")
        self.fill(k, value)

    def called(self, function: str, given: list[str]) -> str:
        """A function of the C library, lane by lane."""
        value = "poison"
        for lane in range(self.lanes):
            arguments = ", ".join(f"double {self.extracted(v, lane)}" for v in given)
            value = self.inserted(value, self.new(f"call double @{function}({arguments})"), lane)
        return value

    def inserted(self, vector: str, value: str, lane: int) -> str:
        """The vector with one lane set."""
        if self.lanes == 1:
            return value
        return self.new(f"insertelement {self.type} {vector}, double {value}, i32 {lane}")

    def extracted(self, vector: str, lane: int) -> str:
        """One lane of a vector."""
        return vector if self.lanes == 1 else self.new(f"extractelement {self.type} {vector}, i32 {lane}")

    def number(self, value: float) -> str:
        """A constant, to the bit."""
        word = f"0x{np.float64(value).view(np.uint64):016X}"
        return word if self.lanes == 1 else "<" + ", ".join([f"double {word}"] * self.lanes) + ">"


def vector_type(lanes: int) -> str:
    """The type of a value."""
    return "double" if lanes == 1 else f"<{lanes} x double>"


def suffix(lanes: int) -> str:
    """Of intrinsic functions on values."""
    return "f64" if lanes == 1 else f"v{lanes}f64"
