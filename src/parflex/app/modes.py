"""The command `parflex modes`: from a polygon, a disc, a STEP file or a mesh to a platform's modal file."""

import time
from functools import partial
from typing import TYPE_CHECKING, Any

from rich.markup import escape

from parflex.app.imports import named_files, node_ids
from parflex.app.measures import coordinates, measured
from parflex.app.modes_options import Options
from parflex.app.modes_report import report
from parflex.app.terminal import check_format, check_writable, command_of, console, step
from parflex.base import kinds
from parflex.base.absent import absent
from parflex.base.errors import InputError

if TYPE_CHECKING:
    from parflex.fe import ComputedModes, Material
    from parflex.fe.sources import PlatformSource


def run_modes(options: Options) -> None:
    """Compute a platform's modes: a check report, a table, a picture, and a modal file for robots.

    Without a source, corners or a disc it is the paper's hexagon with the paper's ten free-free modes.
    Anything else needs a material, and gets the smallest basis of free-free and attachment modes that is
    right to the tolerance. Numbers are in SI units, or carry their own: 0.02, "20 mm", "70 GPa".

    Examples:

    `parflex modes -c 0,0 -c 0.6,0 -c 0.6,0.4 -c 0,0.4 --thickness "10 mm" --material aluminium`

    `parflex modes plate.step -m steel -a 0.2,0,0.01 -a -0.1,0.17,0.01 -a -0.1,-0.17,0.01 --tool 0,0,0.02`

    `parflex modes --disc "340 mm" --thickness "20 mm" -m aluminium -a "150 mm,0,0" -a "-75 mm,130 mm,0"
    -a "-75 mm,-130 mm,0"`

    `parflex modes --from nastran --file op2=plate.op2 --file bulk=plate.dat --units in-lbf --node 1 --node 11
    --node 21`
    """
    start = time.perf_counter()
    check_options(options)
    if options.imports:
        step(start, "reading the files")
        found = imported_modes(options)
    else:
        found = computed(options, start)
    report(found, published(options))
    save_modes(found, options, start)


modes = command_of("modes", Options, run_modes)


def check_options(options: Options) -> None:
    """Raise InputError for options that contradict one another or lack something, and where nothing can be
    read or written."""
    check_format(options.image)
    described = options.is_outline or options.made_of
    if options.source is not None and (options.is_outline or options.solid):
        raise InputError(
            "--corner, --disc, --hole and --thickness describe a plate; leave them out, or the file"
        )
    if options.source is not None and not options.source.exists():
        raise InputError(absent(options.source))
    if options.corner and options.disc:
        raise InputError("--corner and --disc are both given; a plate has one outline")
    if options.bore and not options.disc:
        raise InputError('--bore is given without --disc; a hole in a plate is --hole "x,y,radius"')
    if options.imports and (options.source is not None or described or options.tool or options.free):
        raise InputError("--from imports modes; leave out what describes a body or basis of parflex's own")
    if described and not (options.source or options.corner or options.disc):
        raise InputError(
            "neither a file nor --corner or --disc is given, and the paper's plate has its own thickness and "
            "material; give an outline or a file, or leave out what describes a plate"
        )
    if (options.source or options.disc) and not options.joints:
        material(options)  # the names of those there are come first
        raise InputError('--attach is not given; name the joints, --attach "x,y,z" for each')
    check_writable(options.out)


def imported_modes(options: Options) -> "ComputedModes":
    """The modes of another program's files, held at nodes by number or at points."""
    from parflex.fe import import_modes

    held = (node_ids(options.node or []), options.joints or None, length(options, "radius"))
    return import_modes(
        options.program or "", named_files(options.file or []), options.units, options.modes, *held
    )


