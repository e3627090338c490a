"""A CasADi graph as C99: straight-line code in locals, every input read before an output is written."""

from collections.abc import Sequence
from typing import NamedTuple

import casadi
import numpy as np

SUM, PRODUCT, ATOM = 1, 2, 3  # how tightly an expression binds
BINARY = {
    casadi.OP_ADD: ("+", SUM),
    casadi.OP_SUB: ("-", SUM),
    casadi.OP_MUL: ("*", PRODUCT),
    casadi.OP_DIV: ("/", PRODUCT),
}
TWICE_THE_OPERAND = {casadi.OP_SQ: ("*", PRODUCT), casadi.OP_TWICE: ("+", SUM)}
TWICE = (*TWICE_THE_OPERAND, casadi.OP_OUTPUT)
LIBRARY = {
    casadi.OP_SQRT: "sqrt",
    casadi.OP_FABS: "fabs",
    casadi.OP_SIN: "sin",
    casadi.OP_COS: "cos",
    casadi.OP_ATAN2: "atan2",
}
LONGEST = 48  # characters of an expression that goes into the only one that uses it


class Expression(NamedTuple):
    """Text in C, and how tightly it binds."""

    text: str
    binds: int


class Body(NamedTuple):
    """The body of a function: lines that load and compute, the inputs and functions of the C library that
    they use, the outputs' values."""

    lines: list[str]
    used: set[str]
    library: set[str]
    outputs: list[list[str]]


def body(graph: casadi.Function, names: Sequence[str], optional: Sequence[str] = ()) -> Body:
    """The graph with its inputs named; an optional one may be NULL, which stands for zeros."""
    return Writer(graph, names, optional).body()


class Writer:
    """The lines of one function; `values` maps the graph's work slots to expressions."""

    def __init__(self, graph: casadi.Function, names: Sequence[str], optional: Sequence[str]) -> None:
        self.graph, self.names, self.optional = graph, names, optional
        self.lines: list[str] = []
        self.loads: dict[tuple[int, int], str] = {}
        self.values: dict[int, Expression] = {}
        self.outputs = [["0.0"] * graph.numel_out(i) for i in range(graph.n_out())]
        self.uses = uses(graph)
        self.library: set[str] = set()
        self.count = 0

    def body(self) -> Body:
        """All instructions in their order, the loads first."""
        write = {casadi.OP_INPUT: self.load, casadi.OP_OUTPUT: self.store, casadi.OP_CONST: self.constant}
        for k in range(self.graph.n_instructions()):
            write.get(self.graph.instruction_id(k), self.compute)(k)
        used = {self.names[array] for array, _ in self.loads}
        loads = [self.loads[place] for place in sorted(self.loads)]
        return Body(loads + self.lines, used, self.library, self.outputs)

    def load(self, k: int) -> None:
        """One entry of an input."""
        array, entry = self.graph.instruction_input(k)
        name = self.names[array]
        guard = f"{name} == NULL ? 0.0 : " if name in self.optional else ""
        self.loads[array, entry] = f"const double {name}{entry} = {guard}{name}[{entry}];"
        self.set(k, Expression(f"{name}{entry}", ATOM))

    def store(self, k: int) -> None:
        """One entry of an output."""
        array, entry = self.graph.instruction_output(k)
        self.outputs[array][entry] = self.values[self.graph.instruction_input(k)[0]].text

    def constant(self, k: int) -> None:
        """A number, to the bit."""
        self.set(k, number(self.graph.instruction_constant(k)))

    def compute(self, k: int) -> None:
        """One operation, in a line of its own unless one other alone needs it and it is short."""
        found = self.expression(k)
        if self.uses[k] != 1 or len(found.text) > LONGEST:
            self.count += 1
            self.lines.append(f"const double t{self.count} = {found.text};")
            found = Expression(f"t{self.count}", ATOM)
        self.set(k, found)

    def expression(self, k: int) -> Expression:
        """The expression that an instruction computes."""
        op = self.graph.instruction_id(k)
        given = [self.values[slot] for slot in self.graph.instruction_input(k)]
        if op in BINARY:
            return binary(*BINARY[op], *given)
        if op in TWICE_THE_OPERAND:
            return binary(*TWICE_THE_OPERAND[op], given[0], given[0])
        if op == casadi.OP_INV:
            return binary("/", PRODUCT, Expression("1.0", ATOM), given[0])
        if op == casadi.OP_NEG:
            return Expression(f"-{bracketed(given[0], ATOM)}", SUM)
        if op in LIBRARY:
            self.library.add(LIBRARY[op])
            return Expression(f"{LIBRARY[op]}({', '.join(value.text for value in given)})", ATOM)
        raise NotImplementedError(f"operation {op} of CasADi has no translation")

    def set(self, k: int, value: Expression) -> None:
        """Put a value into the slot of an instruction."""
        self.values[self.graph.instruction_output(k)[0]] = value


def uses(graph: casadi.Function) -> list[int]:
    """The number of operands that each instruction's value becomes; an output counts twice, so that it is
    named."""
    count = [0] * graph.n_instructions()
    origin: dict[int, int] = {}
    for k in range(graph.n_instructions()):
        op = graph.instruction_id(k)
        if op not in (casadi.OP_INPUT, casadi.OP_CONST):
            for slot in graph.instruction_input(k):
                count[origin[slot]] += 2 if op in TWICE else 1
        if op != casadi.OP_OUTPUT:
            origin[graph.instruction_output(k)[0]] = k
    return count


def binary(sign: str, binds: int, left: Expression, right: Expression) -> Expression:
    """Two operands, the right one in brackets where it binds no tighter."""
    return Expression(f"{bracketed(left, binds)} {sign} {bracketed(right, binds + 1)}", binds)


def bracketed(value: Expression, binds: int) -> str:
    """The text, in brackets where it binds less tightly."""
    return value.text if value.binds >= binds else f"({value.text})"


def number(value: float) -> Expression:
    """A constant, to the bit."""
    if not np.isfinite(value):
        raise NotImplementedError(f"{value} has no place in C code")
    return Expression(repr(float(value)), ATOM if value >= 0 else SUM)
