"""The options of `parflex modes`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from parflex.app.imports import MATERIALS, Files, Nodes, Program, Units
from parflex.app.measures import coordinates
from parflex.app.terminal import ImageFormat, Out

Texts = list[str] | None
Text = str | None


@dataclass(frozen=True)
class Options:
    """The options of `parflex modes`."""

    source: Annotated[
        Path | None,
        typer.Argument(help="A STEP file (.step, .stp), or a mesh of tetrahedra that meshio reads."),
    ] = None
    corner: Annotated[
        Texts, typer.Option("--corner", "-c", help='Corner "x,y" of a plate; repeat it, in order around.')
    ] = None
    disc: Annotated[Text, typer.Option(help='Diameter of a disc, like "340 mm"; it is a solid.')] = None
    bore: Annotated[Text, typer.Option(help="Diameter of the hole in a disc's middle: a ring.")] = None
    thickness: Annotated[Text, typer.Option(help='Thickness of the plate or disc, like "20 mm".')] = None
    solid: Annotated[bool, typer.Option("--solid", help="Mesh the plate as a solid.")] = False
    hole: Annotated[Texts, typer.Option(help='Hole "x,y,radius" in the plate; it becomes a solid.')] = None
    material: Annotated[
        Text, typer.Option("--material", "-m", help=f"What it is made of: {MATERIALS}; or give:")
    ] = None
    young: Annotated[Text, typer.Option(help='Young\'s modulus, like "70 GPa".')] = None
    poisson: Annotated[float | None, typer.Option(help="Poisson's ratio.")] = None
    density: Annotated[Text, typer.Option(help='Density, like "2700 kg/m^3".')] = None
    unit: Annotated[
        Text,
        typer.Option(help='Unit of the file\'s numbers: "mm", "m", "inch"; STEP files name theirs.'),
    ] = None
    size: Annotated[Text, typer.Option(help="Largest edge of a solid's elements.")] = None
    refine: Annotated[int | None, typer.Option(help="Halvings of a plate's mesh; by default enough.")] = None
    attach: Annotated[
        Texts,
        typer.Option(
            "--attach",
            "-a",
            help='Joint "x,y,z", anywhere on the body; repeat it. By default the corners of a plate.',
        ),
    ] = None
    tool: Annotated[Text, typer.Option(help='Where wrenches act, "x,y,z".')] = None
    radius: Annotated[Text, typer.Option(help="Radius of a joint's patch on a solid.")] = None
    modes: Annotated[
        int | None, typer.Option(help="Free-free modes; by default as many as the tolerance needs.")
    ] = None
    free: Annotated[bool, typer.Option("--free", help="Free-free modes only, no attachment modes.")] = False
    tolerance: Annotated[float, typer.Option(help="Error of the basis, where --modes is not given.")] = 0.01
    program: Program = None
    file: Files = None
    units: Units = ""
    node: Nodes = None
    damping: Annotated[float, typer.Option(help="Damping ratio of all modes.")] = 0.0
    out: Out = Path("parflex-modes")
    image: ImageFormat = "png"

    @property
    def imports(self) -> bool:
        """True where the modes come from another program."""
        return self.program is not None or bool(self.file or self.units or self.node)

    @property
    def is_outline(self) -> bool:
        """True where options describe a plate or disc."""
        return bool(self.corner or self.hole or self.disc or self.bore or self.thickness)

    @property
    def made_of(self) -> dict[str, object]:
        """The options about the material that are given."""
        given = {"material": self.material, "young": self.young, "poisson": self.poisson}
        given["density"] = self.density
        return {name: value for name, value in given.items() if value is not None}

    @property
    def is_papers(self) -> bool:
        """True where nothing says what the body is: it is the plate of the paper."""
        return self.source is None and not (self.is_outline or self.made_of)

    @property
    def joints(self) -> list[tuple[float, ...]]:
        """The places (k, 3) m where legs hold."""
        return [coordinates("--attach", text) for text in self.attach or ()]
