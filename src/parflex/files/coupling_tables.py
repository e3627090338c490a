"""Couplings of joints in robot files, read and written."""

from collections.abc import Sequence
from typing import Annotated, Any

import numpy as np
from pydantic import Field
from pydantic_core import core_schema

from parflex.base import kinds
from parflex.base.errors import InputError
from parflex.base.kinds import ByType, Kind
from parflex.files.quantity import convert
from parflex.files.tables import Table, Whole
from parflex.robot.coupling import Coupling

MIXED_STIFFNESS = Kind("a stiffness", "N/rad", '30 or "0.5 N/deg"')  # N m/m of the moment is the same
MIXED_DAMPING = Kind("a damping", "N s/rad", '0.5 or "0.01 N s/deg"')


class AsWritten:
    """A number, or a text with a unit, which is read when the types of the joints are known."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(lambda value: value)

    def __get_pydantic_json_schema__(self, core: Any, handler: Any) -> dict[str, Any]:
        return {"anyOf": [{"type": "number"}, {"type": "string"}]}


Entry = Annotated[Any, AsWritten()]
Square = list[list[Entry]]


class CouplingTable(Table):
    """A stiffness and damping on joints of a leg together, each the antecedent of the next."""

    joints: list[Whole] = Field(min_length=1, description="their numbers in the chain, from 1")
    stiffness: Square = Field(description="K, a row for each joint: N/m, N/rad and N m/rad")
    damping: Square | None = Field(None, description="D, likewise")
    rest: list[Entry] | None = Field(None, description="joint values without load, m and rad; by default 0")


def coupling_of(row: CouplingTable, slides: Sequence[int]) -> Coupling:
    """The coupling of a table, whose joints slide (1) or turn (0); raises InputError as `Coupling`."""
    more: dict[str, Any] = {}
    if row.damping is not None:
        more["damping"] = square("damping", row.damping, slides, kinds.DAMPING, MIXED_DAMPING)
    if row.rest is not None:
        more["rest"] = entries("rest", row.rest, [kinds.POSITION.of(sigma) for sigma in slides])
    stiffness = square("stiffness", row.stiffness, slides, kinds.STIFFNESS, MIXED_STIFFNESS)
    return Coupling(tuple(row.joints), stiffness, **more)


def square(name: str, rows: Square, slides: Sequence[int], kind: ByType, mixed: Kind) -> list[list[float]]:
    """A matrix in SI: of a joint by itself in the units of its type, of two in those of both."""
    if len(rows) != len(slides):
        raise InputError(f"{name} has {len(rows)} rows; give one for each of {len(slides)} joints")
    units = [[kind.of(i) if i == j else mixed for j in slides] for i in slides]
    return [entries(f"{name}[{i}]", *pair) for i, pair in enumerate(zip(rows, units, strict=True))]


def entries(name: str, values: Sequence[Any], units: Sequence[Kind]) -> list[float]:
    """Numbers in SI; raises InputError where one is none, or of another kind, or their count is another."""
    if len(values) != len(units):
        raise InputError(f"{name} has {len(values)} numbers; give one for each of {len(units)} joints")
    found = []
    for k, (value, unit) in enumerate(zip(values, units, strict=True)):
        try:
            found.append(convert(value, unit))
        except InputError as error:
            raise InputError(f"{name}[{k}] {error}") from None
    return found


def coupling_entries(coupling: Coupling) -> dict[str, Any]:
    """The table of a coupling, without what is by default."""
    row: dict[str, Any] = {"joints": list(coupling.joints)}
    for name in ("stiffness", "damping", "rest"):
        value = np.asarray(getattr(coupling, name))
        if name == "stiffness" or np.any(value):
            row[name] = value.tolist()
    return row
