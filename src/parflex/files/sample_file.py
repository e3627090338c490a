"""Samples over time from a file of comma-separated values, whose header names columns with their units."""

import csv
import math
import os
import re
from collections.abc import Callable, Mapping
from itertools import pairwise
from pathlib import Path
from typing import TypeVar

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.base.kinds import ACCELERATION, TIME, Kind
from parflex.base.nearest import nearest
from parflex.files.quantity import LONGEST, factor, shown
from parflex.files.reading import file_text, printable

LARGEST = 100_000_000  # bytes
HEAD = re.compile(r"(.*?)\s*(?:\[([^\[\]]*)\])?")
SPELT = {(ACCELERATION, "g"): "standard_gravity"}  # units that are others elsewhere: g is a gram
CLOCK = "t"
What = TypeVar("What")


def read_samples(path: str | os.PathLike[str], kinds: Mapping[str, Kind]) -> tuple[Array, dict[str, Array]]:
    """Times (T,) s and the columns (T,) in SI units, by name, of the kinds that are known.

    The first row is like `t [s], x [mm], rz [mrad]`; columns are set apart by commas, semicolons or tabs.
    Empty rows and those that begin with # are passed over.

    Raises InputError, with the line, for unknown columns, units that are missing or of another kind, cells
    that are no finite numbers, rows of another length, and times that do not increase.
    """
    example = f"{CLOCK} [s], {next(iter(kinds))} [mm]"
    return read_table(path, "a file of samples", {CLOCK: TIME, **kinds}, unit_of, example)


def read_table(
    path: str | os.PathLike[str],
    words: str,
    kinds: Mapping[str, What],
    unit: Callable[[str, str, str | None, What], float],
    example: str,
) -> tuple[Array, dict[str, Array]]:
    """The first column (T,), which increases, and the others (T,), by name, each times the number that `unit`
    finds for its place, name, unit and kind; the first column is the first of the kinds.

    Raises InputError as `read_samples`.
    """
    name, text = Path(path).name, file_text(Path(path), LARGEST, words)
    lines = [(number, row) for number, row in enumerate(text.splitlines(), 1) if is_row(row)]
    if not lines:
        raise InputError(f"{name} is empty; begin it with a header like {example}")
    (first, head), *rows = lines
    mark = next((mark for mark in ";\t" if mark in head), ",")
    columns = named(f"{name}:{first}", cells(head, mark), kinds, unit, example.partition(",")[0])
    table = np.empty((len(rows), len(columns)))
    for at, (number, row) in enumerate(rows):
        table[at] = numbers(f"{name}:{number}", cells(row, mark), list(columns))
    clock = next(iter(kinds))
    check_times(name, clock, table[:, 0], [number for number, _ in rows])
    values = dict(zip(columns, (table * list(columns.values())).T, strict=True))
    return values.pop(clock), values


def is_row(line: str) -> bool:
    """False for an empty line and for a remark."""
    return bool(line.strip(" \t,;")) and not line.lstrip().startswith("#")


def cells(line: str, mark: str) -> list[str]:
    """The cells of a row without the blanks about them; none for a separator at its end."""
    found = [cell.strip() for cell in next(csv.reader([line], delimiter=mark))]
    return found[:-1] if found[-1] == "" else found


def named(
    where: str,
    heads: list[str],
    kinds: Mapping[str, What],
    unit_of: Callable[[str, str, str | None, What], float],
    clock: str,
) -> dict[str, float]:
    """The columns of a header, each with the SI units that one of its own is."""
    columns: dict[str, float] = {}
    for head in heads:
        found = HEAD.fullmatch(head)
        name, unit = found.groups() if found and head not in kinds else (head, None)
        if name not in kinds:
            close = nearest(name, kinds)
            known = f"did you mean {close}?" if close else f"known here: {', '.join(kinds)}"
            raise complaint(where, f"column {shown(name)} is not known; {known}")
        if name in columns:
            raise complaint(where, f"column {name} is there twice; keep one")
        columns[name] = unit_of(where, name, unit, kinds[name])
    if next(iter(columns), "") != next(iter(kinds)):
        raise complaint(where, f"the first column is {shown(next(iter(columns), ''))}; begin with {clock}")
    return columns


def unit_of(where: str, name: str, unit: str | None, kind: Kind) -> float:
    """The number of SI units that one unit of a column is."""
    if not unit or not unit.strip():
        another = f"write {name} [{kind.unit}], or another unit of {kind.words}"
        raise complaint(where, f"column {name} has no unit; {another}")
    if len(unit) > LONGEST:
        raise complaint(where, f"the unit of column {name} is {shown(unit)}; expected {kind.expected}")
    try:
        return factor(unit, SPELT.get((kind, unit.strip()), unit.strip()), kind)
    except InputError as error:
        raise complaint(where, f"the unit of column {name} {error}") from None


def numbers(where: str, row: list[str], columns: list[str]) -> list[float]:
    """The numbers of a row."""
    if len(row) != len(columns):
        raise complaint(where, f"this row has {len(row)} values; the header names {len(columns)} columns")
    found = []
    for name, cell in zip(columns, row, strict=True):
        try:
            number = float(cell)
        except ValueError:
            raise complaint(where, f"{name} is {shown(cell)}; write a number, with a decimal point") from None
        if not math.isfinite(number):
            raise complaint(where, f"{name} is {cell}; leave such rows out, or give a finite number")
        found.append(number)
    return found


def check_times(name: str, clock: str, times: Array, lines: list[int]) -> None:
    """Raise InputError for a time, or another first column, that is not later than the one before."""
    for (early, late), line in zip(pairwise(times.tolist()), lines[1:], strict=True):
        if late <= early:
            raise complaint(
                f"{name}:{line}", f"{clock} is {late:.10g}, not later than {early:.10g} before it"
            )


def complaint(where: str, words: str) -> InputError:
    """The error about a line."""
    return InputError(f"{where}: {printable(words)}")
