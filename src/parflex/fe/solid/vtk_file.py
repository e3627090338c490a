"""Recovered fields for ParaView: a .vtu file for each time and a .pvd file that lists them."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from parflex.base.array import Array
from parflex.base.check import finite, of_type
from parflex.base.errors import InputError
from parflex.base.extra import extra
from parflex.base.progress import Progress
from parflex.base.writing import replacing
from parflex.fe.solid.recovery import Fields, mesh_of, recover
from parflex.robot.modes import Modes

VOIGT = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))  # VTK's order of symmetric tensors


class HasDataset(Protocol):
    """A run of a robot: anything with a dataset of elastic coordinates in time, such as `pf.Result`."""

    @property
    def dataset(self) -> Any:
        """A mapping to arrays: elastic (time, mode) and time (time,) s."""


def write_fields(
    modes: Modes, result: HasDataset, path: str | os.PathLike[str], times: Sequence[float] | None = None
) -> list[Path]:
    """Displacement (m), strain, stress and von Mises stress (Pa) of a run on a solid, for ParaView.

    path is that of the .pvd file; beside it come files NAME_0000.vtu and so on, one for each of `times`
    (s), by default all of the run; each is the nearest output time. Warp by `displacement`.

    Raises InputError where the modes are not the run's or have no elements, for times outside the run,
    where a file cannot be written, and where meshio is not installed.
    """
    of_type("modes", modes, Modes)
    target = Path(path)
    if target.suffix != ".pvd":
        raise InputError(f"path is {target.name}; it must end with .pvd")
    elastic, clock = result.dataset["elastic"].values, result.dataset["time"].values
    if elastic.shape[1] != len(modes.frequencies):
        raise InputError(
            f"modes are {len(modes.frequencies)}, the run has {elastic.shape[1]}: it is another's"
        )
    rows = (
        range(len(clock))
        if times is None
        else [nearest_time(clock, time) for time in np.atleast_1d(finite("times", times))]
    )
    files = []
    with Progress("fields", len(rows)) as bar:
        for number, row in enumerate(rows):
            file = target.with_name(f"{target.stem}_{number:04d}.vtu")
            write_vtu(modes, recover(modes, elastic[row]), file)
            files.append(file)
            bar.to(number + 1)
    with replacing(target) as part:
        part.write(collection([float(clock[row]) for row in rows], files).encode())
    return [target, *files]


def nearest_time(clock: Array, time: float) -> int:
    """The output time's number. Raises InputError for a time outside the run."""
    if not clock[0] - 1e-9 <= time <= clock[-1] + 1e-9:
        raise InputError(f"times has {time} s; the run goes from {clock[0]} to {clock[-1]} s")
    return int(np.argmin(np.abs(clock - time)))


def write_vtu(modes: Modes, fields: Fields, file: Path) -> None:
    """One file of fields at the nodes."""
    meshio = extra("meshio", "meshio is not installed, which writes fields; pip install 'parflex[solids]'")
    mesh = mesh_of(modes)
    count = len(mesh.nodes)
    rows, columns = zip(*VOIGT, strict=True)
    data = {
        "displacement": fields.displacement[:count],
        "strain": fields.strain[:count, rows, columns],
        "stress": fields.stress[:count, rows, columns],
        "von Mises": fields.mises[:count],
    }
    whole = meshio.Mesh(
        mesh.nodes, {"tetra10": mesh.elements}, point_data=data, cell_data={"part": [mesh.parts]}
    )
    with replacing(file) as part:
        whole.write(part.name, file_format="vtu")  # meshio opens files by name


def collection(times: list[float], files: list[Path]) -> str:
    """ParaView's list of files in time."""
    rows = [
        f'    <DataSet timestep="{time!r}" part="0" file="{file.name}"/>'
        for time, file in zip(times, files, strict=True)
    ]
    head = ['<?xml version="1.0"?>', '<VTKFile type="Collection" version="0.1">', "  <Collection>"]
    return "\n".join([*head, *rows, "  </Collection>", "</VTKFile>", ""])
