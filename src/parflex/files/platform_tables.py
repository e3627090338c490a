"""Platforms from their tables, and a rigid platform's table from its moments."""

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array, outer
from parflex.base.errors import InputError
from parflex.files.platform_schema import (
    DiscTable,
    ImportedTable,
    MeshedTable,
    ModalTable,
    PolygonTable,
    RigidTable,
    SolidTable,
)
from parflex.files.tables import Table, inertia_of
from parflex.robot.body import FlexibleBody
from parflex.robot.material import Material

if TYPE_CHECKING:
    from parflex.fe import SolidMesh


JOINT = re.compile(r"\bjoint (\d+)")
SAME = 1e-9  # m: attachments that are nearer are one place, which legs share


def from_polygon(table: PolygonTable, folder: Path) -> FlexibleBody:
    """A plate with computed modes, held at its corners or at the points named."""
    from parflex.fe import modes, plate_body, plate_modes

    plate: dict[str, Any] = {"material": table.made_of, "points": table.attachments}
    plate |= {} if table.refine is None else {"refine": table.refine}
    if table.modes is None:
        found = modes(plate_body(table.corners, table.thickness, **plate))
    else:
        found = plate_modes(table.corners, table.thickness, n_modes=table.modes, **plate)
    return FlexibleBody.from_modes(found, origin=table.origin, damping_ratio=table.damping_ratio)


def from_mesh(table: SolidTable, folder: Path) -> FlexibleBody:
    """A solid with computed modes, held at patches of its surface."""
    from parflex.fe import mesh_from

    made_of = table.made_of
    return from_solid(table, mesh_from(folder / table.file, table.unit, table.size), made_of)


def from_disc(table: DiscTable, folder: Path) -> FlexibleBody:
    """A disc or ring with computed modes, held at patches of its surface."""
    from parflex.fe import outline_mesh

    made_of = table.made_of
    holes = [] if table.bore is None else [(0.0, 0.0, table.bore / 2)]
    mesh = outline_mesh((0.0, 0.0, table.diameter / 2), table.thickness, holes, size=table.size)
    return from_solid(table, mesh, made_of, (0.0, 0.0, 0.0))


def from_solid(
    table: MeshedTable, mesh: "SolidMesh", made_of: Material, centre: ArrayLike | None = None
) -> FlexibleBody:
    """A mesh with computed modes, held as its table says; its centre, by default that of mass, is the origin
    where the table names none."""
    from parflex.fe import modes, solid_body

    body = solid_body(mesh, made_of)
    places = (table.attachments, table.tool, table.radius)
    found = modes(body, *places, n=table.modes)
    origin = centre if table.origin is None else table.origin
    return FlexibleBody.from_modes(found, origin=origin, damping_ratio=table.damping_ratio)


def from_program(table: ImportedTable, folder: Path) -> FlexibleBody:
    """A body of another program's files, held at nodes or points."""
    from parflex.fe import import_modes

    files = {name: folder / path for name, path in table.files.items()}
    places = (table.ids, table.points, table.radius)
    modes = import_modes(table.program, files, table.units, table.modes, *places)
    return FlexibleBody.from_modes(modes, origin=table.origin, damping_ratio=table.damping_ratio)


def from_inertia(table: RigidTable, folder: Path) -> FlexibleBody:
    """A rigid body from its inertia about the centre of mass, or from its moments."""
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
    DiscTable: from_disc,
    SolidTable: from_mesh,
    ImportedTable: from_program,
    ModalTable: from_modal_file,
}


def platform(table: Table, folder: Path, joints: Array | None = None) -> FlexibleBody:
    """The platform of a table; files are relative to `folder`.

    One that names no attachments has them at the joints (k, 3) m of Σp. What is computed of a place that is
    named twice is held there twice.

    Raises InputError in which joints are attachments, counted from 0 as the file does.
    """
    if getattr(table, "attachments", ()) is None and not isinstance(table, PolygonTable) and joints is None:
        raise InputError("attachments is missing; give the points that legs may hold")
    if joints is not None and getattr(table, "attachments", ()) is None:
        table = table.model_copy(update=at_joints(table, joints))
    points = getattr(table, "attachments", None) or []
    first = firsts(points)
    kept = sorted(set(first))
    twice = len(kept) < len(first) and not isinstance(table, RigidTable)
    if twice:
        table = table.model_copy(update={"attachments": [points[k] for k in kept]})
    try:
        body = BUILDERS[type(table)](table, folder)
    except InputError as error:
        words = JOINT.sub(lambda found: f"attachments[{kept[int(found[1]) - 1]}]", str(error))
        raise type(error)(words) from None
    if not twice:
        return body
    return replace(body, attachments=tuple(body.attachments[kept.index(k)] for k in first))


def firsts(points: Sequence[Sequence[float]]) -> list[int]:
    """The number of the first of the points that each is the same as."""
    places = np.array(points, dtype=float)
    return [int(np.argmax(np.max(np.abs(places - place), axis=1) <= SAME)) for place in places]


def at_joints(table: Table, joints: Array) -> dict[str, Any]:
    """Attachments at joints (k, 3) m of Σp, whose z axis is the body's, and the point that is its origin: by
    default a plate is in the plane of the joints, a disc stands on them, a solid's own frame is Σp."""
    if isinstance(table, RigidTable):
        return {"attachments": joints.tolist()}
    down = {PolygonTable: joints[0, 2], SolidTable: 0.0}
    if isinstance(table, DiscTable):
        down[DiscTable] = joints[0, 2] + table.thickness / 2
    origin = getattr(table, "origin", None) or [0.0, 0.0, -float(down[type(table)])]
    held = joints + np.array(origin)
    return {"attachments": held[:, : 2 if isinstance(table, PolygonTable) else 3].tolist(), "origin": origin}


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
