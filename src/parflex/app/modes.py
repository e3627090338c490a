"""The command `parflex modes`: from a polygon, a STEP file or a mesh to a platform's modal file."""

import time
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.markup import escape

from parflex.app.imports import Files, Nodes, Program, Units, named_files, node_ids
from parflex.app.modes_report import report
from parflex.app.terminal import ImageFormat, Out, check_format, check_writable, command_of, console, step
from parflex.base.errors import InputError

if TYPE_CHECKING:
    from parflex.fe import ComputedModes, Material
    from parflex.fe.sources import PlatformSource

Texts = list[str] | None
FORMS = {"--corner": "x,y", "--hole": "x,y,radius", "--attach": "x,y,z", "--tool": "x,y,z"}


@dataclass(frozen=True)
class Options:
    """The options of `parflex modes`."""

    source: Annotated[
        Path | None,
        typer.Argument(help="A STEP file (.step, .stp), or a mesh of tetrahedra that meshio reads."),
    ] = None
    corner: Annotated[
        Texts, typer.Option("--corner", "-c", help='Corner "x,y" of a plate, m; repeat it, in order around.')
    ] = None
    thickness: Annotated[float, typer.Option(help="Thickness of the plate, m.")] = 15e-3
    solid: Annotated[bool, typer.Option("--solid", help="Mesh the plate as a solid.")] = False
    hole: Annotated[Texts, typer.Option(help='Hole "x,y,radius" in the plate, m; it becomes a solid.')] = None
    young: Annotated[float, typer.Option(help="Young's modulus, N/m².")] = 2e10
    poisson: Annotated[float, typer.Option(help="Poisson's ratio.")] = 0.3
    density: Annotated[float, typer.Option(help="Density, kg/m³.")] = 7.5e3
    unit: Annotated[
        str | None,
        typer.Option(help='Unit of the file\'s numbers: "mm", "m", "inch"; STEP files name theirs.'),
    ] = None
    size: Annotated[float | None, typer.Option(help="Largest edge of a solid's elements, m.")] = None
    refine: Annotated[int | None, typer.Option(help="Halvings of a plate's mesh; by default enough.")] = None
    attach: Annotated[
        Texts,
        typer.Option(
            "--attach", "-a", help='Joint "x,y,z", m; repeat it. By default the corners of a plate.'
        ),
    ] = None
    tool: Annotated[str | None, typer.Option(help='Where wrenches act, "x,y,z", m.')] = None
    radius: Annotated[float | None, typer.Option(help="Radius of a joint's patch on a solid, m.")] = None
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
    def is_papers(self) -> bool:
        """True where nothing says what the body is: it is the plate of the paper."""
        return self.source is None and self.corner is None and not self.hole

    @property
    def joints(self) -> list[tuple[float, ...]]:
        """The places (k, 3) m where legs hold."""
        return [parsed("--attach", text) for text in self.attach or ()]


def run_modes(options: Options) -> None:
    """Compute a platform's modes: a check report, a table, a picture, and a modal file for robots.

    Without a source and corners it is the paper's hexagon with the paper's ten free-free modes. Anything
    else gets the smallest basis of free-free and attachment modes that is right to the tolerance.

    Examples:

    `parflex modes -c 0,0 -c 0.6,0 -c 0.6,0.4 -c 0,0.4 --thickness 0.01 --young 70e9 --poisson 0.33
    --density 2700`

    `parflex modes plate.step -a 0.2,0,0.01 -a -0.1,0.17,0.01 -a -0.1,-0.17,0.01 --tool 0,0,0.02`

    `parflex modes --from nastran --file op2=plate.op2 --file bulk=plate.dat --units in-lbf --node 1 --node 11
    --node 21`
    """
    start = time.perf_counter()
    check_options(options)
    if options.imports:
        step(start, "reading the files")
        found, material = imported_modes(options), None
    else:
        found, material = computed(options, start)
    report(found, material, published(options))
    save_modes(found, options, start)


modes = command_of("modes", Options, run_modes)


