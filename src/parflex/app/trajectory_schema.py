"""The tables of a trajectory file, format "parflex-trajectory-1"."""

from functools import cache
from typing import Annotated, Any, Literal, Union

from pydantic import Discriminator, Field, Tag, create_model

from parflex.base import kinds
from parflex.base.check import NOT_NEGATIVE, POSITIVE
from parflex.base.kinds import Kind
from parflex.files.tables import ZEROS, Measure, Point, Rotation, Table, Time, Whole, several
from parflex.simulation.laws import ALL_LAWS
from parflex.simulation.laws.controller import INDEX, REQUIRED, Controller

FORMAT = "parflex-trajectory-1"

Lasting = Annotated[float, Measure(kinds.TIME, POSITIVE)]
Tolerance = Annotated[float, Measure(kinds.NUMBER, POSITIVE)]


class MoveTable(Table):
    """A pose to go to, as a displacement from the start in world axes."""

    position: Point = Field(ZEROS, description="displacement from the start")
    rotation: Rotation = Field(ZEROS, description="rotation vector or matrix, from the start")
    duration: Lasting = Field(description="the time it takes, in s")


class PlanTable(Table):
    """A motion through poses, what drives it, and how it is integrated."""

    format: Literal["parflex-trajectory-1"] = Field(description='"parflex-trajectory-1"')
    start: Literal["equilibrium", "home"] = Field("equilibrium", description="bent by weight, or not")
    rest: Annotated[list[Time], Field(min_length=2, max_length=2)] = Field(
        [0.5, 0.5], description="times at rest before the first move and after the last"
    )
    move: list[MoveTable] = Field(min_length=1, description="the moves in order, one [[move]] each")
    controller: Any = Field(None, description="the table [controller]")  # of one of the laws
    sample_time: Lasting = Field(5e-3, description="between output times")
    rtol: Tolerance = Field(1e-7, description="relative error of a step")
    atol: Tolerance = Field(1e-9, description="absolute error of a step")
    max_step: Lasting | None = Field(None, description="longest step; by default a fiftieth of the run")


@cache
def trajectory_table(laws: tuple[type[Controller], ...] = ALL_LAWS) -> type[PlanTable]:
    """The table of a whole file whose [controller] is one of some laws."""
    tables = tuple(table_of(law) for law in laws if law.kind)
    one_of: Any = Union[tables]  # noqa: UP007
    words = "the table [controller]; by default the legs' servos, where they can hold the robot"
    controller = (one_of | None, Field(None, discriminator="kind", description=words))
    return create_model(
        "TrajectoryTable", __base__=PlanTable, __doc__=PlanTable.__doc__, controller=controller
    )


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
