"""Flexible links from robot files: beams by their dimensions, other bodies from files beside."""

from typing import Any

from parflex.files.described import built
from parflex.files.joint_table import JointTable
from parflex.files.lines import Where
from parflex.files.platform_tables import from_modal_file
from parflex.files.reading import Reader
from parflex.robot.beam import Beam


def link_fields(reader: Reader, where: Where, row: JointTable) -> dict[str, Any] | None:
    """The body of a joint's table as a field of the joint; none of a rigid link, None where there are
    complaints."""
    if row.beam is not None:
        beam = built(reader, (*where, "beam"), Beam, row.beam)
        body = None if beam is None else reader.attempt((*where, "beam"), lambda: beam.body)
    elif row.body is not None:
        body = reader.attempt((*where, "body"), from_modal_file, row.body, reader.path.parent)
    else:
        return {}
    return None if body is None else {"body": body}
