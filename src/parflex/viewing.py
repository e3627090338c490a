"""The commands that show a result to others: view and report."""

import webbrowser
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from parflex.terminal import console

ResultPath = Annotated[Path, typer.Argument(help="A result (NetCDF-4) that a simulation saved.")]


def view(
    result: ResultPath,
    export: Annotated[
        Path | None,
        typer.Option(help="Write one HTML file that plays offline, instead of opening a browser."),
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
    from parflex.progress import waiting

    if export is not None:
        from parflex.viewer import view as page

        with waiting("writing the page"):
            written = page(result, curves).save(export)
        size = written.stat().st_size / 1e6
        console.print(
            f"wrote [bold]{escape(str(written))}[/] ({size:.1f} MB); open it in any browser, offline too"
        )
        return
    serve(result, curves, browser, port)


def serve(result: Path, curves: bool, browser: bool, port: int) -> None:
    """The live page, until Ctrl-C."""
    from parflex.progress import waiting
    from parflex.viewer.server import server_of

    with waiting("making the page"):
        server = server_of(result, port, curves)
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
