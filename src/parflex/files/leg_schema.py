"""The tables of legs in a robot file: tips, chains, legs."""

from typing import Annotated, Any

from pydantic import Field, WithJsonSchema, create_model

from parflex.files.joint_table import JointTable, Prismatic, Revolute, joint_table
from parflex.files.tables import ZEROS, Point, Rotation, Table, Whole
from parflex.robot.leg import Joint

Posture = Annotated[
    list[Any],
    WithJsonSchema({"type": "array", "items": {"anyOf": [{"type": "number"}, {"type": "string"}]}}),
]


class TipTable(Table):
    """A point of a link that holds the platform by a spherical joint."""

    frame: Annotated[int, Field(strict=True, ge=1)] = Field(description="the link it is on, from 1")
    offset: Point = Field(ZEROS, description="where on the link, in its frame")


class ChainTable(Table):
    """A kind of leg: joints and tips that several legs have in common."""

    joints: list[JointTable] = Field(min_length=1, description="the joints in order, each with its type")
    tips: list[TipTable] = Field(min_length=1, description="where it holds the platform")
    posture: Posture | None = Field(None, description="joint values near which the legs work")


def chain_table(joint: type[Joint]) -> type[ChainTable]:
    """The table of a chain whose joints are of a class."""
    turning, sliding = joint_table(Revolute, joint), joint_table(Prismatic, joint)
    either: Any = Annotated[turning | sliding, Field(discriminator="type")]
    joints = (list[either], ChainTable.model_fields["joints"])
    return create_model("ChainTable", __base__=ChainTable, __doc__=ChainTable.__doc__, joints=joints)


class LegTable(Table):
    """A leg: a chain placed on the base."""

    chain: str = Field(description="the name of one of the chains")
    origin: Point = Field(description="the leg's base point in the world, in m")
    rotation: Rotation = Field(ZEROS, description="rotation vector or matrix of its base frame")
    attachments: list[Whole] = Field(description="for each tip the platform's attachment, from 0")
    posture: Posture | None = Field(None, description="instead of the chain's")
