"""The result of a simulation: a labelled dataset, saved as NetCDF-4."""

import os
from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from parflex.base.absent import absent
from parflex.base.errors import InputError
from parflex.base.netcdf import loaded, saved
from parflex.robot.state import State

FORMAT = "parflex-result-1"
STATE = {  # the instants and the variables of states, with their dimensions beside time
    "time": (),
    "position": ("axis",),
    "rotation": ("axis", "platform_axis"),
    "twist": ("component",),
    "elastic": ("mode",),
    "elastic_rate": ("mode",),
}
LEGS = {  # the variables of states that a result may tell of its legs, and where a state has them
    "joint": ("joints", "joint_number"),
    "joint_rate": ("joint_rates", "joint_number"),
    "leg_elastic": ("leg_elastic", "leg_mode"),
    "leg_elastic_rate": ("leg_elastic_rate", "leg_mode"),
}


class Result:
    """A run: `dataset` (xarray), whether it is `partial`, and why it `stopped`."""

    def __init__(self, make: Callable[[], xr.Dataset], stopped: str) -> None:
        self._make = make
        self.stopped = stopped  # why the run ended early; empty where it did not

    def __repr__(self) -> str:
        time = self.dataset["time"].values
        span = f"{len(time)} instants up to {time[-1]:.4g} s" if len(time) else "nothing"
        return f"Result: {span}, {len(self.dataset)} variables" + f"\n  {self.stopped}" * self.partial

    @cached_property
    def dataset(self) -> xr.Dataset:
        """The run with labels and units; put together at the first look."""
        return self._make()

    @property
    def partial(self) -> bool:
        """True where the run ended before its last output time."""
        return bool(self.stopped)

    def state(self, index: int) -> State:
        """The state at an output time, with joints and bending of legs; negative numbers count from the end.

        Raises InputError where there is no such time.
        """
        count = self.dataset.sizes["time"]
        if not isinstance(index, int | np.integer) or not -count <= index < count:
            raise InputError(f"index is {index!r}; this result has {count} times, 0 … {count - 1}")
        at = self.dataset.isel(time=index)
        arrays: dict[str, Any] = {name: at[name].values for name in STATE if name != "time"}
        for name, (field, _) in LEGS.items():
            if name in at:
                arrays[field] = tuple(row[np.isfinite(row)] for row in at[name].values)
        return State(**arrays)

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the dataset as NetCDF-4, whole or not at all; an older file is replaced.

        Raises InputError where the file cannot be written.
        """
        return saved(self.dataset, path)


class RunStopped(Exception):
    """A simulation ended early: `result` holds what was reached, and the cause is the error that ended it."""

    def __init__(self, result: Result) -> None:
        super().__init__(f"the run stopped {result.stopped}; what was reached is in the error's .result")
        self.result = result


def load_result(path: str | os.PathLike[str]) -> Result:
    """A result that `Result.save` wrote.

    Raises InputError where the file is missing, truncated, or not a parflex result.
    """
    try:
        dataset = loaded(path)
    except FileNotFoundError:
        raise InputError(absent(Path(path))) from None
    except Exception as error:  # the HDF5 readers raise many kinds for a damaged file
        reason = str(error).split(" (")[0].splitlines()[0] if str(error) else type(error).__name__
        raise InputError(f"{path} is damaged or no NetCDF-4 file: {reason}") from None
    if str(dataset.attrs.get("format")) != FORMAT:  # of a damaged file it may be an array
        raise InputError(
            f"{path} is no result of this version of parflex (format "
            f"{dataset.attrs.get('format')!r}, expected {FORMAT!r})"
        )
    known = STATE | {name: ("leg", dim) for name, (_, dim) in LEGS.items() if name in dataset}
    unfit = [name for name, dims in known.items() if not is_state(dataset, name, dims)]
    if unfit or "stopped" not in dataset.attrs:
        lost = ", ".join(unfit) or "the word how the run ended"
        raise InputError(f"{path} is damaged: {lost} is not as it was saved; run it again")
    return Result(lambda: dataset, str(dataset.attrs["stopped"]))


def is_state(data: xr.Dataset, name: str, dims: tuple[str, ...]) -> bool:
    """True where a variable is numbers over time and these dimensions, as a state has them."""
    found = data.variables.get(name)
    return found is not None and found.dtype.kind in "iuf" and found.dims == ("time", *dims)
