"""Tables of files that are made of the fields of a dataclass, and the dataclass of a table."""

from dataclasses import MISSING
from functools import cache
from typing import Annotated, Any

import numpy as np
from pydantic import Field, create_model

from parflex.files.lines import Where
from parflex.files.reading import Reader
from parflex.files.tables import THREE, TWO, Flag, Inertia, Measure, Ratios, Table, Whole, inertia_of
from parflex.robot.fields import SEVERAL, Column, described


@cache
def table_of(kind: type) -> type[Table]:
    """The table with an entry for each described field of a dataclass."""
    return create_model(f"{kind.__name__}Table", __base__=Table, __doc__=first_line(kind), **entries_of(kind))


def first_line(kind: type) -> str:
    """The first sentence of a docstring."""
    return (kind.__doc__ or "").partition("\n")[0]


def entries_of(kind: type) -> dict[str, Any]:
    """Type and default of the entry of each described field, by name."""
    sigma = getattr(kind, "sigma", 0)
    return {column.file or name: entry(column, sigma) for name, column in described(kind).items()}


def entry(column: Column, sigma: int) -> tuple[Any, Any]:
    """Type and default of an entry; None stands for the default that the dataclass itself has."""
    if column.part is not None:
        plain: Any = table_of(column.part)
    elif column.kind is None:
        plain = Flag if isinstance(column.default, bool) else Whole
    else:
        number: Any = Annotated[float, Measure(column.kind.of(sigma), column.rule)]
        pair, vector = Annotated[list[number], TWO], Annotated[list[number], THREE]
        plain = {(): number, (2,): pair, (3,): vector, (3, 3): Inertia, SEVERAL: Ratios}[column.shape]
    if column.default is MISSING:
        return plain, Field(description=column.words)
    if column.shape == () and column.default is not None and np.isfinite(column.default):
        return plain, Field(column.default, description=column.words)
    return plain | None, Field(None, description=column.words)


def values_of(kind: type, table: Table) -> dict[str, Any]:
    """The values that a table gives of a dataclass's fields, by their names; tables of parts as they are."""
    values = {
        name: (column, getattr(table, column.file or name))
        for name, column in described(kind).items()
        if hasattr(table, column.file or name)
    }
    return {
        name: inertia_of(value) if column.shape == (3, 3) else value
        for name, (column, value) in values.items()
        if value is not None
    }


def built(reader: Reader, where: Where, kind: Any, table: Table) -> Any:
    """The dataclass of a table at a place of the file; None where there are complaints about it."""
    values = values_of(kind, table)
    for name, column in described(kind).items():
        if column.part is not None and name in values:
            values[name] = built(reader, (*where, column.file or name), column.part, values[name])
            if values[name] is None:
                return None
    return reader.attempt(where, kind, **values)
