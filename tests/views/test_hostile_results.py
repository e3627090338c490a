"""Results and modal files spoilt at random: shown as far as they go, or refused by this library's errors.

`PARFLEX_FUZZ=5000 pytest tests/views/test_hostile_results.py -m ''` spoils as many as it says.
"""

import os
import time
import warnings
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import parflex as pf
from hostile import other_dataset
from parflex.app import paper
from parflex.fe.modal_file import load_body
from parflex.views.report import report_of
from spoil import spoilt

COUNT = int(os.environ.get("PARFLEX_FUZZ", "60"))
LONGEST = 2.0  # s of this process, for what is refused; a page and a report take longer by themselves


def state_of(path: Path) -> None:
    result = pf.load_result(path)
    repr(result)
    result.state(0)


DOORS = {  # and how many times as long as reading they take
    "result": (state_of, 1),
    "modes": (pf.fe.read_modes, 1),
    "platform": (load_body, 1),
    "view": (lambda path: pf.view(path, curves=False), 10),
    "report": (report_of, 20),
}


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> dict[str, Path]:
    """The first instants of the paper's run, and its platform."""
    folder = tmp_path_factory.mktemp("whole")
    run = paper.run(1)
    short = run.result.dataset.isel(time=slice(0, 3))
    result = pf.Result(lambda: short, run.result.stopped).save(folder / "result.nc")
    modes = pf.fe.write_modes(run.modes, folder / "modes.nc")
    return {"modes": modes, "platform": modes} | dict.fromkeys(("result", "view", "report"), result)


def answers(read, path: Path) -> str:
    start = time.process_time()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            read(path)
        return "read"
    except pf.InputError as error:
        taken = time.process_time() - start
        if "\n" in str(error) or len(str(error)) > 1000:
            return f"refused badly: {error}"
        return "refused" if COUNT <= 60 or taken < LONGEST else f"refused after {taken:.1f} s"
    except Exception as error:
        return f"{type(error).__name__}: {error}"


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:Exception ignored in.*File.close")  # h5netcdf on what it did not open
@pytest.mark.parametrize("kind", DOORS)
def test_spoilt_files_are_read_or_refused(whole, kind, tmp_path):
    rng = np.random.default_rng(5)
    data, path = whole[kind].read_bytes(), tmp_path / f"spoilt{whole[kind].suffix}"
    with xr.open_dataset(whole[kind], engine="h5netcdf") as opened:
        dataset = opened.load()
    odd, told = [], {"read": 0, "refused": 0}
    read, price = DOORS[kind]
    for number in range(max(10, COUNT // price)):
        if rng.random() < 0.5:
            path.write_bytes(spoilt(data, rng))
        else:
            try:
                path.write_bytes(other_dataset(dataset, rng).to_netcdf(engine="h5netcdf"))
            except ValueError:  # xarray itself refuses it
                continue
        said = answers(read, path)
        if said in told:
            told[said] += 1
        else:
            odd.append((number, said))
    assert odd == []
    assert min(told.values()) > 0
