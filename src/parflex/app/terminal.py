"""The console, options, and checks before any work, which the commands share."""

import inspect
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, get_type_hints

import typer
from rich.console import Console

from parflex.base.errors import InputError

console = Console()
complaints = Console(stderr=True, highlight=False)

Out = Annotated[Path, typer.Option(help="Folder for results and pictures; made if it is not there.")]
ImageFormat = Annotated[str, typer.Option("--format", help="Kind of pictures: png, pdf or svg.")]
Backend = Annotated[str, typer.Option(help='"auto", the fastest there is; "native", "vm" or "numpy".')]


def step(start: float, words: str) -> None:
    """Print a line that says what is being done, with the time since the start."""
    console.print(f"[dim]{time.perf_counter() - start:5.1f} s[/] {words}")


def check_format(image: str) -> None:
    """Raise InputError for a format that not every matplotlib can write."""
    if image not in ("png", "pdf", "svg"):
        raise InputError(f"--format is {image!r}; choose png, pdf or svg")


def check_writable(folder: Path) -> None:
    """Make the folder and try a file in it, before any work."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise InputError(f"--out {folder} cannot be written to: {error.strerror or error}") from None


def command_of(name: str, options: type, run: Callable[[Any], None]) -> Callable[..., None]:
    """A command for Typer whose parameters are the fields of a dataclass, and whose help is that of `run`."""

    def command(**given: Any) -> None:
        run(options(**given))

    command.__name__, command.__doc__ = name, run.__doc__
    command.__annotations__ = get_type_hints(options, include_extras=True)
    command.__signature__ = inspect.signature(options)  # type: ignore[attr-defined]
    return command
