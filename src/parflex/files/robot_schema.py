"""The tables of a robot file, format "parflex-robot-1"."""

from typing import Annotated, Any, Literal

from pydantic import Field, create_model

from parflex.base import kinds
from parflex.files.leg_schema import ChainTable, LegTable, chain_table
from parflex.files.platform_schema import PlatformTable
from parflex.files.tables import THREE, ZEROS, Measure, Point, Rotation, Table, Whole
from parflex.robot.leg import Joint

FORMAT = "parflex-robot-1"


class HomeTable(Table):
    """The place of the platform when nothing else is said."""

    position: Point = Field(description="the platform frame's origin in the world, in m")
    rotation: Rotation = Field(ZEROS, description="rotation vector or matrix")


class RobotTable(Table):
    """A robot: a fixed base, legs, a platform."""

    format: Literal["parflex-robot-1"] = Field(description='"parflex-robot-1"')
    name: str = ""
    source: str = Field("", description="where the numbers are from")
    gravity: Annotated[list[Annotated[float, Measure(kinds.ACCELERATION)]], THREE] = Field(
        [0.0, 0.0, -9.81], description="in the world"
    )
    mobility: Whole | None = Field(None, description="the platform's freedoms that you expect")
    home: HomeTable = Field(description="the table [home] with position and rotation")
    chain: dict[str, ChainTable] = Field({}, description="chains by name")
    leg: list[LegTable] = Field([], description="legs, one [[leg]] each")
    platform: PlatformTable = Field(discriminator="kind", description="the table [platform]")


def robot_table(joint: type[Joint] = Joint) -> type[RobotTable]:
    """The table of a robot whose joints are of a class, `Joint` or one with more fields."""
    made: Any = chain_table(joint)
    chain = (dict[str, made], RobotTable.model_fields["chain"])
    return create_model("RobotTable", __base__=RobotTable, __doc__=RobotTable.__doc__, chain=chain)
