"""The types that the tables of all files share: numbers with units, vectors, rotations, strict keys."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Discriminator, Field, Strict, Tag
from pydantic_core import core_schema

from parflex.base import kinds
from parflex.base.array import Array, without_roundoff
from parflex.base.check import NOT_NEGATIVE, Rule, single_rotation
from parflex.base.errors import InputError
from parflex.base.kinds import Kind
from parflex.base.spatial import rotation_from_vector
from parflex.files.quantity import convert, shown


class Table(BaseModel):
    """A table of a file; keys it does not know are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True)


@dataclass(frozen=True)
class Measure:
    """A number of a kind that keeps a rule, as pydantic reads it: SI, or a text with a unit."""

    kind: Kind
    rule: Rule | None = None

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, core: Any, handler: Any) -> dict[str, Any]:
        number = {"type": "number", "description": self.kind.expected}
        return {"anyOf": [number, {"type": "string"}]} if self.kind.unit else number

    def read(self, value: Any) -> float:
        """The SI value; raises InputError, its sentence without a subject."""
        number = convert(value, self.kind)
        if self.rule is not None and self.rule.broken(np.asarray(number)):
            raise InputError(f"is {shown(value)}; {self.rule.words}")
        return number


def rows(value: Any) -> str:
    """The way that nine or fewer numbers are written: "matrix" for rows, or "list"."""
    return "matrix" if isinstance(value, list) and value and isinstance(value[0], list) else "list"


def several(value: Any) -> str:
    """The tag of a value: "one" for all, or a list with one for "each"."""
    return "each" if isinstance(value, list) else "one"


ZEROS = [0.0, 0.0, 0.0]
TWO: Any = Field(min_length=2, max_length=2)
THREE: Any = Field(min_length=3, max_length=3)

Whole = Annotated[int, Strict(), Field(ge=0)]
Flag = Annotated[bool, Field(strict=True)]
Number = Annotated[float, Measure(kinds.NUMBER)]
Length = Annotated[float, Measure(kinds.LENGTH)]
Angle = Annotated[float, Measure(kinds.ANGLE)]
Time = Annotated[float, Measure(kinds.TIME, NOT_NEGATIVE)]
Moment = Annotated[float, Measure(kinds.FIRST_MOMENT)]
Second = Annotated[float, Measure(kinds.INERTIA)]

Ratios = Annotated[
    Annotated[Number, Tag("one")] | Annotated[list[Number], Tag("each")],
    Discriminator(several),
]
Point = Annotated[list[Length], THREE]
Moments3 = Annotated[list[Moment], THREE]
Seconds3x3 = Annotated[list[Annotated[list[Second], THREE]], THREE]

Turn = Annotated[list[Angle], THREE]
Matrix = Annotated[list[Annotated[list[Number], THREE]], THREE]
Rotation = Annotated[Annotated[Turn, Tag("list")] | Annotated[Matrix, Tag("matrix")], Discriminator(rows)]
Six = Annotated[list[Second], Field(min_length=6, max_length=6)]
Inertia = Annotated[Annotated[Six, Tag("list")] | Annotated[Seconds3x3, Tag("matrix")], Discriminator(rows)]


def rotation_of(given: Sequence[Any]) -> Array:
    """R (3, 3) of a rotation vector (3,) rad, or of the matrix itself.

    Raises InputError for a matrix that is none of a rotation, and for a vector of more than a full turn,
    which is one in degrees.
    """
    array = np.asarray(given, dtype=float)
    if array.ndim == 2:
        return single_rotation("rotation", array)
    if np.linalg.norm(array) > 2 * np.pi + 1e-9:
        raise InputError(f'rotation is {given} rad, more than a full turn; write degrees as "30 deg"')
    return without_roundoff(rotation_from_vector(array), 1.0, 1e-15)


def inertia_of(given: Sequence[Any]) -> Array:
    """(3, 3) kg m² of XX, YY, ZZ, XY, XZ, YZ, or of the matrix itself."""
    array = np.asarray(given, dtype=float)
    return array if array.ndim == 2 else array[[[0, 3, 4], [3, 1, 5], [4, 5, 2]]]
