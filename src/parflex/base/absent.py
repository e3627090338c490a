"""The complaint about a file that is not there."""

from pathlib import Path

from parflex.base.nearest import nearest


def absent(path: Path) -> str:
    """A sentence that names the file of the folder with the nearest name."""
    try:
        there = {each.name: each for each in path.parent.iterdir() if each.is_file()}
    except OSError:
        return f"{path}: there is no folder {path.parent}"
    close = nearest(path.name, there)
    return f"{path}: there is no such file" + (f"; did you mean {there[close]}?" if close else "")
