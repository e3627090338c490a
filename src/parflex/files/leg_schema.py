"""The tables of legs in a robot file: joints, tips, chains, legs."""

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, WithJsonSchema, model_validator

from parflex.base.errors import InputError
from parflex.files import quantity
from parflex.files.tables import (
    ZEROS,
    Angle,
    Inertia,
    Length,
    Mass,
    Measure,
    Moments3,
    Point,
    Rotation,
    Table,
    Whole,
)

Posture = Annotated[
    list[Any],
    WithJsonSchema({"type": "array", "items": {"anyOf": [{"type": "number"}, {"type": "string"}]}}),
]
StrictBool = Annotated[bool, Field(strict=True)]


class JointTable(Table):
    """A joint and the link it carries, in modified Denavit-Hartenberg parameters."""

    actuated: StrictBool = Field(False, description="whether a motor drives it")
    antecedent: Whole | None = Field(None, description="joint before it, from 1; 0 is the base")
    gamma: Angle = Field(0.0, description="angle about the antecedent's z, to its common normal")
    b: Length = Field(0.0, description="offset along the antecedent's z")
    alpha: Angle = Field(0.0, description="angle between the joints' axes, about x")
    d: Length = Field(0.0, description="distance between the joints' axes, along x")
    theta: Angle = Field(0.0, description="angle about the joint's z; a revolute joint adds to it")
    r: Length = Field(0.0, description="distance along the joint's z; a prismatic joint adds to it")
    mass: Mass = Field(0.0, description="mass of the link")
    com: Point | None = Field(None, description="centre of mass in the link's frame")
    first_moment: Moments3 | None = Field(None, description="mass times centre of mass, instead of com")
    inertia: Inertia = Field([0.0] * 6, description="about the link frame's origin: XX YY ZZ XY XZ YZ")

    @model_validator(mode="after")
    def _one_centre(self) -> "JointTable":
        if self.com is not None and self.first_moment is not None:
            raise InputError("gives com and first_moment; keep one of them")
        return self


class Revolute(JointTable):
    """A joint that turns about z."""

    sigma: ClassVar[int] = 0
    measure: ClassVar[quantity.Kind] = quantity.ANGLE
    type: Literal["revolute"]
    rotor_inertia: Annotated[float, Measure(quantity.INERTIA, negative=False)] = 0.0
    viscous: Annotated[float, Measure(quantity.ANGULAR_DAMPING, negative=False)] = 0.0
    coulomb: Annotated[float, Measure(quantity.TORQUE, negative=False)] = 0.0
    coulomb_rate: Annotated[float, Measure(quantity.TURN_RATE, negative=False, zero=False)] = 1e-3
    stiffness: Annotated[float, Measure(quantity.ANGULAR_STIFFNESS, negative=False)] = 0.0
    rest: Angle = 0.0
    min: Angle | None = None
    max: Angle | None = None


class Prismatic(JointTable):
    """A joint that slides along z."""

    sigma: ClassVar[int] = 1
    measure: ClassVar[quantity.Kind] = quantity.LENGTH
    type: Literal["prismatic"]
    rotor_inertia: Annotated[float, Measure(quantity.MASS, negative=False)] = 0.0
    viscous: Annotated[float, Measure(quantity.LINEAR_DAMPING, negative=False)] = 0.0
    coulomb: Annotated[float, Measure(quantity.FORCE, negative=False)] = 0.0
    coulomb_rate: Annotated[float, Measure(quantity.SPEED, negative=False, zero=False)] = 1e-3
    stiffness: Annotated[float, Measure(quantity.LINEAR_STIFFNESS, negative=False)] = 0.0
    rest: Length = 0.0
    min: Length | None = None
    max: Length | None = None


AnyJoint = Revolute | Prismatic


class TipTable(Table):
    """A point of a link that holds the platform by a spherical joint."""

    frame: Annotated[int, Field(strict=True, ge=1)] = Field(description="the link it is on, from 1")
    offset: Point = Field(ZEROS, description="where on the link, in its frame")


class ChainTable(Table):
    """A kind of leg: what several legs have in common."""

    joints: list[Annotated[AnyJoint, Field(discriminator="type")]] = Field(
        min_length=1, description="the joints in order, each with its type"
    )
    tips: list[TipTable] = Field(min_length=1, description="where it holds the platform")
    posture: Posture | None = Field(None, description="joint values near which the legs work")


class LegTable(Table):
    """A leg: a chain placed on the base."""

    chain: str = Field(description="the name of one of the chains")
    origin: Point = Field(description="the leg's base point in the world, in m")
    rotation: Rotation = Field(ZEROS, description="rotation vector or matrix of its base frame")
    attachments: list[Whole] = Field(description="for each tip the platform's attachment, from 0")
    posture: Posture | None = Field(None, description="instead of the chain's")
