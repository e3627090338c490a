"""The command `parflex`."""

import sys
import time
import warnings
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape
from rich.table import Table

from parflex.app.commands import check, export, init, save_run, simulate, tell_run
from parflex.app.imports import ImportingCommand
from parflex.app.modes import modes
from parflex.app.modes_report import frequency_table
from parflex.app.respond import frf, lobes
from parflex.app.terminal import (
    Backend,
    ImageFormat,
    Out,
    check_format,
    check_writable,
    complaints,
    console,
    step,
)
from parflex.app.vibrate import vibrate
from parflex.app.viewing import report, view
from parflex.base.errors import InputError, PartialRun
from parflex.base.version import __version__

app = typer.Typer(
    invoke_without_command=True,
    add_completion=True,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
    help="Dynamics of parallel robots with flexible platforms.\n\n"
    "Start with `parflex paper`: it flies the robot of the paper and draws its figures; `parflex view` shows "
    "it moving in the browser. For a robot of your own, `parflex init`, then `parflex check` and "
    "`parflex simulate`.",
)
for command in (view, report, check, vibrate, frf, lobes, simulate, init, export):
    app.command()(command)
app.command(cls=ImportingCommand)(modes)


def version(wanted: bool) -> None:
    """Print the version and stop."""
    if wanted:
        console.print(f"parflex {__version__}")
        raise typer.Exit


FIRST = {
    "parflex paper": "fly the robot of the paper: 20 seconds, then figures and a result",
    "parflex view parflex-paper/result.nc": "see it move in the browser",
    "parflex init": "begin a robot of your own: robot.toml, with comments",
}


@app.callback()
def main(
    context: typer.Context,
    show: Annotated[
        bool, typer.Option("--version", callback=version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Dynamics of parallel robots with flexible platforms."""
    if context.invoked_subcommand is None:
        console.print(
            f"[bold]parflex {__version__}[/], dynamics of parallel robots with flexible platforms\n"
        )
        for line, words in FIRST.items():
            console.print(f"  [bold]{line}[/]\n      {words}")
        console.print(
            "\nAll commands: parflex --help. Completion in your shell: parflex --install-completion."
        )


@app.command()
def paper(
    out: Out = Path("parflex-paper"),
    modes: Annotated[int, typer.Option(help="Elastic modes of the plate; the paper has ten.")] = 10,
    rigid: Annotated[bool, typer.Option("--rigid", help="A rigid plate: no modes.")] = False,
    frequencies: Annotated[
        str, typer.Option(help='"converged" (computed) or "published" (Table 2; at most ten modes).')
    ] = "converged",
    undeformed: Annotated[
        bool, typer.Option("--undeformed", help="Start flat, not sagging under its own weight.")
    ] = False,
    backend: Backend = "auto",
    image: ImageFormat = "png",
) -> None:
    """Fly Section 6 of the paper and draw its figures.

    The modes of the hexagonal plate are computed, the Gough-Stewart robot is assembled, the
    inverse model drives it along a trajectory through three poses, the direct model is integrated,
    and Table 2 and Figs. 4-7 are drawn beside a picture of the bent robot.

    Examples:

    `parflex paper` - ten modes, as in the paper

    `parflex paper --modes 11 --out eleven` - a whole degenerate pair instead of half of one

    `parflex paper --rigid` - the same motion with a rigid plate
    """
    from parflex.app import paper as section
    from parflex.robots.gough_stewart import TABLE_2

    check_format(image)
    check_writable(out)
    start = time.perf_counter()
    done = section.run(
        0 if rigid else modes, frequencies, undeformed, backend, say=lambda words: step(start, words)
    )
    save_run(done.result, out, start)
    step(start, "drawing the figures")
    pictures = section.figures(done, out, image)
    if len(done.modes.frequencies):
        console.print(frequency_table(done.modes, TABLE_2))
    tell_run(done.result, pictures)


@app.command()
def doctor() -> None:
    """Show versions and the backend in use, and check it against NumPy.

    Run it first when something looks wrong, and add its output to a bug report.
    """
    from parflex.app.doctor import examine
    from parflex.base.versions import versions

    table = Table("package", "version", title=f"parflex {__version__}", title_justify="left")
    for name, number in versions().items():
        table.add_row(name, number)
    console.print(table)
    healthy = True
    for line in examine():
        healthy &= line.passed
        mark = "[green]pass[/]" if line.passed else "[red]FAIL[/]"
        console.print(f"{mark} {line.what}: {line.found}")
    if not healthy:
        raise typer.Exit(1)


def run() -> None:
    """Run the command: errors of input end in one sentence, without a traceback."""
    warnings.filterwarnings("ignore", message=".*cut a degenerate pair.*")  # printed as a note
    warnings.filterwarnings("ignore", category=PartialRun)  # told where the result is saved
    warnings.showwarning = lambda message, *_, **__: complaints.print(
        "[yellow]warning[/]", escape(str(message)), soft_wrap=True
    )
    try:
        app()
    except InputError as error:
        complaints.print("[red]error[/]", escape(str(error)), soft_wrap=True)
        sys.exit(2)
    except OSError as error:
        complaints.print("[red]error[/]", escape(f"{error.filename or 'file'}: {error.strerror or error}"))
        sys.exit(2)
