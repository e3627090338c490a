"""The modal file: a platform with its modes in HDF5 (NetCDF-4), every number to the last bit.

docs/platforms.md has the schema. A checksum over all that the file says tells an altered one.
"""

import hashlib
import os
from collections.abc import Mapping
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import of_type
from parflex.base.errors import InputError
from parflex.base.netcdf import loaded, saved
from parflex.base.version import __version__
from parflex.fe.body.basis import ComputedModes
from parflex.fe.body.solid import Solid
from parflex.robot.body import FlexibleBody
from parflex.robot.material import Material
from parflex.robot.modes import Modes
from parflex.robot.moments import Moments

FORMAT = "parflex-modes-1"

MODE, OTHER, NODE, AXIS, AXIS_2 = "mode", "other_mode", "node", "axis", "other_axis"
ELEMENT = "element"

# values of a body: dimensions, units, meaning
MOMENTS = {
    "m": ((), "kg", "mass"),
    "MS0": ((AXIS,), "kg m", "integral of r"),
    "P0": ((AXIS, AXIS_2), "kg m2", "integral of r r^T"),
    "S": ((AXIS, MODE), "kg0.5", "integral of the shapes"),
    "P1": ((MODE, AXIS, AXIS_2), "kg0.5 m", "integral of shape r^T"),
    "P2": ((MODE, OTHER, AXIS, AXIS_2), "1", "integral of shape shape^T"),
}
FIELDS = {
    "nodes": ((NODE, AXIS), "m", "nodes in the platform frame"),
    "shapes": ((MODE, NODE, AXIS), "kg-0.5", "displacement shapes"),
    "rotation_shapes": ((MODE, NODE, AXIS), "rad m-1 kg-0.5", "rotation shapes"),
    "stiffness": ((MODE,), "s-2", "diagonal of the modal stiffness"),
    "damping": ((MODE,), "s-1", "diagonal of the modal damping"),
    "attachments": (("attachment",), "1", "node numbers from 0 that legs may hold"),
    "foreshortening": (("attachment", AXIS, MODE, OTHER), "m-1 kg-1", "second-order displacement, of a link"),
    "triangles": (("triangle", "corner"), "1", "surface, node numbers from 0"),
    "band": ((), "rad s-1", "highest free-free mode of the basis, where it is known"),
    "missed": ((NODE,), "1", "share of the static compliance at each node that the modes lack"),
}
# values that modes hold beside a body; none of them is needed for a platform
MODAL = {
    "frequencies": ((MODE,), "rad s-1", "natural frequencies, or of a basis its Ritz values"),
    "frequency_error": ((MODE,), "1", "change from a coarser mesh, where it is known"),
    "tool": ((), "1", "node number where wrenches act"),
    "elements": ((ELEMENT, "element_node"), "1", "ten-node tetrahedra, in VTK's order, from 0"),
    "parts": ((ELEMENT,), "1", "part of each element, from 0"),
    "materials": (("material", "modulus"), "Pa, 1, kg m-3", "Young's modulus, Poisson's ratio, density"),
}
WHOLE = ("attachments", "triangles", "tool", "elements", "parts")
UNKNOWN = ("frequency_error", "missed")  # estimates, which may be
OPTIONAL = ("rotation_shapes", "foreshortening", "triangles", "band", "missed")


def write_modes(
    modes: Modes,
    path: str | os.PathLike[str],
    attachments: ArrayLike | None = None,
    origin: ArrayLike | None = None,
    damping_ratio: ArrayLike = 0.0,
) -> Path:
    """Write modes as a modal file that robot files name; arguments as in `FlexibleBody.from_modes`.

    Raises InputError as that does, and where the file cannot be written.
    """
    of_type("modes", modes, Modes)
    body = FlexibleBody.from_modes(modes, attachments, origin, damping_ratio=damping_ratio)
    save_body(body, Path(path), modes)
    return Path(path)


def read_modes(path: str | os.PathLike[str]) -> ComputedModes:
    """The modes of a modal file, in the platform's frame.

    Raises InputError where the file is missing, truncated, altered, or holds something else.
    """
    data = opened(Path(path))
    found = arrays_of(Path(path).name, data)
    body = body_of(found)
    frequencies = found["frequencies"]
    if frequencies is None:
        frequencies = np.sqrt(body.stiffness / np.diagonal(body.m_ee))
    unknown = np.full(len(frequencies), np.nan)
    materials = stored_materials(found, data.attrs)
    return ComputedModes(
        nodes=body.nodes,
        triangles=np.zeros((0, 3), dtype=np.int64) if body.triangles is None else body.triangles,
        shapes=body.shapes,
        rotations=body.rotation_shapes,
        frequencies=frequencies,
        frequency_error=unknown if found["frequency_error"] is None else found["frequency_error"],
        moments=body.moments,
        corners=body.attachments,
        source=str(data.attrs["source"]),
        notes=tuple(str(data.attrs["notes"]).splitlines()),
        tool=None if found["tool"] is None else int(found["tool"]),
        band=body.band,
        missed=body.missed,
        materials=materials,
        solid=None if found["elements"] is None else Solid(found["elements"], found["parts"], materials),
    )


