"""NetCDF-4 files read whole, in work that their size bounds."""

import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray as xr

GROWN = 1000  # times the file's size: more than what compressed numbers hold


def loaded(path: str | os.PathLike[str]) -> "xr.Dataset":
    """The dataset of a file.

    Raises what the HDF5 readers raise for a damaged one, which is of many kinds, and ValueError for a file
    that claims to hold far more than its size allows.
    """
    import xarray as xr

    with xr.open_dataset(path, engine="h5netcdf") as found:
        if found.nbytes > GROWN * os.path.getsize(path):
            raise ValueError(f"its variables claim {found.nbytes:.1e} bytes, which its size cannot hold")
        return found.load()
