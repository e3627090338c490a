"""Bodies from the descriptions and files that people have, and the basis that is right for a platform."""

import os
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import NamedTuple

from numpy.typing import ArrayLike

from parflex.base.errors import InputError
from parflex.fe.body.basis import Basis, ComputedModes, FreeFree, FreeFreeWithAttachment
from parflex.fe.body.free_body import FreeBody
from parflex.fe.plate.plate import plate_body, plate_modes
from parflex.fe.solid.mesh import SolidMesh
from parflex.fe.solid.mesh_file import read_mesh
from parflex.fe.solid.netgen_mesh import step_mesh
from parflex.fe.solid.solid import solid_body
from parflex.robot.material import Material

RIGHT = 0.01  # relative error of the basis of a platform whose basis is not chosen
PAPER = 10  # free–free modes where their number is not chosen
COARSER = 1.5  # size of the elements of a mesh to compare with


def modes(
    body: FreeBody,
    points: ArrayLike | None = None,
    tool: ArrayLike | None = None,
    radius: float | None = None,
    tolerance: float = RIGHT,
    up_to: float | None = None,
    n: int | None = None,
) -> ComputedModes:
    """The modes of a platform in the basis that is right for its joints.

    points are the joints, tool is where wrenches act, radius that of a solid's patches, as in
    `FreeFreeWithAttachment`; tolerance and up_to as in `converged`. With n they are so many free–free
    modes and the attachment modes.

    Raises InputError and NotConverged as they do.
    """
    found = FreeFreeWithAttachment(1 if n is None else n, points, tool, radius).modes(body)
    return found.converged(tolerance, up_to) if n is None else found


def mesh_from(path: str | os.PathLike[str], unit: str | None = None, size: float | None = None) -> SolidMesh:
    """The mesh of a STEP file, of elements of `size` m, or of a mesh file, in its `unit`.

    Raises InputError for a size where there is a mesh, for a mesh without unit, and as `step_mesh` and
    `read_mesh` do.
    """
    file = Path(path)
    if is_step(file):
        return step_mesh(file, size, unit)
    if size is not None:
        raise InputError(f"size is given, but {file.name} is a mesh already; leave it out")
    if unit is None:
        raise InputError(f'unit is not given; say in what unit {file.name} is: "mm", "m" or "inch"')
    return read_mesh(file, unit)


def is_step(file: Path) -> bool:
    """True for the name of a STEP file."""
    return file.suffix.lower() in (".step", ".stp")


class PlatformSource(NamedTuple):
    """A body whose joints are judged on `body`, its modes in a basis, and the same body of larger elements
    where there is one."""

    body: FreeBody
    modes: Callable[[Basis], ComputedModes]
    coarse: Callable[[], FreeBody] | None = None

    def basis(
        self,
        n: int | None,
        free: bool,
        tolerance: float,
        points: ArrayLike | None,
        tool: ArrayLike | None,
        radius: float | None,
    ) -> Basis:
        """Free–free modes alone, n of them with attachment modes, or the smallest right to a tolerance."""
        if free:
            return FreeFree(PAPER if n is None else n, points, tool, radius)
        if n is not None:
            return FreeFreeWithAttachment(n, points, tool, radius)
        found = modes(self.body, points, tool, radius, tolerance).reduction
        assert found is not None
        return found.basis


def plate_source(
    outline: ArrayLike,
    thickness: float,
    material: Material,
    refine: int | None,
    points: ArrayLike | None = None,
    tool: ArrayLike | None = None,
) -> PlatformSource:
    """A thin plate, with nodes at its joints and tool, whose modes tell the change from a coarser mesh
    themselves."""
    finer = {} if refine is None else {"refine": refine}
    body = plate_body(outline, thickness, material=material, points=points, tool=tool, **finer)
    return PlatformSource(
        body, lambda basis: plate_modes(outline, thickness, n_modes=basis, refine=refine, material=material)
    )


def solid_source(mesh_of: Callable[..., SolidMesh], size: float | None, material: Material) -> PlatformSource:
    """A solid that Netgen meshes with elements of `size` m."""
    mesh = mesh_of(size=size)
    body = solid_body(mesh, material)
    return PlatformSource(
        body, lambda basis: basis.modes(body), lambda: solid_body(mesh_of(size=COARSER * mesh.size), material)
    )


def file_source(path: Path, unit: str | None, size: float | None, material: Material) -> PlatformSource:
    """The solid of a STEP file, or of a mesh, which has no coarser one."""
    if is_step(path):
        return solid_source(partial(step_mesh, path, unit=unit), size, material)
    body = solid_body(mesh_from(path, unit, size), material)
    return PlatformSource(body, lambda basis: basis.modes(body))
