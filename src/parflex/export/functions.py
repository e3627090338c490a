"""Functions in C: prototypes, bodies, and the tests that call them."""

from collections.abc import Iterable, Sequence
from textwrap import fill

import numpy as np

from parflex.base.array import Array
from parflex.export.cases import Cases
from parflex.export.code import Body
from parflex.export.interface import Routine

WIDTH = 100


def folded(text: str, first: str = "", rest: str = "") -> str:
    """Text on lines of bearable length, broken at spaces only."""
    if len(first) + len(text) <= WIDTH:
        return first + text
    return fill(
        text,
        WIDTH,
        initial_indent=first,
        subsequent_indent=rest,
        break_on_hyphens=False,
        break_long_words=False,
    )


def comment(words: str) -> str:
    """A block comment."""
    return folded(f"{words} */", "/* ", " * ") + "\n"


def prototype(prefix: str, routine: Routine) -> str:
    """The head of a function."""
    given = [f"const double {name}[]" for name in routine.inputs]
    taken = [f"double {name}[]" for name in routine.outputs]
    text = folded(", ".join(given + taken).replace("double ", "double_"), *2 * (" " * 4,))
    return f"int {prefix}_{routine.kernel.name}(\n{text.replace('double_', 'double ')})"


def definition(prefix: str, routine: Routine, body: Body, margins: int) -> str:
    """A whole function: lines that compute, then lines that write. So many of its health are margins."""
    PREFIX = prefix.upper()
    judged = f"{PREFIX}_HEALTH" if routine.closure else str(margins)
    lines = [
        *(f"(void){name};" for name in routine.inputs if name not in body.used),
        *body.lines,
        f"const double judge[] = {{{', '.join(body.outputs[-1]) or '0.0'}}};",
        f"const double sum = {' + '.join(value for part in body.outputs[:-1] for value in part)};",
        f"const int status = judged(judge, {judged});",
        *(line for pair in zip(routine.outputs, body.outputs, strict=True) for line in stored(*pair)),
        f"return status == {PREFIX}_OK && !isfinite(sum) ? {PREFIX}_NOT_FINITE : status;",
    ]
    text = "\n".join(folded(line, " " * 4, " " * 8) for line in lines)
    return f"{prototype(prefix, routine)}\n{{\n{text}\n}}\n"


def stored(name: str, values: Sequence[str]) -> list[str]:
    """Assignments to an output, where it is wanted."""
    if not values:
        return [f"(void){name};"]
    return [f"if ({name} != NULL) {{", *(f"    {name}[{i}] = {v};" for i, v in enumerate(values)), "}"]


def matrix(name: str, rows: Array) -> str:
    """A constant table, to the bit."""
    lines = ["    {\n" + number_lines(row, 8) + "\n    }," for row in rows]
    return f"static const double {name}[CASES][{rows.shape[1]}] = {{\n" + "\n".join(lines) + "\n};\n"


def number_lines(row: Array, spaces: int) -> str:
    """Numbers, to the bit, on lines of bearable length."""
    text = ", ".join(repr(float(value)) for value in row)
    return folded(text, *2 * (" " * spaces,))


def tested(prefix: str, routine: Routine, cases: Cases) -> str:
    """A test of one function: its tables, and a comparison of every output in all cases."""
    kernel, (inputs, outputs, tolerances) = routine.kernel, cases
    name, width, sizes = kernel.name, outputs.shape[1], list(kernel.outputs.values())
    given = [f"given + {start}" for start in starts(kernel.inputs.values())]
    taken = [f"found[k] + {start}" for start in starts(kernel.outputs.values())]
    call = folded(", ".join(given + taken), *2 * (" " * 12,))
    compared = [
        f'    failed += differs("{name}: {array}", found[0] + {at}, {name}_outputs[0] + {at}, '
        f"{width}, {size}, {tolerance:.1e});"
        for array, at, size, tolerance in zip(routine.outputs, starts(sizes), sizes, tolerances, strict=True)
        if size
    ]
    tables = matrix(f"{name}_inputs", inputs) + matrix(f"{name}_outputs", outputs)
    return tables + TEST.format(
        prefix=prefix, name=name, width=width, call=call, compared="\n".join(compared)
    )


TEST = """\
static int test_{name}(void)
{{
    double found[CASES][{width}];
    int k, failed = 0;
    for (k = 0; k < CASES; k++) {{
        const double *given = {name}_inputs[k];
        const int status = {prefix}_{name}(
{call});
        failed += refused("{name}", k, status);
    }}
{compared}
    return failed;
}}
"""


def starts(sizes: Iterable[int]) -> list[int]:
    """The places at which arrays begin that lie one behind the other."""
    return np.cumsum([0, *sizes])[:-1].tolist()


def macros(rows: Sequence[tuple[str, int, str]]) -> str:
    """Definitions (name, value, the arrays it is about) in columns."""
    width = max(len(name) for name, *_ in rows)
    return "\n".join(
        f"#define {name:{width}} {value}" + (f" /* {words} */" if words else "")
        for name, value, words in rows
    )
