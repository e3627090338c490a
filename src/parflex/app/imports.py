"""The options of `parflex modes --from`: modes of another program's files."""

from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperCommand

from parflex.base.errors import InputError

# in help strings: what the importers and the table of materials say
PROGRAMS, TAKES, UNIT_SYSTEMS, MATERIALS = "PROGRAMS", "TAKES", "UNIT_SYSTEMS", "MATERIALS"

Program = Annotated[str | None, typer.Option("--from", help=f"Import the modes of {PROGRAMS}.")]
Files = Annotated[list[str] | None, typer.Option(help=f'A file to import, "name=path": {TAKES}.')]
Units = Annotated[str, typer.Option(help=f"The units of the imported files: {UNIT_SYSTEMS}.")]
Nodes = Annotated[
    list[str] | None,
    typer.Option(help='Joint of an imported model: a node\'s number, or "12,13,14" for a patch.'),
]


class ImportingCommand(TyperCommand):
    """A command whose help names importers and materials, which are loaded where it is asked for."""

    def format_help(self, ctx: Any, formatter: Any) -> None:
        from parflex.fe import IMPORTERS
        from parflex.fe.imports.unit_systems import SYSTEMS as systems
        from parflex.robot.materials import names

        words = {
            PROGRAMS: ", ".join(importer.name for importer in IMPORTERS),
            TAKES: "; ".join(importer.takes for importer in IMPORTERS),
            UNIT_SYSTEMS: ", ".join(systems),
            MATERIALS: names(),
        }
        options: list[Any] = list(self.params)
        for option in options:
            for mark, said in words.items():
                option.help = option.help and option.help.replace(mark, said)
        super().format_help(ctx, formatter)


def named_files(texts: list[str]) -> dict[str, Path]:
    """The files of "name=path" by name."""
    pairs = [text.partition("=") for text in texts]
    for text, (name, equals, path) in zip(texts, pairs, strict=True):
        if not (name and equals and path):
            raise InputError(f'--file is {text!r}; write it as "name=path", such as "op2=plate.op2"')
    return {name: Path(path) for name, _, path in pairs}


def node_ids(texts: list[str]) -> list[int | list[int]] | None:
    """The nodes of "12", and patches of "12,13,14"; None for none."""
    try:
        groups = [[int(part) for part in text.split(",")] for text in texts]
    except ValueError:
        given = ", ".join(texts)
        raise InputError(f"--node is {given}; give node numbers, with commas for a patch") from None
    return [group if len(group) > 1 else group[0] for group in groups] or None
