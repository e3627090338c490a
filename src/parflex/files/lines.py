"""The line of a value in a TOML file, found by parsing its statements, without a parser of our own."""

import re
import tomllib
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

Where = tuple[str | int, ...]  # the way to a value: ("leg", 2, "origin", 0)

# of a text that is TOML: what hides brackets, brackets, and the ends of lines
TOKENS = re.compile(
    r'"""(?:\\.|[^\\])*?"{3,5}|\'\'\'.*?\'{3,5}|"(?:\\.|[^"\\\n])*"|\'[^\'\n]*\'|#[^\n]*|[][{}\n]', re.DOTALL
)
DEPTHS = {"[": 1, "{": 1, "]": -1, "}": -1}


class Statement(NamedTuple):
    """Lines first … last, counted from 1: the table that they begin, or set values in; what they set."""

    first: int
    last: int
    table: Where
    values: Any  # None for the head of a table

    def gives(self, where: Where) -> bool:
        """True where the value, or a part of it, is in this statement."""
        if self.values is None:
            return self.table[: len(where)] == where
        depth = len(self.table)
        return where[:depth] == self.table and leads(self.values, where[depth:])


def line_of(text: str, where: Where) -> int:
    """The line, from 1, of the statement or array entry that gives the value at `where`.

    Steps that lead nowhere are left out; for a missing value it is the line of the table it is
    missing from.
    """
    return lines_of(text, [where])[0]


def lines_of(text: str, places: Sequence[Where]) -> list[int]:
    """The lines of several values; the file is gone through once."""
    lines, ends, document = text.split("\n"), depths(text), tomllib.loads(text)
    wanted = [reached(document, where) for where in places]
    found: dict[Where, int] = {(): 1}
    for each in statements(lines, ends):
        for where in wanted:
            if where not in found and each.gives(where):
                found[where] = line_in_array(lines, ends, each, where)
        if len(found) > len(set(wanted)):
            break
    return [found.get(where, 1) for where in wanted]


def depths(text: str) -> list[int]:
    """The number of open brackets at the end of each line; −1 amid a string."""
    depth, found = 0, []
    for token in TOKENS.finditer(text):
        if token[0] == "\n":
            found.append(depth)
        elif token[0] in DEPTHS:
            depth += DEPTHS[token[0]]
        else:
            found += [-1] * token[0].count("\n")
    return [*found, depth]


def statements(lines: Sequence[str], ends: Sequence[int]) -> Iterator[Statement]:
    """The statements of a document in order: its values, and the heads of its tables."""
    start = 0
    table: Where = ()
    counts: dict[Where, int] = {}
    for end, depth in enumerate(ends, 1):
        if depth:
            continue
        text, first = "\n".join(lines[start:end]), start + 1
        values: Any = parsed(text) or {}
        start = end
        if text.lstrip().startswith("["):
            table, values = head(values, counts), None
        if values is None or values:
            yield Statement(first, end, table, values)


def head(values: Any, counts: dict[Where, int]) -> Where:
    """The table that a head begins, which by itself reads as `values`; of an array of tables the next one.

    `counts` holds the last entries of arrays of tables, and is brought up to date.
    """
    where: Where = ()
    while values:
        if isinstance(values, list):
            counts[where] = counts.get(where, -1) + 1
            return (*where, counts[where])
        [(key, values)] = values.items()
        if where in counts:
            where = (*where, counts[where])
        where = (*where, key)
    return where


def line_in_array(lines: Sequence[str], ends: Sequence[int], statement: Statement, where: Where) -> int:
    """The line, from 1, of a value in a statement.

    In an array over several lines each entry has its own: the first line after which the array,
    closed there, holds it.
    """
    first, last, table, array = statement
    rows = [line for line in range(first, last) if ends[line - 1] == 1]
    steps = len(table)
    while isinstance(array, dict):
        [array] = array.values() if len(array) == 1 else [None]
        steps += 1
    if not rows or array is None or len(where) <= steps:
        return rows[0] if rows else first
    start = parsed("\n".join(lines[first - 1 : rows[0]]) + "\n]")
    left = int(where[steps]) - len(flattened(start))
    for before, row in pairwise(rows):
        if left < 0:
            return before
        left -= len(flattened(parsed("x = [" + "\n".join(lines[before:row]).lstrip(", \n") + "\n]")))
    return rows[-1] if left < 0 else last


def flattened(document: Any) -> list[Any]:
    """The array of a document that is one value; empty where there is none."""
    while isinstance(document, dict) and document:
        document = next(iter(document.values()))
    return document if isinstance(document, list) else []


def reached(document: Any, where: Where) -> Where:
    """The steps of `where` that lead somewhere, in order."""
    found: list[str | int] = []
    for step in where:
        if has(document, step):
            document = document[step]
            found.append(step)
    return tuple(found)


def leads(document: Any, where: Where) -> bool:
    """True where every step leads somewhere."""
    return len(reached(document, where)) == len(where)


def has(node: Any, step: str | int) -> bool:
    """True where a table has the key, or an array the entry."""
    if isinstance(node, dict):
        return step in node
    return isinstance(node, list) and isinstance(step, int) and step < len(node)


def parsed(text: str) -> dict[str, Any] | None:
    """The document; None for a text that is no TOML."""
    try:
        return tomllib.loads(text)
    except ValueError:
        return None
