"""Flexible links from robot files: beams by their dimensions, other bodies from files beside."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from parflex.files.described import built
from parflex.files.joint_table import JointTable
from parflex.files.lines import Where
from parflex.files.link_schema import ImportedLinkTable, SolidLinkTable
from parflex.files.platform_schema import ModalTable
from parflex.files.platform_tables import from_modal_file
from parflex.files.reading import Reader
from parflex.files.tables import Table, rotation_of
from parflex.robot.beam import Beam
from parflex.robot.body import FlexibleBody

if TYPE_CHECKING:
    from parflex.fe import FreeBody
    from parflex.robot.modes import Modes


def link_fields(reader: Reader, where: Where, row: JointTable) -> dict[str, Any] | None:
    """The body of a joint's table as a field of the joint; none of a rigid link, None where there are
    complaints."""
    if row.beam is not None:
        beam = built(reader, (*where, "beam"), Beam, row.beam)
        body = None if beam is None else reader.attempt((*where, "beam"), lambda: beam.body)
    elif row.body is not None:
        body = reader.attempt((*where, "body"), BUILDERS[type(row.body)], row.body, reader.path.parent)
    else:
        return {}
    return None if body is None else {"body": body}


def from_part(table: SolidLinkTable, folder: Path) -> FlexibleBody:
    """A meshed part, held at its frame."""
    from parflex.fe import mesh_from, solid_body

    made_of = table.made_of
    mesh = mesh_from(folder / table.file, table.unit, table.size)
    return linked(table, solid_body(mesh, made_of, any_size=True), None)


def from_program(table: ImportedLinkTable, folder: Path) -> FlexibleBody:
    """A body of another program's files, held at nodes or points."""
    from parflex.fe import read_files

    files = {name: folder / path for name, path in table.files.items()}
    return linked(table, read_files(table.program, files, table.units), table.ids)


def linked(
    table: SolidLinkTable | ImportedLinkTable, body: "FreeBody | Modes", ids: list[list[int]] | None
) -> FlexibleBody:
    """The link of a body, as its table says."""
    from parflex.fe import link

    return link(
        body,
        table.frame,
        table.interfaces,
        rotation=rotation_of(table.rotation),
        ids=ids,
        radius=table.radius,
        n_modes=table.modes,
        negligible=table.negligible,
        damping_ratio=table.damping_ratio,
    )


BUILDERS: dict[type[Table], Callable[[Any, Path], FlexibleBody]] = {
    ModalTable: from_modal_file,
    SolidLinkTable: from_part,
    ImportedLinkTable: from_program,
}
