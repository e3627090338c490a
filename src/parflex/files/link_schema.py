"""The tables of flexible links that are no beams: the `body` of a joint in a robot file."""

from typing import Annotated, Literal

from pydantic import Discriminator, Field

from parflex.files.platform_schema import MaterialTable, ModalTable
from parflex.files.tables import ZEROS, Length, Number, Point, Ratios, Rotation, Table, Whole


class SolidLinkTable(MaterialTable):
    """A link of one material, from a STEP file or a mesh, whose modes are computed."""

    kind: Literal["solid"]
    file: str = Field(description="STEP file or mesh, relative to the robot file")
    unit: str | None = Field(None, description='of the file: "mm", "m", "inch"; STEP files name theirs')
    size: Length | None = Field(None, description="largest edge of elements; by default enough")
    frame: Point = Field(description="the joint frame's origin, a point of the part that is held there")
    rotation: Rotation = Field(ZEROS, description="of the joint's frame in the part's")
    interfaces: list[Point] = Field(description="the points of the part where next joints and tips sit")
    radius: Length | None = Field(None, description="of the patches held; by default the faces at the points")
    modes: Whole | None = Field(None, description="of the held part, beside its static shapes; by default 4")
    negligible: Number = Field(0.0, description="compliance that counts as none, of the largest")


class ImportedLinkTable(Table):
    """A link from the files of a finite-element program."""

    kind: Literal["imported"]
    program: str = Field(description='"nastran", "calculix", "calculix-matrices", "matrices" or "arrays"')
    files: dict[str, str] = Field(
        description="relative to the robot file, by the names of the program's reader"
    )
    units: str = Field(description='of the files: "SI", "mm-tonne-s", "in-lbf" or others')
    ids: list[list[Whole]] | None = Field(None, description="the frame's nodes, then those of each interface")
    frame: Point | None = Field(None, description="the joint frame's origin; by default its nodes' centre")
    rotation: Rotation = Field(ZEROS, description="of the joint's frame in the model's")
    interfaces: list[Point] | None = Field(None, description="points; by default the centres of their nodes")
    radius: Length | None = Field(None, description="of the patches of nodes around the points")
    modes: Whole | None = Field(None, description="to keep, by default all; of matrices to compute, 4")
    negligible: Number = Field(0.0, description="of matrices: compliance that counts as none, of the largest")
    damping_ratio: Ratios = Field(0.0, description="one for all modes, or one for each")


LinkTable = Annotated[ModalTable | SolidLinkTable | ImportedLinkTable, Discriminator("kind")]
