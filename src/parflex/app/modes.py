"""The command `parflex modes`: from a polygon, a STEP file or a mesh to a platform's modal file."""

import time
from collections.abc import Callable
from functools import partial
from math import isnan, pi
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import typer
from rich.markup import escape
from rich.table import Table

from parflex.app.imports import Files, Nodes, Program, Units, imported
from parflex.app.terminal import ImageFormat, Out, check_format, check_writable, console, step
from parflex.base.errors import InputError

COARSER = 1.5  # a mesh to compare with


def modes(
    source: Annotated[
        Path | None,
        typer.Argument(help="A STEP file (.step, .stp), or a mesh of tetrahedra that meshio reads."),
    ] = None,
    corner: Annotated[
        list[str] | None,
        typer.Option("--corner", "-c", help='Corner "x,y" of a plate, m; repeat it, in order around.'),
    ] = None,
    thickness: Annotated[float, typer.Option(help="Thickness of the plate, m.")] = 15e-3,
    solid: Annotated[bool, typer.Option("--solid", help="Mesh the plate as a solid.")] = False,
    hole: Annotated[
        list[str] | None, typer.Option(help='Hole "x,y,radius" in the plate, m; it becomes a solid.')
    ] = None,
    young: Annotated[float, typer.Option(help="Young's modulus, N/m².")] = 2e10,
    poisson: Annotated[float, typer.Option(help="Poisson's ratio.")] = 0.3,
    density: Annotated[float, typer.Option(help="Density, kg/m³.")] = 7.5e3,
    unit: Annotated[
        str | None,
        typer.Option(help='Unit of the file\'s numbers: "mm", "m", "inch"; STEP files name theirs.'),
    ] = None,
    size: Annotated[float | None, typer.Option(help="Largest edge of a solid's elements, m.")] = None,
    refine: Annotated[int | None, typer.Option(help="Halvings of a plate's mesh; by default enough.")] = None,
    attach: Annotated[
        list[str] | None,
        typer.Option(
            "--attach", "-a", help='Joint "x,y,z", m; repeat it. By default the corners of a plate.'
        ),
    ] = None,
    tool: Annotated[str | None, typer.Option(help='Where wrenches act, "x,y,z", m.')] = None,
    radius: Annotated[float | None, typer.Option(help="Radius of a joint's patch on a solid, m.")] = None,
    count: Annotated[
        int | None,
        typer.Option("--modes", help="Free-free modes; by default as many as the tolerance needs."),
    ] = None,
    free: Annotated[bool, typer.Option("--free", help="Free-free modes only, no attachment modes.")] = False,
    tolerance: Annotated[float, typer.Option(help="Of the basis, where --modes is not given.")] = 0.01,
    program: Program = None,
    file: Files = None,
    units: Units = "",
    node: Nodes = None,
    damping: Annotated[float, typer.Option(help="Damping ratio of all modes.")] = 0.0,
    out: Out = Path("parflex-modes"),
    image: ImageFormat = "png",
) -> None:
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
    from parflex.fe import FreeFree, FreeFreeWithAttachment, outline_mesh, with_mesh_error

    check_format(image)
    material = {"young": young, "poisson": poisson, "density": density}
    joints = [numbers("--attach", text, 3) for text in attach or ()]
    places: dict[str, Any] = {"radius": radius, "tool": None if tool is None else numbers("--tool", tool, 3)}
    outline = paper_corners() if corner is None else [numbers("--corner", text, 2) for text in corner]
    holes = [numbers("--hole", text, 3) for text in hole or ()]
    paper = source is None and corner is None and not holes
    if source is not None and (corner or holes):
        raise InputError("--corner and --hole describe a plate; leave them out, or the file")
    if source is not None and not joints:
        raise InputError('--attach is not given; name the joints, --attach "x,y,z" for each, in metres')
    check_writable(out)
    start = time.perf_counter()
    if program is not None or file or units or node:
        if source is not None or corner or holes or tool or free:
            raise InputError(
                "--from imports modes; leave out what describes a body or basis of parflex's own"
            )
        step(start, "reading the files")
        found = imported(program, file or [], units, count, node or [], joints, radius)
        finish(found, (), out, None, damping, image, start)
        return
    step(start, "meshing")
    if source is not None:
        subject = of_file(source, unit, size, material)
    elif solid or holes:
        subject = of_solid(partial(outline_mesh, outline, thickness, holes), size, material)
    else:
        subject = of_plate(outline, thickness, material, refine)
    places["points"] = joints or ([(x, y, 0.0) for x, y in outline] if solid or holes else None)
    step(start, "computing the modes")
    if free or (paper and not joints):
        found = subject.modes(FreeFree(10 if count is None else count, **places))
    elif count is not None:
        found = subject.modes(FreeFreeWithAttachment(count, **places))
    else:
        first = subject.modes(FreeFreeWithAttachment(1, **places))
        found = subject.modes(first.converged(tolerance).reduction.basis)
    if subject.coarse is not None:
        step(start, "comparing with a coarser mesh")
        found = with_mesh_error(found, subject.coarse())
    origin = (0.0, 0.0, 0.0) if paper else None
    finish(found, published(paper, thickness, material), out, origin, damping, image, start)


