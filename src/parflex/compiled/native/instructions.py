"""The instructions of a graph as lines of LLVM IR, one value or several lanes at a time."""

import casadi
import numpy as np

ARITHMETIC = {
    casadi.OP_ADD: "fadd",
    casadi.OP_SUB: "fsub",
    casadi.OP_MUL: "fmul",
    casadi.OP_DIV: "fdiv",
}
OF_ITSELF = {casadi.OP_SQ: "fmul", casadi.OP_TWICE: "fadd"}  # x x, x + x
INTRINSIC = {casadi.OP_SQRT: "sqrt", casadi.OP_FABS: "fabs"}  # CasADi takes the root of a square for |x|
LIBRARY = {casadi.OP_SIN: "sin", casadi.OP_COS: "cos", casadi.OP_ATAN2: "atan2"}
ARITY = {"sin": 1, "cos": 1, "atan2": 2}
CONTRACT = "contract"  # a multiplication and an addition may become one instruction


class Code:
    """Lines for instructions of a graph; `values` maps the graph's work slots to IR values.

    A subclass says how inputs are read and outputs written.
    """

    def __init__(self, graph: casadi.Function, lanes: int) -> None:
        self.graph, self.lanes = graph, lanes
        self.type = vector_type(lanes)
        self.lines: list[str] = []
        self.values: dict[int, str] = {}
        self.count = 0

    def read(self, array: int, entry: int) -> str:
        """The value of an entry of an input."""
        raise NotImplementedError

    def write(self, array: int, entry: int, value: str) -> None:
        """Store an entry of an output."""
        raise NotImplementedError

    def step(self, k: int) -> None:
        """The lines of one instruction."""
        op, graph = self.graph.instruction_id(k), self.graph
        if op == casadi.OP_OUTPUT:
            array, entry = graph.instruction_output(k)
            self.write(array, entry, self.value(graph.instruction_input(k)[0]))
        elif op == casadi.OP_INPUT:
            array, entry = graph.instruction_input(k)
            self.fill(k, self.read(array, entry))
        elif op == casadi.OP_CONST:
            self.constant(k)
        else:
            self.fill(k, self.computed(op, [self.value(slot) for slot in graph.instruction_input(k)]))

    def value(self, slot: int) -> str:
        """The value that the slot holds."""
        return self.values[slot]

    def fill(self, k: int, value: str) -> None:
        """Note the value that an instruction gives its slot."""
        self.values[self.graph.instruction_output(k)[0]] = value

    def constant(self, k: int) -> None:
        """A number, exactly."""
        self.fill(k, self.number(self.graph.instruction_constant(k)))

    def computed(self, op: int, given: list[str]) -> str:
        """One operation."""
        kind = self.type
        if op in ARITHMETIC:
            return self.new(f"{ARITHMETIC[op]} {CONTRACT} {kind} {given[0]}, {given[1]}")
        if op in OF_ITSELF:
            return self.new(f"{OF_ITSELF[op]} {CONTRACT} {kind} {given[0]}, {given[0]}")
        if op == casadi.OP_INV:
            return self.new(f"fdiv {CONTRACT} {kind} {self.number(1.0)}, {given[0]}")
        if op == casadi.OP_NEG:
            return self.new(f"fneg {kind} {given[0]}")
        if op in INTRINSIC:
            return self.new(f"call {kind} @llvm.{INTRINSIC[op]}.{suffix(self.lanes)}({kind} {given[0]})")
        if op in LIBRARY:
            return self.called(LIBRARY[op], given)
        raise NotImplementedError(f"operation {op} of CasADi has no translation")

    def called(self, function: str, given: list[str]) -> str:
        """A function of the C library, lane by lane."""
        value = "poison"
        for lane in range(self.lanes):
            arguments = ", ".join(f"double {self.extracted(v, lane)}" for v in given)
            value = self.inserted(value, self.new(f"call double @{function}({arguments})"), lane)
        return value

    def new(self, line: str) -> str:
        """A fresh name for the value of a line."""
        self.count += 1
        self.lines.append(f"%v{self.count} = {line}")
        return f"%v{self.count}"

    def place(self, base: str, offset: int | str) -> str:
        """An address, so many doubles from another."""
        return self.new(f"getelementptr double, ptr {base}, i64 {offset}")

    def loaded(self, place: str, kind: str = "") -> str:
        """The value that lies at an address."""
        return self.new(f"load {kind or self.type}, ptr {place}, align 8")

    def stored(self, value: str, place: str) -> None:
        """Put a value at an address."""
        self.lines.append(f"store {self.type} {value}, ptr {place}, align 8")

    def inserted(self, vector: str, value: str, lane: int) -> str:
        """The vector with one lane set."""
        if self.lanes == 1:
            return value
        return self.new(f"insertelement {self.type} {vector}, double {value}, i32 {lane}")

    def extracted(self, vector: str, lane: int) -> str:
        """One lane of a vector."""
        return vector if self.lanes == 1 else self.new(f"extractelement {self.type} {vector}, i32 {lane}")

    def in_all_lanes(self, value: str) -> str:
        """A vector of one number."""
        if self.lanes == 1:
            return value
        first = self.inserted("poison", value, 0)
        zeros = f"<{self.lanes} x i32> zeroinitializer"
        return self.new(f"shufflevector {self.type} {first}, {self.type} poison, {zeros}")

    def number(self, value: float) -> str:
        """A constant, to the bit."""
        word = literal(value)
        return word if self.lanes == 1 else "<" + ", ".join([f"double {word}"] * self.lanes) + ">"


def literal(value: float) -> str:
    """A number, to the bit."""
    return f"0x{np.float64(value).view(np.uint64):016X}"


def vector_type(lanes: int) -> str:
    """The type of a value."""
    return "double" if lanes == 1 else f"<{lanes} x double>"


def suffix(lanes: int) -> str:
    """The ending of the names of intrinsic functions on values."""
    return "f64" if lanes == 1 else f"v{lanes}f64"
