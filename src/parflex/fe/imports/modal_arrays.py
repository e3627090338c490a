"""Modes as plain arrays in an HDF5 or NPZ file, for programs that have no reader here."""

from collections.abc import Mapping
from io import BytesIO
from os import PathLike
from pathlib import Path

import numpy as np
from scipy import sparse

from parflex.base.array import Array
from parflex.base.check import exactly
from parflex.base.errors import InputError
from parflex.fe.body.basis import ComputedModes
from parflex.fe.imports.acceptance import accepted
from parflex.fe.imports.foreign import refusing
from parflex.fe.imports.imported import ImportedModes
from parflex.fe.imports.importer import Importer
from parflex.fe.imports.unit_systems import Units, units_named

PRECISE = 1e-6  # error that the numbers leave in ΦᵀMΦ
SHAPES: dict[str, tuple[str | int, ...]] = {  # of K nodes, P modes, T triangles
    "nodes": ("K", 3),
    "masses": ("K",),
    "shapes": ("P", "K", 3),
    "hertz": ("P",),
    "omega": ("P",),
    "rotations": ("P", "K", 3),
    "ids": ("K",),
    "triangles": ("T", 3),
    "modal_mass": ("P",),
}


def read_arrays(path: str | PathLike[str], units: str = "") -> ComputedModes:
    """The elastic modes of a free platform from named arrays in an .npz or .h5 file.

    nodes (K, 3), masses (K,) of nodes, shapes (P, K, 3) of all modes, rigid ones too, and either hertz
    (P,) or omega (P,) in radians; if there are: rotations (P, K, 3), ids (K,), triangles (T, 3) of rows
    of nodes from 0, modal_mass (P,), by default 1 for each. All in `units`: "SI", "mm-tonne-s" …. The
    check report is `modes.report`.

    Raises InputError where the file is missing, damaged, or lacks an array, the model is held, or the
    modes do not belong to the masses.
    """
    system = units_named(units)
    file = Path(path)
    return accepted(in_si_units(file.name, fitting_together(file.name, named_arrays(file)), system))


def named_arrays(path: Path) -> Mapping[str, Array]:
    """The arrays of a file that have names known here."""
    import h5py

    if not path.is_file():
        raise InputError(f"arrays {path} cannot be read: No such file")
    words = f"arrays {path.name} is damaged, or no .npz or HDF5 file ({{}}); write it again"
    with refusing(words, Exception):
        opened = (
            np.load(BytesIO(path.read_bytes()), allow_pickle=False)
            if path.suffix == ".npz"
            else h5py.File(path, "r")
        )
        with opened as file:
            return {name: np.asarray(file[name]) for name in SHAPES if name in file}


def fitting_together(name: str, given: Mapping[str, Array]) -> dict[str, Array]:
    """The arrays in the shapes that fit together, those that may be missing in their default.

    Raises InputError where one is missing, of another shape, or has values that cannot be.
    """
    missing = [key for key in ("nodes", "masses", "shapes") if key not in given]
    if missing or ("hertz" in given) == ("omega" in given):
        lacks = missing[0] if missing else "hertz or omega, one of them,"
        raise InputError(
            f"arrays {name} lacks {lacks}; it has {', '.join(given) or 'none that is known here'}"
        )
    found: dict[str, Array] = {}
    size: dict[str | int, int] = {3: 3}
    for key in (key for key in SHAPES if key in given):
        found[key] = exactly(key, given[key], tuple(size.get(axis) for axis in SHAPES[key]))
        size |= dict(zip(SHAPES[key], found[key].shape, strict=True))
    K, P, masses = size["K"], size["P"], found["masses"]
    if np.any(masses < 0):
        raise InputError(f"masses[{int(np.argmin(masses))}] is {np.min(masses)}; masses cannot be negative")
    if "hertz" in found:
        found["omega"] = 2 * np.pi * found["hertz"]
    found = {"modal_mass": np.ones(P), "ids": np.arange(1, K + 1), "triangles": np.zeros((0, 3))} | found
    surface = found["triangles"].astype(int)
    if not np.all(found["modal_mass"] > 0) or np.any(surface < 0) or np.any(surface >= K):
        raise InputError(
            f"arrays {name} has a modal_mass that is not positive, or a triangle of nodes it has not"
        )
    return found


def in_si_units(name: str, given: dict[str, Array], units: Units) -> ImportedModes:
    """The arrays in SI units."""
    omega, modal, rotations = given["omega"], given["modal_mass"], given.get("rotations")
    return ImportedModes(
        ids=given["ids"].astype(int),
        nodes=units.length * given["nodes"],
        mass=sparse.diags_array(units.mass * given["masses"]).tocsr(),
        shapes=units.length * given["shapes"],
        rotations=rotations if rotations is not None and np.any(rotations) else None,
        squares=np.sign(omega) * (omega / units.time) ** 2,
        modal_mass=units.inertia * modal,
        triangles=given["triangles"].astype(int),
        mass_kind="lumped",
        normalised="MASS" if np.all(modal == 1) else "the modal masses in the file",
        source=f"arrays, {name}, {units.name}",
        precision=PRECISE,
    )


IMPORTER = Importer("arrays", read_arrays, ("path",))
