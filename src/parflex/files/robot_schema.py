"""The tables of a robot file, format "parflex-robot-1"."""

from typing import Annotated, Any, Literal

from pydantic import Field, create_model

from parflex.base import kinds
from parflex.files.described import entries_of, table_of
from parflex.files.leg_schema import AnyChainTable, LegTable, chain_table
from parflex.files.platform_schema import PlatformTable
from parflex.files.tables import THREE, ZEROS, Measure, Point, Rotation, Table, Whole
from parflex.files.tool_schema import SensorTable, ToolTable
from parflex.robot.leg import Joint
from parflex.robot.payload import Payload
from parflex.robot.strut import Strut
from parflex.robots.hexapod_geometry import HexapodGeometry

FORMAT = "parflex-robot-1"


class HomeTable(Table):
    """The place of the platform when nothing else is said."""

    position: Point = Field(description="the platform frame's origin in the world, in m")
    rotation: Rotation = Field(ZEROS, description="rotation vector or matrix")


strut: Any = table_of(Strut)
HexapodTable: Any = create_model(
    "HexapodTable",
    __base__=Table,
    __doc__="A hexapod, in the place of chains, legs and home.",
    **entries_of(HexapodGeometry),
    strut=(
        strut | None,
        Field(None, description="each of the six, with cylinder and rod; by default a usual one"),
    ),
)
PayloadTable: Any = table_of(Payload)


class RobotTable(Table):
    """A robot: a fixed base, legs, a platform."""

    format: Literal["parflex-robot-1"] = Field(description='"parflex-robot-1"')
    name: str = ""
    source: str = Field("", description="where the numbers are from")
    gravity: Annotated[list[Annotated[float, Measure(kinds.ACCELERATION)]], THREE] = Field(
        [0.0, 0.0, -9.81], description="in the world"
    )
    mobility: Whole | None = Field(None, description="the platform's freedoms that you expect")
    hexapod: HexapodTable | None = Field(None, description="a hexapod, instead of home, chain and leg")
    home: HomeTable | None = Field(None, description="the table [home] with position and rotation")
    chain: dict[str, AnyChainTable] = Field({}, description="chains by name")
    leg: list[LegTable] = Field([], description="legs, one [[leg]] each")
    platform: PlatformTable | None = Field(
        None, discriminator="kind", description="the table [platform]; a hexapod has a disc by default"
    )
    payload: PayloadTable | None = Field(None, description="a rigid body on the platform")
    tool: ToolTable | None = Field(None, description="the point of the platform that does the work")
    sensor: dict[str, SensorTable] = Field({}, description="sensors by name")

    @property
    def chains(self) -> list[str]:
        """The name of each leg's chain; "hexapod" for those of a hexapod."""
        return ["hexapod"] * 6 if self.hexapod else [row.chain for row in self.leg]


def robot_table(joint: type[Joint] = Joint) -> type[RobotTable]:
    """The table of a robot whose joints are of a class, `Joint` or one with more fields."""
    made: Any = chain_table(joint)
    chain = (dict[str, made], RobotTable.model_fields["chain"])
    return create_model("RobotTable", __base__=RobotTable, __doc__=RobotTable.__doc__, chain=chain)
