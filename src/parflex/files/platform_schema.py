"""The tables of platforms in a robot file, one for each kind."""

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from parflex.base import kinds
from parflex.base.check import POSITIVE
from parflex.base.errors import InputError
from parflex.files.tables import (
    Inertia,
    Length,
    Measure,
    Moments3,
    Number,
    Point,
    Ratios,
    Seconds3x3,
    Table,
    Whole,
)
from parflex.robot.material import Material
from parflex.robot.materials import chosen, names

Corner = Annotated[list[Length], Field(min_length=2, max_length=2)]


class RigidTable(Table):
    """A rigid platform."""

    kind: Literal["rigid"]
    mass: Annotated[float, Measure(kinds.MASS, POSITIVE)] = Field(description="in kg")
    com: Point | None = Field(None, description="centre of mass; by default the frame's origin")
    inertia: Inertia | None = Field(None, description="about the centre of mass: XX YY ZZ XY XZ YZ")
    first_moment: Moments3 | None = Field(None, description="∫ r dm, with second_moment")
    second_moment: Seconds3x3 | None = Field(None, description="∫ r rᵀ dm, instead of inertia")
    attachments: list[Point] | None = Field(
        None, description="the points that legs may hold; of a hexapod by default its joints"
    )

    @model_validator(mode="after")
    def _one_way(self) -> "RigidTable":
        moments = (self.first_moment, self.second_moment)
        if (self.inertia is None) == (self.second_moment is None):
            raise InputError("needs inertia (about the centre of mass), or first_moment and second_moment")
        if (None in moments and any(moments)) or (any(moments) and self.com is not None):
            raise InputError("mixes two ways; give com and inertia, or first_moment and second_moment")
        return self


class MaterialTable(Table):
    """A body of one material, by name or by its numbers, whose modes are computed."""

    material: str | None = Field(None, description=f"{names()}; or young, poisson, density")
    young: Annotated[float, Measure(kinds.PRESSURE)] | None = Field(None, description="Young's modulus")
    poisson: Number | None = Field(None, description="Poisson's ratio")
    density: Annotated[float, Measure(kinds.DENSITY)] | None = Field(None, description="of the material")
    damping_ratio: Ratios = Field(0.0, description="one for all modes, or one for each")

    @property
    def made_of(self) -> Material:
        """The material; raises InputError where it is not told, or told twice."""
        return chosen(self.material, self.young, self.poisson, self.density)


class MadeTable(MaterialTable):
    """A platform of one material, whose modes are computed."""

    origin: Point | None = Field(None, description="the platform frame's origin; by default the centre")


class PolygonTable(MadeTable):
    """A flat plate of convex outline, whose modes are computed."""

    kind: Literal["polygon"]
    corners: list[Corner] = Field(description="[x, y] in order around the outline")
    thickness: Length
    modes: Whole | None = Field(
        None, description="free-free modes, 0 for a rigid plate; by default a basis right for the joints"
    )
    refine: Whole | None = Field(None, description="halvings of the mesh; by default enough")
    attachments: list[Corner] | None = Field(
        None, description="[x, y] anywhere on the plate; by default the corners"
    )


class ModalTable(Table):
    """A body stored by parflex, with its modes."""

    kind: Literal["modal"]
    file: str = Field(description="modal file, relative to the robot file")


class MeshedTable(MadeTable):
    """A solid of one material that is meshed."""

    size: Length | None = Field(None, description="largest edge of elements; by default enough")
    modes: Whole | None = Field(
        None, description="free-free modes beside attachment modes; by default as many as are right"
    )
    attachments: list[Point] | None = Field(
        None, description="points that legs may hold, patches of the surface; a hexapod has its joints there"
    )
    tool: Point | None = Field(None, description="a point where wrenches act")
    radius: Length | None = Field(None, description="of the patches")


class SolidTable(MeshedTable):
    """A solid of one material, from a STEP file or a mesh, whose modes are computed."""

    kind: Literal["solid"]
    file: str = Field(description="STEP file or mesh, relative to the robot file")
    unit: str | None = Field(None, description='of the file: "mm", "m", "inch"; STEP files name theirs')


class DiscTable(MeshedTable):
    """A disc or ring about the origin, its middle plane at z = 0, as a solid whose modes are computed."""

    kind: Literal["disc"]
    diameter: Length
    thickness: Length
    bore: Length | None = Field(None, description="diameter of the hole in its middle: a ring")


def one_or_patch(value: Any) -> str:
    """The tag of a place: one "node", or a "patch" of several."""
    return "patch" if isinstance(value, list) else "node"


Node = Annotated[
    Annotated[Whole, Tag("node")] | Annotated[list[Whole], Tag("patch")], Discriminator(one_or_patch)
]


class ImportedTable(Table):
    """A platform from the files of a finite-element program."""

    kind: Literal["imported"]
    program: str = Field(description='"nastran", "calculix", "calculix-matrices", "matrices" or "arrays"')
    files: dict[str, str] = Field(
        description="relative to the robot file, by the names of the program's reader"
    )
    units: str = Field(description='of the files: "SI", "mm-tonne-s", "in-lbf" or others')
    modes: Whole | None = Field(None, description="elastic modes to keep; by default all in the file")
    ids: list[Node] | None = Field(
        None, description="nodes that legs may hold, each a number or a list of them"
    )
    points: list[Point] | None = Field(None, description="or points, in the model's coordinates")
    radius: Length | None = Field(None, description="of the patches of nodes around the points")
    damping_ratio: Ratios = Field(0.0, description="one for all modes, or one for each")
    origin: Point | None = Field(
        None, description="the platform frame's origin; by default the centre of mass"
    )


PlatformTable = RigidTable | PolygonTable | DiscTable | SolidTable | ModalTable | ImportedTable
