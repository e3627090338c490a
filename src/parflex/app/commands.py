"""The commands for robots of one's own: init, check, simulate, export."""

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape
from rich.table import Table

from parflex.app.templates.starts import STARTS
from parflex.app.terminal import Backend, ImageFormat, Out, check_format, check_writable, console, step
from parflex.app.viewing import what_now
from parflex.base.errors import InputError

if TYPE_CHECKING:
    from parflex.mechanics.output import Output
    from parflex.simulation.laws.verdict import Verdict
    from parflex.simulation.result import Result

RobotPath = Annotated[Path, typer.Argument(help="A robot file (TOML).")]
RESULT = "result.nc"  # of a run, in its folder


def init(
    name: Annotated[Path, typer.Argument(help="The robot file to write.")] = Path("robot.toml"),
    robot: Annotated[str, typer.Option(help=f"What to start from: {', '.join(STARTS)}.")] = "gough-stewart",
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False,
) -> None:
    """Write a robot file and a trajectory file to start from, with comments that explain them.

    Examples:

    `parflex init` - robot.toml and robot.trajectory.toml

    `parflex init hexapod.toml --robot hexapod` - a hexapod from radii, angles and a strut

    `parflex init delta.toml --robot delta --force` - a robot of the gallery, over what is there
    """
    from parflex.app.templates import write_templates

    files = write_templates(name, robot, force)
    names = [escape(str(path)) for path in files]
    console.print(f"wrote {', '.join(names)}")
    console.print(f"now: parflex check {names[0]}")
    console.print(f"     parflex simulate {names[0]} --trajectory {names[1]}")
    console.print(f"     parflex vibrate {names[0]}")


def check(robot: RobotPath, out: Out = Path("parflex-check"), image: ImageFormat = "png") -> None:
    """Read a robot file, tell what was understood, and draw the robot at home.

    Example: `parflex check robot.toml`
    """
    from parflex.app import overview
    from parflex.files.robot_file import check_standing, read_robot
    from parflex.model.model import Model
    from parflex.views import plot
    from parflex.views.sketch import sketch

    check_format(image)
    file = read_robot(robot)
    console.print(f"[bold]{escape(file.table.name or robot.name)}[/] {escape(file.table.source)}")
    console.print(table_of(overview.LEG_HEADS, overview.leg_rows(file)))
    for line in overview.facts(file):
        console.print(line)
    check_standing(file)
    model = Model(file.robot, "numpy")
    console.print(table_of(overview.JOINT_HEADS, overview.joint_rows(model)))
    for line in (str(model.mobility(file.robot.home)), *overview.swings(model)):
        console.print(line)
    for choice, verdict in overview.controls(model):
        tell_control(choice.why, verdict)
    check_writable(out)
    drawn = plot.robot_at(sketch(model, file.robot.home), "home")
    [picture] = plot.save({robot.stem: drawn}, out, image)
    console.print(f"drawn in [bold]{escape(str(picture))}[/]")


def simulate(
    robot: RobotPath,
    trajectory: Annotated[Path, typer.Option(help="A trajectory file (TOML).")],
    out: Out = Path("parflex-simulate"),
    backend: Backend = "auto",
    image: ImageFormat = "png",
) -> None:
    """Fly a robot along a trajectory: the run as NetCDF-4, and pictures.

    The table [base] of the trajectory file names samples of a base that moves, such as a floor that shakes.

    Example: `parflex simulate robot.toml --trajectory robot.trajectory.toml --out run`
    """
    from parflex.app import flight
    from parflex.app.trajectory_file import read_plan
    from parflex.files.robot_file import check_standing, read_robot

    check_format(image)
    plan, file = read_plan(trajectory), read_robot(robot)
    check_standing(file)
    check_writable(out)
    start = time.perf_counter()
    prepared = flight.prepare(file, plan, backend, say=lambda words: step(start, words))
    tell_control(prepared.choice.why, prepared.verdict)
    for doubt in prepared.doubts:
        words = f"{trajectory.name}: {doubt}; shorten the moves, or correct stroke or units"
        console.print(f"[yellow]warning[/] {escape(words)}")
    done = flight.fly(prepared, say=lambda words: step(start, words))
    save_run(done.result, out, start)
    step(start, "drawing the pictures")
    tell_run(done.result, flight.figures(done, out, image))


