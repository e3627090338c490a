"""NetCDF files are read in work that their size bounds."""

import h5netcdf
import h5py
import numpy as np
import pytest
import xarray as xr

import parflex as pf
from parflex.base.netcdf import loaded, stretches

WORDS = xr.Dataset({"axis": ("axis", ["x", "y", "z"]), "name": ((), "leg 1"), "none": ("nothing", [""][:0])})


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


@pytest.mark.parametrize("chunks", [None, (2,)])
@pytest.mark.parametrize("element", range(3))
def test_a_text_that_claims_more_than_the_file_has(chunks, element, tmp_path):
    """Wherever a length is, HDF5 would make room for four gigabytes."""
    path = tmp_path / "words.nc"
    WORDS.to_netcdf(path, engine="h5netcdf", encoding={"axis": {"chunksizes": chunks}})
    assert loaded(path).identical(WORDS)
    with h5py.File(path) as file:
        at = [
            offset + i * stored // count
            for offset, stored, count in stretches(file["axis"])
            for i in range(count)
        ]
    data = bytearray(path.read_bytes())
    data[at[element] + 3] = 255
    path.write_bytes(data)
    with pytest.raises(ValueError, match=r"the texts of its axis claim 4\.3e\+09 bytes, more than it has"):
        loaded(path)


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
@pytest.mark.parametrize("zlib", [False, True])
def test_texts_that_others_wrote(engine, zlib, tmp_path):
    """A result is read again after xarray, or netCDF-C, wrote it anew, compressed or not."""
    path = tmp_path / "words.nc"
    WORDS.to_netcdf(path, engine=engine, encoding={name: {"zlib": zlib} for name in WORDS.variables})
    assert loaded(path).identical(WORDS)


def test_what_is_neither_numbers_nor_text(tmp_path):
    """Lists of numbers of any length are stored as texts are, and nothing here writes them."""
    path = tmp_path / "lists.nc"
    with h5netcdf.File(path, "w") as file:
        file.dimensions = {"time": 2}
        lists = h5py.vlen_dtype(np.int32)
        file._h5file.create_dataset("lists", (2,), lists)[0] = np.arange(3)
    with pytest.raises(ValueError, match="its lists is neither numbers nor text"):
        loaded(path)