def computed(options: Options, start: float) -> "ComputedModes":
    """The modes of a plate, a disc, a STEP file or a mesh."""
    from parflex.fe import with_mesh_error

    tool = None if options.tool is None else coordinates("--tool", options.tool)
    outline, holes = outlines(options)
    is_solid = options.source is None and bool(options.solid or holes or options.disc)
    joints = options.joints or ([(x, y, 0.0) for x, y in outline] if is_solid else None)
    made_of, radius = material(options), length(options, "radius")
    step(start, "meshing")
    body = source(options, outline, holes, made_of, tool)
    step(start, "computing the modes")
    free = options.free or (options.is_papers and not options.joints)
    found = body.modes(body.basis(options.modes, free, options.tolerance, joints, tool, radius))
    if body.coarse is not None:
        step(start, "comparing with a coarser mesh")
        found = with_mesh_error(found, body.coarse())
    return found


def material(options: Options) -> "Material":
    """The material that the options name; the paper's for the paper's plate."""
    from parflex.robot.materials import chosen
    from parflex.robots.gough_stewart import PLATE

    if options.is_papers:
        return chosen(**{name: PLATE[name] for name in ("young", "poisson", "density")})
    young, density = options.young, options.density
    return chosen(
        options.material,
        None if young is None else measured("--young", young, kinds.PRESSURE),
        options.poisson,
        None if density is None else measured("--density", density, kinds.DENSITY),
        mark="--",
    )


def length(options: Options, name: str) -> float | None:
    """An option that is a length, m; None where it is not given."""
    text = getattr(options, name)
    return None if text is None else measured(f"--{name}", text, kinds.LENGTH)


def outlines(options: Options) -> tuple[Any, list[Any]]:
    """The outline of a plate, corners (n, 2) m or a circle (x, y, radius), and its holes."""
    from parflex.robots.gough_stewart import corners

    holes: list[Any] = [coordinates("--hole", text) for text in options.hole or ()]
    diameter, bore = length(options, "disc"), length(options, "bore")
    if diameter is None:
        return [coordinates("--corner", text) for text in options.corner or ()] or corners(), holes
    return (0.0, 0.0, diameter / 2), [*holes, *([] if bore is None else [(0.0, 0.0, bore / 2)])]


def source(options: Options, outline: Any, holes: Any, made_of: "Material", tool: Any) -> "PlatformSource":
    """The body that the options describe."""
    from parflex.fe import outline_mesh
    from parflex.fe.sources import file_source, plate_source, solid_source
    from parflex.robots.gough_stewart import PLATE

    size = length(options, "size")
    if options.source is not None:
        return file_source(options.source, options.unit, size, made_of)
    thickness = PLATE["thickness"] if options.is_papers else length(options, "thickness")
    if thickness is None:
        raise InputError('--thickness is not given; say how thick the plate is, like --thickness "20 mm"')
    if options.solid or holes or options.disc:
        return solid_source(partial(outline_mesh, outline, thickness, holes), size, made_of)
    return plate_source(outline, thickness, made_of, options.refine, options.joints or None, tool)


def save_modes(found: "ComputedModes", options: Options, start: float) -> None:
    """Write the modal file and the picture."""
    from parflex.fe import write_modes
    from parflex.views import plot

    centred = options.disc or (options.is_papers and not options.imports)
    origin = (0.0, 0.0, 0.0) if centred else None
    file = write_modes(found, options.out / "modes.h5", origin=origin, damping_ratio=options.damping)
    words = f'platform = {{ kind = "modal", file = "{file.as_posix()}" }}'
    console.print(
        f"[bold]{escape(str(file))}[/] holds the platform; in a robot file here: {escape(words)}",
        soft_wrap=True,
    )
    if len(found.frequencies) and len(found.triangles):
        step(start, "drawing the shapes")
        [picture] = plot.save({"modes": plot.mode_shapes(found)}, options.out, options.image)
        console.print(f"shapes drawn in [bold]{escape(str(picture))}[/]")


def published(options: Options) -> tuple[float, ...]:
    """The paper's Table 2, where the plate is the paper's."""
    from parflex.robots.gough_stewart import TABLE_2

    return TABLE_2 if options.is_papers and not options.imports else ()
