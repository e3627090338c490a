"""A platform with its modes in a NetCDF-4 file, every number to the last bit."""

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from parflex.array import Array
from parflex.body import FlexibleBody
from parflex.errors import InputError
from parflex.files.writing import replacing
from parflex.modes import Moments

FORMAT = "parflex-body-1"

MODE, OTHER, NODE, AXIS, AXIS_2 = "mode", "other_mode", "node", "axis", "other_axis"

# what a body holds: dimensions, units, meaning
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
    "triangles": (("triangle", "corner"), "1", "surface, node numbers from 0"),
}
OPTIONAL = ("rotation_shapes", "triangles")


def save_body(body: FlexibleBody, path: Path) -> None:
    """Write a body whole or not at all; raises InputError where it cannot be written."""
    values = body.moments._asdict() | {name: getattr(body, name) for name in FIELDS}
    variables = {
        name: (dims, array_of(name, values[name]), {"units": units, "long_name": words})
        for name, (dims, units, words) in (MOMENTS | FIELDS).items()
        if values[name] is not None
    }
    with replacing(path) as part:
        xr.Dataset(variables, attrs={"format": FORMAT}).to_netcdf(part, engine="h5netcdf")


def load_body(path: Path) -> FlexibleBody:
    """A body that `save_body` wrote.

    Raises InputError where the file is missing, damaged, or holds something else.
    """
    if not path.is_file():
        raise InputError(f"file is {path.name}, but {path} does not exist; it belongs beside the robot file")
    try:
        with xr.open_dataset(path, engine="h5netcdf") as opened:
            data = opened.load()
    except Exception:  # the HDF5 readers raise many kinds for a damaged file
        raise InputError(f"file is {path.name}, which is damaged or no NetCDF-4 file") from None
    if data.attrs.get("format") != FORMAT:
        raise InputError(f"file is {path.name}, which holds no platform of format {FORMAT!r}")
    missing = [name for name in MOMENTS | FIELDS if name not in data and name not in OPTIONAL]
    if missing:
        raise InputError(f"file is {path.name}, which lacks {', '.join(missing)}; write it again")
    found = {name: data[name].values if name in data else None for name in MOMENTS | FIELDS}
    return body_of(path.name, found)


def body_of(name: str, found: dict[str, Any]) -> FlexibleBody:
    """The body of its arrays, in C order as they were computed."""
    for field, value in found.items():
        if value is not None and not np.all(np.isfinite(value)):
            raise InputError(f"file is {name}, whose {field} is not finite; write it again")
    moments = Moments(float(found["m"]), *(found[field] for field in list(MOMENTS)[1:]))
    attachments = tuple(int(node) for node in found["attachments"])
    rest = {field: found[field] for field in FIELDS if field != "attachments"}
    return FlexibleBody(moments, attachments=attachments, **rest)


def array_of(name: str, value: Any) -> Array:
    """Floats, or whole numbers for what counts nodes."""
    return np.asarray(value, dtype=np.int64 if name in ("attachments", "triangles") else float)
