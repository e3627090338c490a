"""A progress bar for what takes longer than two seconds."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Timer
from types import TracebackType
from typing import Any

PATIENCE = 2.0  # s


@contextmanager
def waiting(what: str) -> Iterator[None]:
    """Say what is being done where it takes longer than a second; silent where nobody looks."""

    def say() -> None:
        print(f"{what} …", file=sys.stderr, flush=True)

    timer = Timer(1.0, say)
    timer.daemon = True
    if sys.stderr.isatty():
        timer.start()
    try:
        yield
    finally:
        timer.cancel()


class Progress:
    """A bar that shows how much is done, `with Progress("simulate", total) as bar: bar.to(done)`."""

    def __init__(self, what: str, total: float) -> None:
        self._what, self._total = what, total
        self._start = time.monotonic()
        self._bar: Any = None
        self._task: Any = None

    def __enter__(self) -> "Progress":
        return self

    def to(self, done: float) -> None:
        """Show that `done` of the total is done."""
        if self._bar is None:
            if time.monotonic() - self._start < PATIENCE or not sys.stderr.isatty():
                return
            self._open()
        self._bar.update(self._task, completed=done)

    def _open(self) -> None:
        from rich import progress
        from rich.console import Console

        columns = (
            progress.TextColumn("{task.description}"),
            progress.BarColumn(),
            progress.TaskProgressColumn(),
            progress.TimeRemainingColumn(),
        )
        self._bar = progress.Progress(*columns, console=Console(stderr=True))
        self._bar.start()
        self._task = self._bar.add_task(self._what, total=self._total)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bar is not None:
            self._bar.stop()
