"""The line of a value in a TOML file, found by parsing parts of the file, without a parser of our own."""

import bisect
import tomllib
from collections.abc import Sequence
from typing import Any

Where = tuple[str | int, ...]  # the way to a value: ("leg", 2, "origin", 0)


def line_of(text: str, where: Where) -> int:
    """The line, from 1, of the statement or array entry that gives the value at `where`.

    Steps that lead nowhere are left out; for a missing value it is the line of the table it is
    missing from.
    """
    found = reached(tomllib.loads(text), where)
    if not found:
        return 1
    lines = text.split("\n")
    ends = statements(lines)
    number = bisect.bisect_left(ends, True, key=lambda end: leads(parsed("\n".join(lines[:end])), found))
    return line_in_array(lines, ends[number - 1] if number else 0, ends[number], found)


def statements(lines: Sequence[str]) -> list[int]:
    """The number of lines up to the end of each statement: each parses by itself, and no part of it does."""
    ends, start = [], 0
    for end in range(1, len(lines) + 1):
        if parsed("\n".join(lines[start:end])) is not None:
            ends.append(end)
            start = end
    return ends


def line_in_array(lines: Sequence[str], start: int, end: int, where: Where) -> int:
    """The line, from 1, of a value in the statement on lines start … end.

    In an array over several lines each entry has its own: the first line after which the array,
    closed there, holds it.
    """
    closed = {line: parsed("\n".join(lines[:line]) + "\n]") for line in range(start + 1, end)}
    arrays = {line: document for line, document in closed.items() if document is not None}
    first = start + 1 if not arrays else end
    return next((line for line, document in arrays.items() if leads(document, where)), first)


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
    except tomllib.TOMLDecodeError:
        return None
