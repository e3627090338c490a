"""Platforms from their tables, and a rigid platform's table from its moments."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from parflex.array import outer
from parflex.body import FlexibleBody
from parflex.errors import InputError
from parflex.files.body_file import load_body
from parflex.files.robot_schema import ImportedTable, ModalTable, PolygonTable, RigidTable
from parflex.files.tables import inertia_matrix

WORDS = {"polygon": "corners", "n_modes": "modes", "inertia_at_com": "inertia"}  # argument: field


def platform(table: RigidTable | PolygonTable | ModalTable | ImportedTable, folder: Path) -> FlexibleBody:
    """The platform of a table; files are relative to `folder`.

    Raises InputError that begins with the field's name.
    """
    try:
        if isinstance(table, ModalTable):
            return load_body(folder / table.file)
        if isinstance(table, ImportedTable):
            return imported(table, folder)
        return plate(table) if isinstance(table, PolygonTable) else rigid(table)
    except InputError as error:
        first, space, rest = str(error).partition(" ")
        raise InputError(WORDS.get(first, first) + space + rest) from None


def plate(table: PolygonTable) -> FlexibleBody:
    """A plate with computed modes, held at its corners or at the points named."""
    from parflex.fe import plate_modes

    values = (table.thickness, table.young, table.poisson, table.density, table.modes, table.refine)
    modes = plate_modes(table.corners, *values)
    points = None if table.attachments is None else [(x, y, 0.0) for x, y in table.attachments]
    return FlexibleBody.from_modes(modes, points, table.origin, table.damping_ratio)


def imported(table: ImportedTable, folder: Path) -> FlexibleBody:
    """A body of another program's files, held at nodes or points; the check report is not printed."""
    from parflex.fe import import_modes

    files = {name: folder / path for name, path in table.files.items()}
    places = (table.ids, table.points, table.radius)
    modes = import_modes(table.program, files, table.units, table.modes, *places, say=lambda words: None)
    return FlexibleBody.from_modes(modes, None, table.origin, table.damping_ratio)


def rigid(table: RigidTable) -> FlexibleBody:
    """A rigid body from its inertia about the centre of mass, or from its moments."""
    points = np.reshape(np.array(table.attachments, dtype=float), (-1, 3))
    if table.inertia is not None:
        com = (0.0, 0.0, 0.0) if table.com is None else table.com
        return FlexibleBody.rigid(table.mass, com, inertia_matrix(table.inertia), points)
    first, second = np.array(table.first_moment), np.array(table.second_moment)
    central = second - outer(first, first) / table.mass
    inertia = np.trace(central) * np.eye(3) - central
    body = FlexibleBody.rigid(table.mass, first / table.mass, inertia, points)
    return replace(body, moments=body.moments._replace(MS0=first, P0=second))


def rigid_table(body: FlexibleBody) -> dict[str, Any] | None:
    """The table of a body that is mass and attachments alone; None for any other."""
    held = body.attachments == tuple(range(len(body.nodes)))
    no_shapes = body.rotation_shapes is not None and body.modes == 0
    if not (held and no_shapes and body.triangles is None):
        return None
    return {
        "kind": "rigid",
        "mass": float(body.moments.m),
        "first_moment": body.moments.MS0.tolist(),
        "second_moment": body.moments.P0.tolist(),
        "attachments": body.nodes.tolist(),
    }
