"""The complaint about a file that is not there."""

from difflib import get_close_matches
from pathlib import Path


def absent(path: Path) -> str:
    """A sentence that names the file of the folder with the nearest name."""
    try:
        there = {each.name: each for each in path.parent.iterdir() if each.is_file()}
    except OSError:
        return f"{path}: there is no folder {path.parent}"
    close = get_close_matches(path.name, there, 1)
    return f"{path}: there is no such file" + (f"; did you mean {there[close[0]]}?" if close else "")
