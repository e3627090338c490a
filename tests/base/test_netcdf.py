"""NetCDF files are read in work that their size bounds."""

import h5netcdf
import pytest

import parflex as pf
from parflex.base.netcdf import loaded


def test_a_file_that_claims_more_than_it_can_hold(tmp_path):
    """Eight terabytes that nobody wrote: HDF5 would make room for all of them."""
    path = tmp_path / "run.nc"
    with h5netcdf.File(path, "w") as file:
        file.dimensions = {"time": 10**12}
        file.create_variable("position", ("time",), "f8", chunks=(10**6,))
    with pytest.raises(ValueError, match=r"claim 8\.0e\+12 bytes"):
        loaded(path)
    with pytest.raises(pf.InputError, match=r"run\.nc is damaged or no NetCDF-4 file: its variables claim"):
        pf.load_result(path)