def check_options(options: Options) -> None:
    """Raise InputError for options that contradict one another, and where nothing can be written."""
    check_format(options.image)
    plate = options.corner or options.hole
    if options.source is not None and plate:
        raise InputError("--corner and --hole describe a plate; leave them out, or the file")
    if options.source is not None and not options.joints:
        raise InputError('--attach is not given; name the joints, --attach "x,y,z" for each, in metres')
    if options.imports and (options.source is not None or plate or options.tool or options.free):
        raise InputError("--from imports modes; leave out what describes a body or basis of parflex's own")
    check_writable(options.out)


def imported_modes(options: Options) -> "ComputedModes":
    """The modes of another program's files, held at nodes by number or at points."""
    from parflex.fe import import_modes

    held = (node_ids(options.node or []), options.joints or None, options.radius)
    return import_modes(
        options.program or "", named_files(options.file or []), options.units, options.modes, *held
    )


def computed(options: Options, start: float) -> "tuple[ComputedModes, Material]":
    """The modes of a plate, a STEP file or a mesh, and its material."""
    from parflex.fe import Material, with_mesh_error

    material = Material(options.young, options.poisson, options.density)
    outline = [parsed("--corner", text) for text in options.corner or ()] or paper_corners()
    holes = [parsed("--hole", text) for text in options.hole or ()]
    tool = None if options.tool is None else parsed("--tool", options.tool)
    step(start, "meshing")
    body = source(options, outline, holes, material)
    step(start, "computing the modes")
    is_solid = options.source is None and bool(options.solid or holes)
    joints = options.joints or ([(x, y, 0.0) for x, y in outline] if is_solid else None)
    free = options.free or (options.is_papers and not options.joints)
    found = body.modes(body.basis(options.modes, free, options.tolerance, joints, tool, options.radius))
    if body.coarse is not None:
        step(start, "comparing with a coarser mesh")
        found = with_mesh_error(found, body.coarse())
    return found, material


def source(options: Options, outline: Any, holes: Any, material: "Material") -> "PlatformSource":
    """The body that the options describe."""
    from parflex.fe import outline_mesh
    from parflex.fe.sources import file_source, plate_source, solid_source

    if options.source is not None:
        return file_source(options.source, options.unit, options.size, material)
    if options.solid or holes:
        return solid_source(partial(outline_mesh, outline, options.thickness, holes), options.size, material)
    return plate_source(outline, options.thickness, material, options.refine)


def save_modes(found: "ComputedModes", options: Options, start: float) -> None:
    """Write the modal file and the picture."""
    from parflex.fe import write_modes
    from parflex.views import plot

    origin = (0.0, 0.0, 0.0) if options.is_papers and not options.imports else None
    file = write_modes(found, options.out / "modes.h5", origin=origin, damping_ratio=options.damping)
    words = f'platform = {{ kind = "modal", file = "{file.name}" }}'
    console.print(
        f"[bold]{escape(str(file))}[/] holds the platform; in a robot file: {escape(words)}", soft_wrap=True
    )
    if len(found.frequencies) and len(found.triangles):
        step(start, "drawing the shapes")
        [picture] = plot.save({"modes": plot.mode_shapes(found)}, options.out, options.image)
        console.print(f"shapes drawn in [bold]{escape(str(picture))}[/]")


def parsed(option: str, text: str) -> tuple[float, ...]:
    """Coordinates from "x,y". Raises InputError for another text."""
    count = FORMS[option].count(",") + 1
    try:
        found = tuple(float(part) for part in text.split(","))
    except ValueError:
        found = ()
    if len(found) != count:
        raise InputError(
            f'{option} is {text!r}; write it as "{FORMS[option]}" in metres, like '
            f"{'0.5,0.2,0.1'[: 4 * count - 1]}"
        )
    return found


def published(options: Options) -> tuple[float, ...]:
    """The paper's Table 2, where the plate is the paper's."""
    from parflex.robots.gough_stewart import PLATE, TABLE_2

    same = not options.imports and options.is_papers and PLATE.items() <= asdict(options).items()
    return TABLE_2 if same else ()


def paper_corners() -> Any:
    """The corners of the paper's hexagon."""
    from parflex.robots.gough_stewart import corners

    return corners()
