"""The tables of legs in a robot file: tips, chains by joints or by kind, legs."""

from functools import cache
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, WithJsonSchema, create_model

from parflex.files.coupling_tables import CouplingTable
from parflex.files.described import entries_of, first_line
from parflex.files.flexure_schema import FlexureTable
from parflex.files.joint_table import JointTable, Prismatic, Revolute, joint_table
from parflex.files.tables import ZEROS, Point, Rotation, Table, Whole
from parflex.robot.leg import Joint
from parflex.robots.legs import ALL_LEG_KINDS, LegKind

Posture = Annotated[
    list[Any],
    WithJsonSchema({"type": "array", "items": {"anyOf": [{"type": "number"}, {"type": "string"}]}}),
]


class TipTable(Table):
    """A point of a link that holds the platform by a spherical joint."""

    frame: Whole = Field(description="the link it is on, from 1; 0 is the leg's base")
    offset: Point = Field(ZEROS, description="where on the link, in its frame")
    flexure: FlexureTable | None = Field(None, description="what acts against its turning")


class AnyChainTable(Table):
    """A kind of leg that several legs have in common."""

    posture: Posture | None = Field(None, description="joint values near which the legs work")


class ChainTable(AnyChainTable):
    """A kind of leg: joints and tips that several legs have in common."""

    joints: list[JointTable] = Field(description="the joints in order, each with its type; [] for a post")
    tips: list[TipTable] = Field(min_length=1, description="where it holds the platform")
    couplings: list[CouplingTable] = Field([], description="stiffnesses on several joints together")


class KindTable(AnyChainTable):
    """A kind of leg by physical fields."""

    type: str


JOINTS = ""  # the tag of a chain without a type


@cache
def kind_table(kind: type[LegKind]) -> type[KindTable]:
    """The table of a chain that is a kind of leg, with an entry for each field of the kind's dataclass."""
    named: Any = (Literal[kind.word], Field(description="the kind of leg"))
    made: Any = create_model(
        f"{kind.__name__}Table", __base__=KindTable, __doc__=first_line(kind), type=named, **entries_of(kind)
    )
    return made


def tag(value: Any) -> Any:
    """The kind that a chain says it is; that of joints where it says none."""
    return value.get("type", JOINTS) if isinstance(value, dict) else JOINTS


def chain_table(joint: type[Joint]) -> Any:
    """The table of a chain: joints of a class and tips, or one of the kinds of legs."""
    turning, sliding = joint_table(Revolute, joint), joint_table(Prismatic, joint)
    either: Any = Annotated[turning | sliding, Field(discriminator="type")]
    joints = (list[either], ChainTable.model_fields["joints"])
    by_joints = create_model("ChainTable", __base__=ChainTable, __doc__=ChainTable.__doc__, joints=joints)
    union: Any = Annotated[by_joints, Tag(JOINTS)]
    mapping = {}
    for kind in ALL_LEG_KINDS:
        table = kind_table(kind)
        union |= Annotated[table, Tag(kind.word)]
        mapping[kind.word] = f"#/$defs/{table.__name__}"
    choice: Any = {
        "discriminator": {"propertyName": "type", "mapping": mapping | {JOINTS: "#/$defs/ChainTable"}}
    }
    return Annotated[union, Discriminator(tag), Field(json_schema_extra=choice)]


class LegTable(Table):
    """A leg: a chain placed on the base."""

    chain: str = Field(description="the name of one of the chains")
    origin: Point = Field(description="the leg's base point in the world, in m")
    rotation: Rotation = Field(ZEROS, description="rotation vector or matrix of its base frame")
    attachments: list[Whole] = Field(description="for each tip the platform's attachment, from 0")
    posture: Posture | None = Field(None, description="instead of the chain's")
