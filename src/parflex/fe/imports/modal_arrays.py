"""Modes as plain arrays in an HDF5 or NPZ file, for programs that have no reader here."""

from collections.abc import Callable, Mapping
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from scipy import sparse

from parflex.base.array import Array
from parflex.base.check import exactly
from parflex.base.errors import InputError
from parflex.fe.imports.acceptance import accepted
from parflex.fe.imports.foreign import briefly
from parflex.fe.imports.imported import ImportedModes
from parflex.fe.imports.unit_systems import Units, units_named
from parflex.robot.modes import Modes

PRECISE = 1e-6  # what the numbers leave of ΦᵀMΦ
NAMES = ("nodes", "masses", "shapes", "hertz", "omega", "rotations", "ids", "triangles", "modal_mass")


def read_arrays(path: str | PathLike[str], units: str = "", say: Callable[[str], None] = print) -> Modes:
    """The elastic modes of a free platform from named arrays in an .npz or .h5 file.

    nodes (K, 3), masses (K,) of nodes, shapes (P, K, 3) of all modes, rigid ones too, and either hertz
    (P,) or omega (P,) in radians; if there are: rotations (P, K, 3), ids (K,), triangles (T, 3) of rows
    of nodes from 0, modal_mass (P,), by default 1 for each. All in `units`: "SI", "mm-tonne-s" …. The
    check report is `modes.report`; `say` prints it.

    Raises InputError where the file is missing, damaged, or lacks an array, the model is held, or the
    modes do not belong to the masses.
    """
    system = units_named(units)
    file = Path(path)
    found = accepted(imported(file.name, arrays_of(file), system))
    say(str(found.report))
    return found


def arrays_of(path: Path) -> Mapping[str, Array]:
    """The arrays of a file that have names known here."""
    import h5py

    if not path.is_file():
        raise InputError(f"arrays {path} cannot be read: No such file")
    try:
        if path.suffix == ".npz":
            with np.load(BytesIO(path.read_bytes()), allow_pickle=False) as file:
                return {name: file[name] for name in NAMES if name in file}
        with h5py.File(path, "r") as file:
            return {name: np.asarray(file[name]) for name in NAMES if name in file}
    except Exception as error:  # NumPy and HDF5 raise many kinds for a damaged file
        raise InputError(
            f"arrays {path.name} is damaged, or no .npz or HDF5 file ({briefly(error)}); write it again"
        ) from None


def imported(name: str, given: Mapping[str, Any], units: Units) -> ImportedModes:
    """The arrays, in SI units."""
    missing = [key for key in ("nodes", "masses", "shapes") if key not in given]
    if missing or ("hertz" in given) == ("omega" in given):
        lacks = missing[0] if missing else "hertz or omega, one of them,"
        raise InputError(
            f"arrays {name} lacks {lacks}; it has {', '.join(given) or 'none that is known here'}"
        )
    nodes = exactly("nodes", given["nodes"], (None, 3))
    K = len(nodes)
    masses = exactly("masses", given["masses"], (K,))
    if np.any(masses < 0):
        raise InputError(f"masses[{int(np.argmin(masses))}] is {np.min(masses)}; masses cannot be negative")
    shapes = exactly("shapes", given["shapes"], (None, K, 3))
    P = len(shapes)
    omega = (
        exactly("omega", given["omega"], (P,))
        if "omega" in given
        else 2 * np.pi * exactly("hertz", given["hertz"], (P,))
    )
    rotations = exactly("rotations", given["rotations"], (P, K, 3)) if "rotations" in given else None
    modal = exactly("modal_mass", given["modal_mass"], (P,)) if "modal_mass" in given else np.ones(P)
    ids = exactly("ids", given["ids"], (K,)) if "ids" in given else np.arange(1, K + 1)
    surface = exactly("triangles", given.get("triangles", np.zeros((0, 3))), (None, 3)).astype(int)
    if not np.all(modal > 0) or np.any(surface < 0) or np.any(surface >= K):
        raise InputError(
            f"arrays {name} has a modal_mass that is not positive, or a triangle of nodes it has not"
        )
    return ImportedModes(
        ids=ids.astype(int),
        nodes=units.length * nodes,
        mass=sparse.diags_array(units.mass * masses).tocsr(),
        shapes=units.length * shapes,
        rotations=rotations if rotations is not None and np.any(rotations) else None,
        squares=np.sign(omega) * (omega / units.time) ** 2,
        modal_mass=units.inertia * modal,
        triangles=surface,
        mass_kind="lumped",
        normalised="MASS" if np.all(modal == 1) else "the modal masses in the file",
        source=f"arrays, {name}, {units.name}",
        precision=PRECISE,
    )
