"""Meshes from files of other programs, by meshio (`pip install 'parflex[solids]'`)."""

import os
from pathlib import Path
from typing import Any

import numpy as np

from parflex.base.errors import InputError
from parflex.base.extra import extra
from parflex.fe.imports.foreign import unmarked
from parflex.fe.solid.mesh import SolidMesh, solid_mesh
from parflex.fe.units import length_unit

PART_NAMES = ("gmsh:physical", "medit:ref", "cell_tags")


def read_mesh(path: str | os.PathLike[str], unit: str) -> SolidMesh:
    """The tetrahedra of a mesh file in any format of meshio, unit "mm", "m" or "inch" of its numbers.

    Blocks of four- and ten-node tetrahedra are read, four-node ones raised to second order; materials
    go by the file's physical groups, in ascending order of their numbers.

    Raises InputError where the file is missing, damaged or without tetrahedra, and where meshio is not
    installed; as `solid_mesh` does for the mesh itself.
    """
    scale, file = length_unit("unit", unit), Path(path)
    if not file.is_file():
        raise InputError(f"{file}: there is no such file")
    mesh = meshio_mesh(file)
    kinds = {block.type for block in mesh.cells}
    wanted = "tetra10" if "tetra10" in kinds else "tetra"
    chosen = [k for k, block in enumerate(mesh.cells) if block.type == wanted]
    if not chosen:
        held = ", ".join(sorted(kinds)) or "no elements"
        raise InputError(f"{file} holds {held}, but no tetrahedra; mesh the volume with tetrahedra")
    cells = np.concatenate([mesh.cells[k].data for k in chosen])
    if wanted == "tetra10":
        cells = cells[:, :10]
    name = next((name for name in PART_NAMES if name in mesh.cell_data), None)
    tags = np.zeros(len(cells)) if name is None else np.concatenate([mesh.cell_data[name][k] for k in chosen])
    parts = np.unique(tags, return_inverse=True)[1]
    return solid_mesh(scale * np.asarray(mesh.points, dtype=float), cells.astype(np.int64), parts)


def meshio_mesh(file: Path) -> Any:
    """meshio's mesh. Raises InputError where it cannot be read."""
    meshio = extra("meshio", "meshio is not installed, which reads meshes; pip install 'parflex[solids]'")
    try:
        with unmarked(file) as plain:
            return meshio.read(plain)
    except (Exception, SystemExit) as error:  # meshio raises many kinds, and exits on unknown formats
        words = str(error).strip().splitlines()
        reason = words[0] if words else "unknown format"
        raise InputError(f"{file} is damaged or in no format of meshio: {reason}") from None