def export(
    robot: RobotPath,
    c: Annotated[Path, typer.Option("--c", help="Folder for C99 code; made if it is not there.")],
    rows: Annotated[
        str,
        typer.Option(help='Components of the acceleration to be prescribed: "0,1,2", or "joints".'),
    ] = "",
    prefix: Annotated[str, typer.Option(help="What the names of all functions begin with.")] = "parflex",
    force: Annotated[bool, typer.Option("--force", help="Write beside files of others.")] = False,
) -> None:
    """Write the models as C99 for controllers: no allocation, a header, a self-test.

    Rows are 0, 1, 2 linear, 3, 4, 5 angular, in the platform's axes; all six by default. "joints" are the
    accelerations of the motors' joints, for robots whose legs bend.

    Examples:

    `parflex export robot.toml --c robot-c` - then `make -C robot-c` compiles and tests

    `parflex export delta.toml --c delta-c --rows 0,1,2` - a robot with three motors
    """
    from parflex.export.export import check_folder, export_c
    from parflex.files.robot_file import check_standing, read_robot

    output = output_of(rows)
    check_folder(c, force)
    file = read_robot(robot)
    check_standing(file)
    if not rows and file.robot.n_forces < 6:
        raise InputError(
            f"--rows is not given, and {robot.name} has {file.robot.n_forces} motors, too few for all six "
            f"components of the acceleration; name as many, 0, 1, 2 linear, 3, 4, 5 angular: --rows 0,1,2"
        )
    files = export_c(file.robot, c, output, prefix=prefix, force=force)
    console.print(f"wrote {', '.join(path.name for path in files)} to [bold]{escape(str(c))}[/]")
    console.print(f"now: make -C {escape(str(c))}")


def output_of(rows: str) -> "Output":
    """The output that the rows "0,1,2" name; all six where there are none, and the joints' of "joints"."""
    from parflex.mechanics.output import FrameOutput, JointOutput

    if rows == "joints":
        return JointOutput()
    try:
        return FrameOutput(tuple(int(part) for part in rows.split(","))) if rows else FrameOutput()
    except ValueError:
        words = (
            f"--rows is {rows!r}; name rows, each once, like 0,1,2: 0 … 2 linear, 3 … 5 angular, or joints"
        )
        raise InputError(words) from None


def table_of(heads: tuple[str, ...], rows: list[tuple[str, ...]]) -> Table:
    """Rows of words under their heads."""
    table = Table(*heads)
    for row in rows:
        table.add_row(*(escape(cell) for cell in row))
    return table


def tell_control(why: str, verdict: "Verdict | None") -> None:
    """Print why the default control was not taken, and what is to be expected of the one that was."""
    if why:
        console.print(f"[yellow]computed torque is the default here[/]: {escape(why)}")
    if verdict is not None:
        colour = "green" if verdict.stable else "bold red"
        console.print(f"[{colour}]verdict[/] {escape(str(verdict))}")


def save_run(result: "Result", out: Path, start: float) -> None:
    """Save a run, before its pictures are drawn."""
    step(start, "saving the result")
    result.save(out / RESULT)
    if result.partial:
        console.print(f"[yellow]stopped {escape(result.stopped)}[/]; the result is partial")


def tell_run(result: "Result", pictures: list[Path]) -> None:
    """Print the numbers that a run is judged by, and where it is; a partial one ends the command with an
    error code."""
    console.print(summary(result))
    for name in ("notes", "beyond_limits"):
        for note in str(result.dataset.attrs.get(name, "")).splitlines():
            console.print(f"[yellow]note[/] {escape(note)}")
    out, names = pictures[0].parent, ", ".join(path.name for path in pictures)
    console.print(
        f"[bold]{escape(str(out / RESULT))}[/] holds the run (NetCDF-4: xarray, MATLAB); "
        f"pictures in {escape(str(out))}: {names}"
    )
    what_now(out / RESULT)
    if result.partial:
        raise typer.Exit(130 if "interrupted" in result.stopped else 1)


def summary(result: "Result") -> Table:
    """The numbers by which a run is judged."""
    from parflex.simulation.summary import figures_of

    table = Table("check", "value", title="The run", title_justify="left")
    for fact in figures_of(result.dataset):
        table.add_row(fact.name, f"{fact.value:.4g} {fact.unit}")
    return table
