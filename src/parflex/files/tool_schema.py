"""The tables of a robot file that say where one works and where one measures: the tool and sensors."""

from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from parflex.base.errors import InputError
from parflex.files.tables import THREE, ZEROS, Number, Point, Rotation, Table, Whole


class Place(Table):
    """A place of the platform: a point that is fixed to it, or a node."""

    position: Point | None = Field(None, description="a point in the platform's frame")
    node: Whole | None = Field(None, description="or a node of the platform, by its number")


class ToolTable(Place):
    """The tool: the point of the platform that does the work."""

    rotation: Rotation = Field(ZEROS, description="of the tool's frame in the platform's")

    @model_validator(mode="after")
    def _one_place(self) -> "ToolTable":
        if (self.position is None) == (self.node is None):
            raise InputError("needs position or node, and not both")
        return self


class PlaceSensor(Place):
    """A sensor at a place of the platform, by default at the tool."""

    type: Literal["accelerometer", "displacement"]
    direction: Annotated[list[Number], THREE] | None = Field(
        None, description="in which it measures, in the platform's frame; by default along all three axes"
    )

    @model_validator(mode="after")
    def _one_place(self) -> "PlaceSensor":
        if None not in (self.position, self.node):
            raise InputError("has position and node; keep one of them")
        return self


class LegSensor(Table):
    """A sensor at a leg's motor, or one at each."""

    type: Literal["encoder", "strut-force"]
    leg: Whole | None = Field(None, description="the leg's number, from 0; by default all legs")


SensorTable: Any = Annotated[PlaceSensor | LegSensor, Field(discriminator="type")]
