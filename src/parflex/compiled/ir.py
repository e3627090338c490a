"""A CasADi graph as LLVM IR: straight-line code over one state, or over several per instruction."""

import casadi
import numpy as np

ARITHMETIC = {
    casadi.OP_ADD: "fadd",
    casadi.OP_SUB: "fsub",
    casadi.OP_MUL: "fmul",
    casadi.OP_DIV: "fdiv",
}
TWICE_THE_OPERAND = {casadi.OP_SQ: "fmul", casadi.OP_TWICE: "fadd"}
LIBRARY = {casadi.OP_SIN: "sin", casadi.OP_COS: "cos", casadi.OP_ATAN2: "atan2"}
CONTRACT = "contract"  # a multiplication and an addition may become one instruction


def module(graph: casadi.Function, lanes: int) -> str:
    """IR of `run(pointers, start, blocks)`.

    pointers holds the addresses of the graph's inputs (B, n_i), then of its outputs (B, m_i), rows
    contiguous; `blocks` times `lanes` rows are computed from row `start` on.
    """
    return Writer(graph, lanes).text()


class Writer:
    """The lines of one function; `values` maps the graph's work slots to IR values."""

    def __init__(self, graph: casadi.Function, lanes: int) -> None:
        self.graph, self.lanes = graph, lanes
        self.type = "double" if lanes == 1 else f"<{lanes} x double>"
        self.lines: list[str] = []
        self.values: dict[int, str] = {}
        self.count = 0
        self.library: set[str] = set()

    def text(self) -> str:
        """The module."""
        write = {casadi.OP_INPUT: self.load, casadi.OP_OUTPUT: self.store, casadi.OP_CONST: self.constant}
        for k in range(self.graph.n_instructions()):
            write.get(self.graph.instruction_id(k), self.compute)(k)
        sizes = [self.graph.numel_in(i) for i in range(self.graph.n_in())]
        sizes += [self.graph.numel_out(i) for i in range(self.graph.n_out())]
        heads, rows = [], []
        for number, size in enumerate(sizes):
            heads.append(f"%a{number} = getelementptr ptr, ptr %pointers, i64 {number}")
            heads.append(f"%b{number} = load ptr, ptr %a{number}")
            for lane in range(self.lanes):
                rows.append(f"%s{number}_{lane} = mul i64 %row{lane}, {size}")
                rows.append(
                    f"%p{number}_{lane} = getelementptr double, ptr %b{number}, i64 %s{number}_{lane}"
                )
        steps = [f"%row{lane} = add i64 %row, {lane}" for lane in range(self.lanes)]
        root = f"declare {self.type} @llvm.sqrt.{self.suffix}({self.type})"
        declared = [f"declare double @{name}({', '.join(['double'] * n)})" for name, n in ARITY.items()]
        return "\n".join(
            [
                root,
                *(line for line, name in zip(declared, ARITY, strict=True) if name in self.library),
                "define void @run(ptr noalias %pointers, i64 %start, i64 %blocks) {",
                "entry:",
                *heads,
                "br label %test",
                "test:",
                "%block = phi i64 [0, %entry], [%next, %body]",
                "%more = icmp slt i64 %block, %blocks",
                "br i1 %more, label %body, label %done",
                "body:",
                f"%offset = mul i64 %block, {self.lanes}",
                "%row = add i64 %start, %offset",
                *steps,
                *rows,
                *self.lines,
                "%next = add i64 %block, 1",
                "br label %test",
                "done:",
                "ret void",
                "}",
            ]
        )

    @property
    def suffix(self) -> str:
        """Of intrinsic functions."""
        return "f64" if self.lanes == 1 else f"v{self.lanes}f64"

    def new(self) -> str:
        """A fresh name."""
        self.count += 1
        return f"%v{self.count}"

    def load(self, k: int) -> None:
        """One entry of an input, of all rows of the block."""
        array, entry = self.graph.instruction_input(k)
        value = "poison"
        for lane in range(self.lanes):
            name = self.new()
            self.lines.append(f"{name}p = getelementptr double, ptr %p{array}_{lane}, i64 {entry}")
            self.lines.append(f"{name} = load double, ptr {name}p, align 8")
            value = name if self.lanes == 1 else self.inserted(value, name, lane)
        self.values[self.graph.instruction_output(k)[0]] = value

    def store(self, k: int) -> None:
        """One entry of an output."""
        array, entry = self.graph.instruction_output(k)
        value = self.values[self.graph.instruction_input(k)[0]]
        for lane in range(self.lanes):
            one = value if self.lanes == 1 else self.extracted(value, lane)
            name = self.new()
            place = f"%p{array + self.graph.n_in()}_{lane}"
            self.lines.append(f"{name} = getelementptr double, ptr {place}, i64 {entry}")
            self.lines.append(f"store double {one}, ptr {name}, align 8")

    def constant(self, k: int) -> None:
        """A number, exactly."""
        self.values[self.graph.instruction_output(k)[0]] = self.number(self.graph.instruction_constant(k))

    def compute(self, k: int) -> None:
        """One operation."""
        op = self.graph.instruction_id(k)
        given = [self.values[slot] for slot in self.graph.instruction_input(k)]
        name = self.new()
        if op in ARITHMETIC:
            line = f"{ARITHMETIC[op]} {CONTRACT} {self.type} {given[0]}, {given[1]}"
        elif op in TWICE_THE_OPERAND:
            line = f"{TWICE_THE_OPERAND[op]} {CONTRACT} {self.type} {given[0]}, {given[0]}"
        elif op == casadi.OP_INV:
            line = f"fdiv {CONTRACT} {self.type} {self.number(1.0)}, {given[0]}"
        elif op == casadi.OP_NEG:
            line = f"fneg {self.type} {given[0]}"
        elif op == casadi.OP_SQRT:
            line = f"call {self.type} @llvm.sqrt.{self.suffix}({self.type} {given[0]})"
        elif op in LIBRARY:
            self.values[self.graph.instruction_output(k)[0]] = self.called(LIBRARY[op], given)
            return
        else:
            raise NotImplementedError(f"operation {op} of CasADi has no translation")
        self.lines.append(f"{name} = {line}")
        self.values[self.graph.instruction_output(k)[0]] = name

    def called(self, function: str, given: list[str]) -> str:
        """A function of the C library, lane by lane."""
        self.library.add(function)
        value = "poison"
        for lane in range(self.lanes):
            ones = given if self.lanes == 1 else [self.extracted(v, lane) for v in given]
            name = self.new()
            arguments = ", ".join(f"double {one}" for one in ones)
            self.lines.append(f"{name} = call double @{function}({arguments})")
            value = name if self.lanes == 1 else self.inserted(value, name, lane)
        return value

    def inserted(self, vector: str, value: str, lane: int) -> str:
        """The vector with one lane set."""
        name = self.new()
        self.lines.append(f"{name} = insertelement {self.type} {vector}, double {value}, i32 {lane}")
        return name

    def extracted(self, vector: str, lane: int) -> str:
        """One lane of a vector."""
        name = self.new()
        self.lines.append(f"{name} = extractelement {self.type} {vector}, i32 {lane}")
        return name

    def number(self, value: float) -> str:
        """A constant, to the bit."""
        word = f"0x{np.float64(value).view(np.uint64):016X}"
        if self.lanes == 1:
            return word
        return "<" + ", ".join([f"double {word}"] * self.lanes) + ">"


ARITY = {"sin": 1, "cos": 1, "atan2": 2}
