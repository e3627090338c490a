"""What `parflex modes --from` does: the modes of another program's files."""

from pathlib import Path
from typing import Annotated, Any

import typer

from parflex.base.errors import InputError

Program = Annotated[
    str | None,
    typer.Option("--from", help='Import: "nastran", "calculix", "calculix-matrices", "matrices", "arrays".'),
]
Files = Annotated[
    list[str] | None, typer.Option(help='A file to import, "name=path", such as "op2=plate.op2".')
]
Units = Annotated[str, typer.Option(help='Of the imported files: "SI", "mm-tonne-s", "in-lbf" and others.')]
Nodes = Annotated[
    list[str] | None,
    typer.Option(help='Joint of an imported model: a node\'s number, or "12,13,14" for a patch.'),
]


def imported(
    program: str | None,
    file: list[str],
    units: str,
    count: int | None,
    node: list[str],
    joints: list[tuple[float, ...]],
    radius: float | None,
) -> Any:
    """The modes of another program's files, held at nodes by number or at points."""
    from parflex.fe import import_modes

    pairs = [text.partition("=") for text in file]
    for text, (name, equals, path) in zip(file, pairs, strict=True):
        if not (name and equals and path):
            raise InputError(f'--file is {text!r}; write it as "name=path", such as "op2=plate.op2"')
    files = {name: Path(path) for name, _, path in pairs}
    try:
        ids = [[int(part) for part in text.split(",")] for text in node]
    except ValueError:
        raise InputError(f"--node is {', '.join(node)}; give node numbers, with commas for a patch") from None
    places = [group if len(group) > 1 else group[0] for group in ids]
    held = (places or None, joints or None, radius)
    return import_modes(program or "", files, units, count, *held)
