"""The tables of a trajectory file, format "parflex-trajectory-1"."""

from dataclasses import MISSING, fields
from functools import cache, reduce
from operator import or_
from typing import Annotated, Any, Literal, cast

from pydantic import Discriminator, Field, Tag, create_model, model_validator

from parflex.base import kinds
from parflex.base.check import NOT_NEGATIVE, POSITIVE
from parflex.base.errors import InputError
from parflex.base.kinds import Kind
from parflex.files.tables import THREE, ZEROS, Measure, Point, Rotation, Table, Time, Whole, several
from parflex.robot.fields import Column, described
from parflex.simulation.laws import ALL_LAWS
from parflex.simulation.laws.controller import INDEX, REQUIRED, Controller
from parflex.simulation.moves import ALL_MOVES, Move

FORMAT = "parflex-trajectory-1"

Lasting = Annotated[float, Measure(kinds.TIME, POSITIVE)]
Tolerance = Annotated[float, Measure(kinds.NUMBER, POSITIVE)]


class MoveTable(Table):
    """A pose to go to, as a displacement from the start in world axes; or a move of another kind."""

    position: Point = Field(ZEROS, description="displacement from the start")
    rotation: Rotation = Field(ZEROS, description="rotation vector or matrix, from the start")
    duration: Lasting | None = Field(None, description="the time it takes, in s")

    @property
    def words(self) -> list[str]:
        """The keys that are given of other kinds."""
        return sorted(self.model_fields_set - MoveTable.model_fields.keys())

    @model_validator(mode="after")
    def _one_kind(self) -> "MoveTable":
        if self.words and len(self.model_fields_set) > 1:
            given = " and ".join(sorted(self.model_fields_set))
            raise InputError(f"gives {given}; keep {self.words[0]} alone, and give each move a [[move]]")
        if not self.words and self.duration is None:
            raise InputError("has no duration; give the time it takes, in s")
        return self


class BaseTable(Table):
    """A base that moves, as on a floor that shakes."""

    file: str = Field(
        description="samples (CSV) with units in the header, t [s], x [mm], ry [mrad]; relative to this file"
    )


class PlanTable(Table):
    """A motion through poses, what drives it, and how it is integrated."""

    format: Literal["parflex-trajectory-1"] = Field(description='"parflex-trajectory-1"')
    start: Literal["equilibrium", "home"] = Field("equilibrium", description="bent by weight, or not")
    rest: Annotated[list[Time], Field(min_length=2, max_length=2)] = Field(
        [0.5, 0.5], description="times at rest before the first move and after the last"
    )
    move: list[MoveTable] = Field(min_length=1, description="the moves in order, one [[move]] each")
    controller: Any = Field(None, description="the table [controller]")  # of one of the laws
    base: BaseTable | None = Field(None, description="the table [base]: how the base moves")
    sample_time: Lasting = Field(5e-3, description="between output times")
    rtol: Tolerance = Field(1e-7, description="relative error of a step")
    atol: Tolerance = Field(1e-9, description="absolute error of a step")
    max_step: Lasting | None = Field(None, description="longest step; by default a fiftieth of the run")


@cache
def trajectory_table(
    laws: tuple[type[Controller], ...] = ALL_LAWS, moves: tuple[type[Move], ...] = ALL_MOVES
) -> type[PlanTable]:
    """The table of a whole file whose [controller] is one of some laws, and whose moves are of some kinds."""
    tables = tuple(table_of(law) for law in laws if law.kind)
    one_of: Any = reduce(or_, tables)
    one_move: Any = move_table(moves)
    words = "the table [controller]; by default the legs' servos, where they can hold the robot"
    entries: dict[str, Any] = {
        "controller": (one_of | None, Field(None, discriminator="kind", description=words)),
        "move": (list[one_move], PlanTable.model_fields["move"]),
    }
    return create_model("TrajectoryTable", __base__=PlanTable, __doc__=PlanTable.__doc__, **entries)


def move_table(kinds: tuple[type[Move], ...]) -> type[MoveTable]:
    """The table of a move, which has a key for each kind that has a word."""
    entries: dict[str, Any] = {
        kind.word: (value_of(kind) | None, Field(None, description=kind.about)) for kind in kinds if kind.word
    }
    return create_model("MoveTable", __base__=MoveTable, __doc__=MoveTable.__doc__, **entries)


def value_of(kind: type[Move]) -> Any:
    """The type of a kind's value: its table, or the number itself where it has one field alone."""
    columns = described(kind)
    if len(columns) == 1:
        return entry_type(*columns.values())
    entries: dict[str, Any] = {
        each.name: entry_of(each.default, columns[each.name]) for each in fields(cast(Any, kind))
    }
    return create_model(f"{kind.__name__}Table", __base__=Table, __doc__=kind.about, **entries)


def entry_of(default: Any, column: Column) -> tuple[Any, Any]:
    """Type and default of an entry of a kind's table."""
    given = entry_type(column)
    default = ... if default is MISSING else default
    return given if default is not None else given | None, Field(default, description=column.words)


def entry_type(column: Column) -> Any:
    """A number, or three."""
    assert column.kind is not None
    number: Any = Annotated[float, Measure(cast(Kind, column.kind), column.rule)]
    return Annotated[list[number], THREE] if column.shape else number


def table_of(law: type[Controller]) -> type[Table]:
    """The table [controller] of a law, made from its entries."""
    fields: dict[str, Any] = {"kind": (Literal[law.kind], ...)}
    for entry in law.entries:
        default = ... if entry.default is REQUIRED else entry.default
        kind = type_of(entry.measure) | None if default is None else type_of(entry.measure)
        fields[entry.name] = (kind, Field(default, description=entry.words))
    return create_model(f"{law.__name__}Table", __base__=Table, __doc__=law.about, **fields)


def type_of(measure: Kind) -> Any:
    """A list of whole numbers, or one number for all freedoms, or a list with one for each."""
    if measure is INDEX:
        return list[Whole]
    number = Annotated[float, Measure(measure, NOT_NEGATIVE)]
    return Annotated[
        Annotated[number, Tag("one")] | Annotated[list[number], Tag("each")], Discriminator(several)
    ]
