"""The commands that show a result to others: view and report."""

import webbrowser
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from parflex.app.terminal import console


def what_now(saved: Path) -> None:
    """Print what to do with a result that was just saved."""
    path = escape(str(saved))
    console.print(f"see it move:  parflex view {path}", soft_wrap=True)
    console.print(f"write it up:  parflex report {path}", soft_wrap=True)


ResultPath = Annotated[Path, typer.Argument(help="A result (NetCDF-4) that a simulation saved.")]


def view(
    result: ResultPath,
    export: Annotated[
        Path | None,
        typer.Option(help="Write one HTML file that plays offline, instead of opening a browser."),
    ] = None,
    modes: Annotated[
        Path | None, typer.Option(help="The modal file of a solid platform: colours by von Mises stress.")
    ] = None,
    curves: Annotated[bool, typer.Option(help="The figures of the run beside the robot.")] = True,
    browser: Annotated[bool, typer.Option(help="Open the browser.")] = True,
    port: Annotated[int, typer.Option(help="Where to serve the page; 0 is any free port.")] = 0,
) -> None:
    """Show the moving robot of a result in the browser: turn it, slow it, look at its modes.

    The page follows the file: simulate again, and it shows the new run.

    Examples:

    `parflex view parflex-paper/result.nc`

    `parflex view run/result.nc --export robot.html` - a file to send to others
    """
    from parflex.base.progress import waiting

    if export is not None:
        from parflex.views.viewer import view as page

        with waiting("writing the page"):
            written = page(result, curves=curves, modes=modes).save(export)
        size = written.stat().st_size / 1e6
        console.print(
            f"wrote [bold]{escape(str(written))}[/] ({size:.1f} MB); open it in any browser, offline too"
        )
        return
    serve(result, curves, modes, browser, port)


def report(
    result: ResultPath,
    out: Annotated[Path | None, typer.Option(help="The HTML file; report.html beside the result.")] = None,
) -> None:
    """Write what was simulated as one HTML file to send: modes, figures, energies, checks, the robot file.

    Example: `parflex report parflex-paper/result.nc`
    """
    from parflex.base.progress import waiting
    from parflex.base.writing import replacing
    from parflex.views.report import report_of

    target = result.with_name("report.html") if out is None else out
    with waiting("writing the report"):
        text = report_of(result)
        with replacing(target) as part:
            part.write(text.encode())
    console.print(f"wrote [bold]{escape(str(target))}[/] ({len(text) / 1e6:.1f} MB); it needs nothing else")


def serve(result: Path, curves: bool, modes: Path | None, browser: bool, port: int) -> None:
    """Serve the live page until Ctrl-C."""
    from parflex.base.progress import waiting
    from parflex.views.viewer.server import server_of

    with waiting("making the page"):
        server = server_of(result, port, curves, modes)
    address = f"http://127.0.0.1:{server.server_port}/"
    console.print(f"the robot is at [bold]{address}[/]; Ctrl-C ends", soft_wrap=True)
    if browser:
        webbrowser.open(address)
    try:
        server.serve_forever()
    except KeyboardInterrupt:
        console.print("ended")
    finally:
        server.server_close()
