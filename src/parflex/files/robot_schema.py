"""The tables of a robot file, format "parflex-robot-1"."""

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, Tag, WithJsonSchema, model_validator

from parflex.errors import InputError
from parflex.files import quantity
from parflex.files.tables import (
    THREE,
    Angle,
    Inertia,
    Length,
    Mass,
    Measure,
    Moments3,
    Number,
    Point,
    Rotation,
    Seconds3x3,
    Table,
    Whole,
)

FORMAT = "parflex-robot-1"

Posture = Annotated[
    list[Any],
    WithJsonSchema({"type": "array", "items": {"anyOf": [{"type": "number"}, {"type": "string"}]}}),
]
StrictBool = Annotated[bool, Field(strict=True)]
UPRIGHT = [0.0, 0.0, 0.0]


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
    offset: Point = Field(UPRIGHT, description="where on the link, in its frame")


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
    rotation: Rotation = Field(UPRIGHT, description="rotation vector or matrix of its base frame")
    attachments: list[Whole] = Field(description="for each tip the platform's attachment, from 0")
    posture: Posture | None = Field(None, description="instead of the chain's")


class HomeTable(Table):
    """Where the platform stands when nothing else is said."""

    position: Point = Field(description="the platform frame's origin in the world, in m")
    rotation: Rotation = Field(UPRIGHT, description="rotation vector or matrix")


class RigidTable(Table):
    """A rigid platform."""

    kind: Literal["rigid"]
    mass: Annotated[float, Measure(quantity.MASS, negative=False, zero=False)] = Field(description="in kg")
    com: Point | None = Field(None, description="centre of mass; by default the frame's origin")
    inertia: Inertia | None = Field(None, description="about the centre of mass: XX YY ZZ XY XZ YZ")
    first_moment: Moments3 | None = Field(None, description="∫ r dm, with second_moment")
    second_moment: Seconds3x3 | None = Field(None, description="∫ r rᵀ dm, instead of inertia")
    attachments: list[Point] = Field(description="the points that legs may hold")

    @model_validator(mode="after")
    def _one_way(self) -> "RigidTable":
        moments = (self.first_moment, self.second_moment)
        if (self.inertia is None) == (self.second_moment is None):
            raise InputError("needs inertia (about the centre of mass), or first_moment and second_moment")
        if (None in moments and any(moments)) or (any(moments) and self.com is not None):
            raise InputError("mixes two ways; give com and inertia, or first_moment and second_moment")
        return self


Acceleration = Annotated[float, Measure(quantity.ACCELERATION)]
Corner = Annotated[list[Length], Field(min_length=2, max_length=2)]
Ratios = Annotated[
    Annotated[Number, Tag("one")] | Annotated[list[Number], Tag("each")],
    Discriminator(lambda value: "each" if isinstance(value, list) else "one"),
]


class PolygonTable(Table):
    """A flat plate of convex outline, whose modes are computed."""

    kind: Literal["polygon"]
    corners: list[Corner] = Field(description="[x, y] in order around the outline")
    thickness: Length
    young: Annotated[float, Measure(quantity.PRESSURE)] = Field(description="Young's modulus")
    poisson: Number = Field(description="Poisson's ratio")
    density: Annotated[float, Measure(quantity.DENSITY)]
    modes: Whole = Field(description="elastic modes to keep; 0 is a rigid plate")
    refine: Whole | None = Field(None, description="halvings of the mesh; by default enough")
    damping_ratio: Ratios = Field(0.0, description="one for all modes, or one for each")
    attachments: list[Corner] | None = Field(None, description="[x, y] of nodes; by default the corners")
    origin: Point | None = Field(None, description="the platform frame's origin; by default the centre")


class ModalTable(Table):
    """A platform stored by parflex, with its modes."""

    kind: Literal["modal"]
    file: str = Field(description="NetCDF file, relative to the robot file")


class RobotTable(Table):
    """A robot: a fixed base, legs, a platform."""

    format: Literal["parflex-robot-1"]
    name: str = ""
    source: str = Field("", description="where the numbers are from")
    gravity: Annotated[list[Acceleration], THREE] = Field([0.0, 0.0, -9.81], description="in the world")
    mobility: Whole | None = Field(None, description="the platform's freedoms that you expect")
    home: HomeTable = Field(description="the table [home] with position and rotation")
    chain: dict[str, ChainTable] = Field({}, description="chains by name")
    leg: list[LegTable] = Field([], description="legs, one [[leg]] each")
    platform: RigidTable | PolygonTable | ModalTable = Field(
        discriminator="kind", description="the table [platform]"
    )
