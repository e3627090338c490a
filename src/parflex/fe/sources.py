"""Bodies from the files that people have, and the basis that is right for a platform."""

import os
from pathlib import Path

from numpy.typing import ArrayLike

from parflex.base.errors import InputError
from parflex.fe.body.basis import ComputedModes, FreeFreeWithAttachment
from parflex.fe.body.free_body import FreeBody
from parflex.fe.solid.mesh import SolidMesh
from parflex.fe.solid.mesh_file import read_mesh
from parflex.fe.solid.netgen_mesh import step_mesh

RIGHT = 0.01  # relative error of the basis of a platform whose basis is not chosen


def modes(
    body: FreeBody,
    points: ArrayLike | None = None,
    tool: ArrayLike | None = None,
    radius: float | None = None,
    tolerance: float = RIGHT,
    up_to: float | None = None,
) -> ComputedModes:
    """The modes of a platform in the basis that is right for its joints.

    points are the joints, tool is where wrenches act, radius that of a solid's patches, as in
    `FreeFreeWithAttachment`; tolerance and up_to as in `converged`.

    Raises InputError and NotConverged as they do.
    """
    return FreeFreeWithAttachment(1, points, tool, radius).modes(body).converged(tolerance, up_to)


def mesh_from(path: str | os.PathLike[str], unit: str | None = None, size: float | None = None) -> SolidMesh:
    """The mesh of a STEP file, of elements of `size` m, or of a mesh file, in its `unit`.

    Raises InputError for a size where there is a mesh, for a mesh without unit, and as `step_mesh` and
    `read_mesh` do.
    """
    file = Path(path)
    if file.suffix.lower() in (".step", ".stp"):
        return step_mesh(file, size, unit)
    if size is not None:
        raise InputError(f"size is given, but {file.name} is a mesh already; leave it out")
    if unit is None:
        raise InputError(f'unit is not given; say in what unit {file.name} is: "mm", "m" or "inch"')
    return read_mesh(file, unit)
