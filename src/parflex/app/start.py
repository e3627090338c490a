"""Where the command begins: Ctrl-C is heard from here on, before anything that takes time is imported."""

import signal
import sys
from types import FrameType

_pressed = False  # Ctrl-C, since the command began


def run() -> None:
    """Run the command; whenever Ctrl-C is pressed, it ends by saying so, and what was kept."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # it is ignored in the background
        signal.signal(signal.SIGINT, heard)
    try:
        from parflex.app import cli

        cli.run()
    except BaseException:  # libraries turn the interrupt into errors of their own
        if not _pressed:
            raise
    finally:
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # what follows is told in any case
    if _pressed:
        print(f"interrupted; {kept()}", file=sys.stderr, flush=True)
        sys.exit(130)


def heard(number: int, frame: FrameType | None) -> None:
    """Ctrl-C was pressed."""
    global _pressed
    _pressed = True
    raise KeyboardInterrupt


def kept() -> str:
    """The files that were written so far, in words."""
    from parflex.base.cache import folder
    from parflex.base.writing import WRITTEN

    mine = [str(path) for path in WRITTEN if path.parent != folder()]
    return f"kept: {', '.join(mine)}" if mine else "there was nothing to keep yet"
