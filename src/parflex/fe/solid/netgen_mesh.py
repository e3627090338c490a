"""Meshes by Netgen (`pip install 'parflex[solids]'`): of plates from their outlines, of STEP files."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import all_of_type, exactly, integer, positive, scalar
from parflex.base.errors import InputError
from parflex.base.extra import extra
from parflex.base.progress import waiting
from parflex.fe.body.keep import kept
from parflex.fe.imports.foreign import unmarked
from parflex.fe.plate.polygon import simple_polygon
from parflex.fe.plate.proportions import check_flat, check_proportions
from parflex.fe.solid.mesh import EDGES, MIRRORED, Folded, SolidMesh, solid_mesh
from parflex.fe.units import length_unit, unit_of_step

BLOCK = 3.0  # of the outline's size: thickness beyond which a block is likely in another unit
LEAST, UNKNOWNS, UTMOST = 29_000, 32_500, 35_000  # unknowns of a mesh whose size is not given
MOST = 150_000  # cubes of the size of an element in a solid; each holds seven tetrahedra or so
TRIES, FINER = 8, 0.7
# Netgen's middles, as (0, 1) (0, 2) (0, 3) (1, 2) (1, 3) (2, 3), in our order
NETGEN_EDGES = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]
ORDER = [0, 1, 2, 3, *(4 + NETGEN_EDGES.index((a, b)) for a, b in np.sort(EDGES).tolist())]


@dataclass(frozen=True, eq=False)
class Rib:
    """A prism on a plate: its outline, its height above the top, or below the bottom where it is negative,
    m, and its part, for its material."""

    outline: ArrayLike
    height: float
    part: int = 0


@dataclass(frozen=True, eq=False)
class Step:
    """A region of a plate with another thickness m about the same middle plane, and its part."""

    outline: ArrayLike
    thickness: float
    part: int = 0


def outline_mesh(
    outline: ArrayLike,
    thickness: float,
    holes: Sequence[ArrayLike] = (),
    ribs: Sequence[Rib] = (),
    steps: Sequence[Step] = (),
    size: float | None = None,
    fine_at: ArrayLike = (),
    fine: float | None = None,
) -> SolidMesh:
    """A mesh of a plate of any simple outline, its middle plane at z = 0.

    An outline, of the plate, a hole, a rib or a step, is corners (n, 2) m or a circle (x, y, radius), so
    that `outline_mesh((0, 0, 0.17), 0.02, holes=[(0, 0, 0.03)])` is a ring. size m bounds the edges of the
    elements; by default it is chosen for some 32,000 unknowns, at most 35,000. Around the points fine_at
    (k, 3) m they are at most `fine` m.

    Raises InputError for outlines that cross themselves, a thickness or sizes that Netgen finds no mesh for,
    and where it is not installed.
    """
    occ = netgen()
    half = 0.5 * positive("thickness", thickness)
    ribs, steps = all_of_type("ribs", ribs, Rib), all_of_type("steps", steps, Step)
    if not isinstance(holes, list | tuple):
        raise InputError(f"holes is {type(holes).__name__}; give a list of outlines")
    solids = [(column(occ, "outline", outline, -half, half), 0)]
    box = bounds(solids[0][0])[:, :2]
    check_proportions("outline", box, thickness, BLOCK)
    check_flat(float(np.max(np.ptp(box, axis=0))), thickness)
    for number, step in enumerate(steps):
        name = f"steps[{number}].outline"
        tall = 0.5 * positive(f"steps[{number}].thickness", step.thickness)
        cut = column(occ, name, step.outline, -half, half)
        solids = [(shape - cut, part) for shape, part in solids]
        solids.append(
            (column(occ, name, step.outline, -tall, tall), integer(f"steps[{number}].part", step.part))
        )
    for number, rib in enumerate(ribs):
        if scalar(f"ribs[{number}].height", rib.height) == 0:
            raise InputError(f"ribs[{number}].height is {rib.height}; it cannot be zero")
        ends = (half, half + rib.height) if rib.height > 0 else (-half + rib.height, -half)
        solids.append(
            (
                column(occ, f"ribs[{number}].outline", rib.outline, *ends),
                integer(f"ribs[{number}].part", rib.part),
            )
        )
    top = 2.0 * max(np.max(np.abs(bounds(shape))) for shape, _ in solids)
    for number, hole in enumerate(holes):
        cut = column(occ, f"holes[{number}]", hole, -top, top)
        solids = [(shape - cut, part) for shape, part in solids]
    return meshed(one_shape(occ, solids), size, fine_at, fine)


def step_mesh(
    path: str | os.PathLike[str],
    size: float | None = None,
    unit: str | None = None,
    fine_at: ArrayLike = (),
    fine: float | None = None,
) -> SolidMesh:
    """A mesh of the solids of a STEP file, each a part; size, fine_at, fine as in `outline_mesh`, m.

    unit ("mm", "m", "inch" …) is that of the file's numbers; by default the one the file names.

    Raises InputError where the file is missing, damaged or without solids, where it names no unit and
    none is given, and where Netgen is not installed.
    """
    occ, file = netgen(), Path(path)
    try:
        text = file.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise InputError(f"{file} cannot be read: {error.strerror}") from None
    named = unit_of_step(text)
    if named is None:
        raise InputError(f"{file} names no unit of length; it is no STEP file, or a damaged one")
    try:
        with unmarked(file) as plain:
            shape = occ.OCCGeometry(str(plain)).shape
    except Exception as error:  # Netgen's own kind
        raise InputError(f"{file} is damaged or no STEP file: {str(error).splitlines()[0]}") from None
    if not shape.solids:
        raise InputError(f"{file} holds no solid; export a solid body, not surfaces")
    # Open Cascade turns what the file names into millimetres, and Netgen passes them on as they are
    grown = shape.Scale(occ.Pnt(0, 0, 0), 1e-3 if unit is None else 1e-3 * length_unit("unit", unit) / named)
    parts = [(solid, part) for part, solid in enumerate(grown.solids)]
    return meshed(one_shape(occ, parts), size, fine_at, fine)


def netgen() -> Any:
    """The module netgen.occ. Raises InputError where it is not installed."""
    words = "Netgen is not installed, which meshes solids; pip install 'parflex[solids]', or give a mesh"
    return extra("netgen.occ", words)


def prism(occ: Any, corners: Array, bottom: float, top: float) -> Any:
    """The solid over a polygon."""
    plane = occ.WorkPlane(occ.Axes((0, 0, bottom), n=occ.Z, h=occ.X)).MoveTo(*corners[0])
    for corner in (*corners[1:], corners[0]):
        plane = plane.LineTo(*corner)
    return plane.Face().Extrude(top - bottom)


def column(occ: Any, name: str, outline: ArrayLike, bottom: float, top: float) -> Any:
    """The solid over an outline: a cylinder over a circle (x, y, radius), a prism over corners."""
    given = np.asarray(outline, dtype=object)
    if given.ndim > 1:
        return prism(occ, simple_polygon(name, outline), bottom, top)
    x, y, radius = exactly(name, outline, (3,))
    return occ.Cylinder((x, y, bottom), occ.Z, r=positive(f"{name} radius", radius), h=top - bottom)


def one_shape(occ: Any, solids: list[tuple[Any, int]]) -> Any:
    """One shape: solids of a part fused, parts meeting in common faces and named by number."""
    parts = []
    for part in sorted({part for _, part in solids}):
        own = [shape for shape, number in solids if number == part]
        whole = occ.Fuse(own) if len(own) > 1 else own[0]
        for solid in whole.solids:
            solid.name = f"part {part}"
            parts.append(solid)
    if not parts:
        raise InputError("nothing is left of the plate; make the holes smaller")
    return occ.Glue(parts) if len(parts) > 1 else parts[0]


def bounds(shape: Any) -> Array:
    """Lowest and highest coordinates (2, 3)."""
    return np.array([(corner.x, corner.y, corner.z) for corner in shape.bounding_box])


def meshed(shape: Any, size: float | None, fine_at: ArrayLike, fine: float | None) -> SolidMesh:
    """The mesh of a shape, of a size chosen for the number of unknowns where none is given."""
    none = isinstance(fine_at, list | tuple) and not fine_at
    near = np.zeros((0, 3)) if none else exactly("fine_at", fine_at, (None, 3))
    for name, value in (("size", size), ("fine", fine)):
        if value is not None:
            positive(name, value)
    if len(near) and fine is None:
        raise InputError("fine_at is given without fine, the size of elements there, m")
    key = ("mesh", drawing(shape), size, near, fine)

    def compute() -> tuple[Array, Array, Array]:
        mesh = sized(shape, size, near, fine)
        return mesh.nodes, mesh.elements, mesh.parts

    nodes, elements, parts = kept(key, compute)
    return SolidMesh(nodes, elements, parts)


def sized(shape: Any, size: float | None, near: Array, fine: float | None) -> SolidMesh:
    """The mesh of a size, or of the number of unknowns that is wanted."""
    if size is not None:
        least = (shape.mass / MOST) ** (1 / 3)
        if size < least:
            raise InputError(
                f"size is {size} m, so small that the solid falls into more than a million elements, which "
                f"no workstation solves; give {least:.2g} m or more"
            )
        return tetrahedra(shape, size, near, fine)
    trial, power = float(np.prod(np.ptp(bounds(shape), axis=0)) ** (1 / 3)) / 4, 0.45
    best: SolidMesh | None = None
    for tried in range(TRIES):
        try:
            mesh = tetrahedra(shape, trial, near, fine)
        except Folded:  # too coarse for a curved face
            if tried + 1 == TRIES and best is None:
                raise
            trial *= FINER
            continue
        count = 3 * len(mesh.nodes)
        if count <= UTMOST and (best is None or count > 3 * len(best.nodes)):
            best = mesh
        if LEAST <= count <= UTMOST:
            break
        trial *= (count / UNKNOWNS) ** power
    return mesh if best is None else best


def drawing(shape: Any) -> bytes:
    """The shape as Open Cascade writes it, which determines the mesh."""
    with TemporaryDirectory() as folder:
        file = Path(folder) / "shape.brep"
        shape.WriteBrep(str(file))
        return file.read_bytes() + ",".join(str(solid.name) for solid in shape.solids).encode()


def tetrahedra(shape: Any, size: float, near: Array, fine: float | None) -> SolidMesh:
    """Netgen's second-order elements. Raises InputError where Netgen finds none."""
    from netgen.meshing import MeshingParameters, SetMessageImportance
    from netgen.occ import OCCGeometry

    settings = MeshingParameters(maxh=size)
    for point in near:
        settings.RestrictH(*map(float, point), h=fine)
    SetMessageImportance(0)
    try:
        with waiting(f"meshing with elements of {size:.3g} m"):
            mesh = OCCGeometry(shape).GenerateMesh(settings)
            mesh.SecondOrder()
    except Exception as error:  # Netgen's own kind
        words = (str(error) or type(error).__name__).splitlines()[0]
        raise InputError(
            f"Netgen finds no mesh of the solid with elements of {size:.3g} m ({words}); check the units of "
            f"its sizes, or give another size of elements"
        ) from None
    cells = mesh.Elements3D().NumPy()
    names = [mesh.GetMaterial(k + 1) for k in range(int(np.max(cells["index"], initial=0)))]
    number = np.array([int(name.removeprefix("part ")) for name in names])
    elements = cells["nodes"][:, :10].astype(np.int64)[:, ORDER] - 1
    elements = elements[:, MIRRORED]  # Netgen sees them from the other side
    return solid_mesh(mesh.Coordinates(), elements, number[cells["index"] - 1])