def save_body(body: FlexibleBody, path: Path, modes: Modes | None = None) -> None:
    """Write a body, and the values that its modes hold beside it, whole or not at all.

    Raises InputError where it cannot be written.
    """
    values = body.moments._asdict() | {name: getattr(body, name) for name in FIELDS}
    values |= dict.fromkeys(MODAL) if modes is None else values_of_modes(modes)
    variables = {
        name: (dims, array_of(name, values[name]), {"units": units, "long_name": words})
        for name, (dims, units, words) in (MOMENTS | FIELDS | MODAL).items()
        if values[name] is not None
    }
    attributes = {
        "format": FORMAT,
        "parflex_version": __version__,
        "units_note": "SI units and radians, in the platform frame",
        **words_of_modes(modes),
    }
    data = xr.Dataset(variables, attrs=attributes)
    data.attrs["checksum"] = checksum(data)
    saved(data, path)


def values_of_modes(modes: Modes) -> dict[str, Any]:
    """The values that modes hold beside a body, None for those that they do not have."""
    found = dict.fromkeys(MODAL) | {
        "frequencies": modes.frequencies,
        "frequency_error": modes.frequency_error,
        "tool": modes.tool,
    }
    if isinstance(modes, ComputedModes) and modes.materials:
        found["materials"] = [(m.young, m.poisson, m.density) for m in modes.materials]
    if isinstance(modes, ComputedModes) and modes.solid is not None:
        found |= {"elements": modes.solid.elements, "parts": modes.solid.parts}
    return found


def words_of_modes(modes: Modes | None) -> dict[str, str]:
    """The words of modes, as attributes of the file; of each material its name and source."""
    materials = modes.materials if isinstance(modes, ComputedModes) else ()
    return {
        "source": "" if modes is None else modes.source,
        "notes": "" if modes is None else "\n".join(modes.notes),
        "material_names": "\n".join(made.name for made in materials),
        "material_sources": "\n".join(made.source for made in materials),
    }


def load_body(path: Path) -> FlexibleBody:
    """The platform of a modal file.

    Raises InputError where the file is missing, truncated, altered, or holds something else.
    """
    return body_of(arrays_of(path.name, opened(path)))


def opened(path: Path) -> xr.Dataset:
    """The file's dataset, as it was written."""
    if not path.is_file():
        raise InputError(f"file is {path.name}, but {path} does not exist; it belongs beside the robot file")
    try:
        data = loaded(path)
    except Exception:  # the HDF5 readers raise many kinds for a damaged file
        raise InputError(f"file is {path.name}, which is damaged or no modal file; write it again") from None
    if str(data.attrs.get("format")) != FORMAT:  # of a damaged file it may be an array
        raise InputError(f"file is {path.name}, which holds no platform of format {FORMAT!r}")
    missing = [name for name in MOMENTS | FIELDS if name not in data and name not in OPTIONAL]
    if missing:
        raise InputError(f"file is {path.name}, which lacks {', '.join(missing)}; write it again")
    try:
        whole = str(data.attrs.get("checksum")) == checksum(data)
    except (ValueError, TypeError):  # words for numbers
        whole = False
    if not whole:
        raise InputError(f"file is {path.name}, which was altered after it was written; write it again")
    return data


def checksum(data: xr.Dataset) -> str:
    """SHA-256 of names, dimensions, values and attributes."""
    digest = hashlib.sha256()
    for name in sorted(map(str, data.variables)):
        variable = data[name]
        words = f"{name}{variable.dims}{variable.shape}{variable.attrs.get('units')}"
        values = np.asarray(variable.values, dtype=np.int64 if name in WHOLE else float)
        digest.update(words.encode() + np.ascontiguousarray(values).tobytes())
    for name in sorted(set(data.attrs) - {"checksum"}):
        digest.update(f"{name}={data.attrs[name]}".encode())
    return digest.hexdigest()


def arrays_of(name: str, data: xr.Dataset) -> dict[str, Any]:
    """The arrays by name, None for those that are not there; only estimates may be unknown."""
    found = {field: data[field].values if field in data else None for field in MOMENTS | FIELDS | MODAL}
    for field, value in found.items():
        if value is not None and field not in UNKNOWN and not np.all(np.isfinite(value)):
            raise InputError(f"file is {name}, whose {field} is not finite; write it again")
    return found


def body_of(found: dict[str, Any]) -> FlexibleBody:
    """The body of its arrays, in C order as they were computed."""
    moments = Moments(float(found["m"]), *(found[field] for field in list(MOMENTS)[1:]))
    attachments = tuple(int(node) for node in found["attachments"])
    rest = {field: found[field] for field in FIELDS if field != "attachments"}
    rest["band"] = None if found["band"] is None else float(found["band"])
    return FlexibleBody(moments, attachments=attachments, **rest)


def stored_materials(found: dict[str, Any], attributes: Mapping[str, Any]) -> tuple[Material, ...]:
    """The materials, with their names and sources, where there are any."""
    if found["materials"] is None:
        return ()
    words = [str(attributes.get(name, "")).split("\n") for name in ("material_names", "material_sources")]
    told: Any = zip_longest(found["materials"].tolist(), *words, fillvalue="")
    return tuple(Material(E, nu, rho, name, source) for (E, nu, rho), name, source in told)


def array_of(name: str, value: Any) -> Array:
    """The value as floats, or as whole numbers where it counts nodes."""
    return np.asarray(value, dtype=np.int64 if name in WHOLE else float)