def finish(
    found: Any,
    table_2: tuple[float, ...],
    out: Path,
    origin: tuple[float, ...] | None,
    damping: float,
    image: str,
    start: float,
) -> None:
    """The report, the modal file, the picture."""
    from parflex.fe.modal_file import write_modes
    from parflex.views import plot

    report(found, table_2)
    file = write_modes(found, out / "modes.h5", origin=origin, damping_ratio=damping)
    words = f'platform = {{ kind = "modal", file = "{file.name}" }}'
    console.print(
        f"[bold]{escape(str(file))}[/] holds the platform; in a robot file: {escape(words)}", soft_wrap=True
    )
    if len(found.frequencies) and len(found.triangles):
        step(start, "drawing the shapes")
        [picture] = plot.save({"modes": plot.mode_shapes(found)}, out, image)
        console.print(f"shapes drawn in [bold]{escape(str(picture))}[/]")


class Subject(NamedTuple):
    """What modes are computed of: those of a basis, and the same body of larger elements, if there is one."""

    modes: Callable[[Any], Any]
    coarse: Callable[[], Any] | None


def of_file(source: Path, unit: str | None, size: float | None, material: dict[str, float]) -> Subject:
    """A STEP file, or a mesh, which has no coarser one."""
    from parflex.fe import Material, mesh_from, solid_body, step_mesh

    if source.suffix.lower() in (".step", ".stp"):
        return of_solid(partial(step_mesh, source, unit=unit), size, material)
    body = solid_body(mesh_from(source, unit, size), Material(**material))
    return Subject(lambda basis: basis.modes(body), None)


def of_solid(mesh_of: Callable[..., Any], size: float | None, material: dict[str, float]) -> Subject:
    """What Netgen meshes."""
    from parflex.fe import Material, solid_body

    mesh, made_of = mesh_of(size=size), Material(**material)
    body = solid_body(mesh, made_of)
    return Subject(
        lambda basis: basis.modes(body), lambda: solid_body(mesh_of(size=COARSER * mesh.size), made_of)
    )


def of_plate(outline: Any, thickness: float, material: dict[str, float], refine: int | None) -> Subject:
    """A thin plate, which brings the change from a coarser mesh itself."""
    from parflex.fe import plate_modes

    return Subject(
        lambda basis: plate_modes(outline, thickness, **material, n_modes=basis, refine=refine), None
    )


def numbers(option: str, text: str, count: int) -> tuple[float, ...]:
    """Coordinates from "x,y"."""
    try:
        found = tuple(float(part) for part in text.split(","))
    except ValueError:
        found = ()
    if len(found) != count:
        shape = "x,y,z" if count == 3 else "x,y"
        shape = "x,y,radius" if option == "--hole" else shape
        raise InputError(
            f'{option} is {text!r}; write it as "{shape}" in metres, like {"0.5,0.2,0.1"[: 4 * count - 1]}'
        )
    return found


def report(found: Any, table_2: tuple[float, ...]) -> None:
    """Frequencies, notes, and the check report."""
    from parflex.fe import check_rows

    console.print(frequency_table(found, table_2))
    for note in found.notes:
        console.print(f"[yellow]note[/] {escape(note)}")
    table = Table("check", "found", title=escape(found.source), title_justify="left")
    for row in check_rows(found):
        table.add_row(*map(escape, row))
    console.print(table)


def published(paper: bool, thickness: float, material: dict[str, float]) -> tuple[float, ...]:
    """Table 2, where the plate is the paper's."""
    from parflex.robots.gough_stewart import PLATE, TABLE_2

    return TABLE_2 if paper and {"thickness": thickness, **material} == PLATE else ()


def paper_corners() -> Any:
    """Of the paper's hexagon."""
    from parflex.robots.gough_stewart import corners

    return corners()


def frequency_table(found: Any, table_2: tuple[float, ...]) -> Table:
    """Frequencies, their estimated error, and the published ones where there are any."""
    heads = ["mode", "rad/s", "Hz", "change from coarser mesh"]
    table = Table(*heads, *(["Table 2", "difference"] if table_2 else []), title="Elastic modes")
    for k, omega in enumerate(found.frequencies):
        error = found.frequency_error[k]
        change = "unknown" if isnan(error) else f"{100 * error:.3f} %"
        row = [f"{k + 1}", f"{omega:.3f}", f"{omega / (2 * pi):.3f}", change]
        if k < len(table_2):
            row += [f"{table_2[k]:.3f}", f"{100 * (omega / table_2[k] - 1):+.2f} %"]
        table.add_row(*row)
    return table
