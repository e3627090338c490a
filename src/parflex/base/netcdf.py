"""NetCDF-4 files: written whole, and read whole, in work that their size bounds."""

import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from parflex.base.writing import replacing

if TYPE_CHECKING:
    import h5py
    import xarray as xr

GROWN = 1000  # times the file's size: more than what compressed numbers hold


def saved(dataset: "xr.Dataset", path: str | os.PathLike[str]) -> Path:
    """Write a dataset, whole or not at all; an older file is replaced.

    Raises InputError where the file cannot be written.
    """
    target = Path(path)
    data = dataset.to_netcdf(engine="h5netcdf")  # in memory: HDF5 ends the process on a full disk
    with replacing(target) as part:
        part.write(data)
    return target


def loaded(path: str | os.PathLike[str]) -> "xr.Dataset":
    """The dataset of a file.

    Raises what the HDF5 readers raise for a damaged one, which is of many kinds, and ValueError for a file
    that claims to hold far more than its size allows.
    """
    import xarray as xr

    check_texts(Path(path))
    with xr.open_dataset(path, engine="h5netcdf") as found:
        if found.nbytes > GROWN * os.path.getsize(path):
            raise ValueError(f"its variables claim {found.nbytes:.1e} bytes, which its size cannot hold")
        return found.load()


def check_texts(path: Path) -> None:
    """Raise ValueError where the texts of a variable claim more bytes than the file has.

    HDF5 makes room for a text, and fills it with zeros, before it looks for it: 4 GB for one wrong byte.
    """
    import h5py

    size = path.stat().st_size
    with h5py.File(path) as file:
        for name, variable in file.items():
            if isinstance(variable, h5py.Dataset) and variable.dtype.hasobject:
                if h5py.check_string_dtype(variable.dtype) is None:
                    raise ValueError(f"its {name} is neither numbers nor text")
                claimed = text_bytes(path, variable, size)
                if claimed > size:
                    raise ValueError(f"the texts of its {name} claim {claimed:.1e} bytes, more than it has")


def text_bytes(path: Path, variable: "h5py.Dataset", most: int) -> int:
    """Bytes that the texts of a variable claim: each element is the length of a text, and where it is.

    Nothing is known of compressed ones, whose checksums tell a wrong byte.
    """
    claimed = 0
    for offset, stored, count in stretches(variable):
        if stored > most:
            return stored
        raw = np.fromfile(path, np.uint8, stored, offset=offset)
        claimed += int(raw.reshape(count, -1)[:, :4].copy().view("<u4").sum())
    return claimed


def stretches(variable: "h5py.Dataset") -> list[tuple[int, int, int]]:
    """Offsets of a variable in its file, with the bytes and the elements there."""
    offset, stored = variable.id.get_offset(), variable.id.get_storage_size()
    if offset is not None:
        return [(offset, stored, variable.size)]
    if variable.chunks is None or variable.id.get_create_plist().get_nfilters():
        return []
    chunks: list[h5py.h5d.StoreInfo] = []
    variable.id.chunk_iter(chunks.append)
    return [(chunk.byte_offset, chunk.size, int(np.prod(variable.chunks))) for chunk in chunks]
