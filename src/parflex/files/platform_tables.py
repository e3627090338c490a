"""Platforms from their tables, and a rigid platform's table from its moments."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from parflex.base.array import Array, outer
from parflex.base.errors import InputError
from parflex.files.platform_schema import ImportedTable, ModalTable, PolygonTable, RigidTable, SolidTable
from parflex.files.tables import Table, inertia_of
from parflex.robot.body import FlexibleBody


def from_polygon(table: PolygonTable, folder: Path) -> FlexibleBody:
    """A plate with computed modes, held at its corners or at the points named."""
    from parflex.fe import modes, plate_body, plate_modes

    section = (table.thickness, table.young, table.poisson, table.density)
    points = None if table.attachments is None else [(x, y, 0.0) for x, y in table.attachments]
    if table.modes is None:
        options = {} if table.refine is None else {"refine": table.refine}
        found = modes(plate_body(table.corners, *section, **options), points)
        return FlexibleBody.from_modes(found, origin=table.origin, damping_ratio=table.damping_ratio)
    found = plate_modes(table.corners, *section, table.modes, table.refine)
    return FlexibleBody.from_modes(found, points, origin=table.origin, damping_ratio=table.damping_ratio)


def from_mesh(table: SolidTable, folder: Path) -> FlexibleBody:
    """A solid with computed modes, held at patches of its surface."""
    from parflex.fe import Material, mesh_from, modes, solid_body

    mesh = mesh_from(folder / table.file, table.unit, table.size)
    body = solid_body(mesh, Material(table.young, table.poisson, table.density))
    places = (table.attachments, table.tool, table.radius)
    found = modes(body, *places, n=table.modes)
    return FlexibleBody.from_modes(found, origin=table.origin, damping_ratio=table.damping_ratio)


def from_program(table: ImportedTable, folder: Path) -> FlexibleBody:
    """A body of another program's files, held at nodes or points."""
    from parflex.fe import import_modes

    files = {name: folder / path for name, path in table.files.items()}
    places = (table.ids, table.points, table.radius)
    modes = import_modes(table.program, files, table.units, table.modes, *places)
    return FlexibleBody.from_modes(modes, origin=table.origin, damping_ratio=table.damping_ratio)


def from_inertia(table: RigidTable, folder: Path) -> FlexibleBody:
    """A rigid body from its inertia about the centre of mass, or from its moments."""
    if table.attachments is None:
        raise InputError("attachments is missing; give the points that legs may hold")
    points = np.reshape(np.array(table.attachments, dtype=float), (-1, 3))
    if table.inertia is not None:
        com = (0.0, 0.0, 0.0) if table.com is None else table.com
        return FlexibleBody.rigid(table.mass, com, inertia_of(table.inertia), points)
    first, second = np.array(table.first_moment), np.array(table.second_moment)
    central = second - outer(first, first) / table.mass
    inertia = np.trace(central) * np.eye(3) - central
    body = FlexibleBody.rigid(table.mass, first / table.mass, inertia, points)
    return replace(body, moments=body.moments._replace(MS0=first, P0=second))


def from_modal_file(table: ModalTable, folder: Path) -> FlexibleBody:
    """The body that parflex stored."""
    from parflex.fe.modal_file import load_body

    return load_body(folder / table.file)


BUILDERS: dict[type[Table], Callable[[Any, Path], FlexibleBody]] = {
    RigidTable: from_inertia,
    PolygonTable: from_polygon,
    SolidTable: from_mesh,
    ImportedTable: from_program,
    ModalTable: from_modal_file,
}


def platform(table: Table, folder: Path, joints: Array | None = None) -> FlexibleBody:
    """The platform of a table; files are relative to `folder`.

    A plate or rigid body that names no attachments has them at the joints (k, 3) m of Σp, a plate in the
    plane of the joints.
    """
    if joints is not None and getattr(table, "attachments", ()) is None:
        table = table.model_copy(update=at_joints(table, joints))
    return BUILDERS[type(table)](table, folder)


def at_joints(table: Table, joints: Array) -> dict[str, Any]:
    """Attachments at joints (k, 3) m of Σp, whose z axis is the plate's."""
    if isinstance(table, RigidTable):
        return {"attachments": joints.tolist()}
    origin = getattr(table, "origin", None) or [0.0, 0.0, -float(joints[0, 2])]
    return {"attachments": (joints[:, :2] + np.array(origin)[:2]).tolist(), "origin": origin}


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
