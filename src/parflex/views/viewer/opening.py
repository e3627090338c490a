"""A result as far as it can be read, and what is missing from it, in words."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from parflex.base.absent import absent
from parflex.base.errors import InputError
from parflex.base.netcdf import loaded
from parflex.simulation.result import FORMAT
from parflex.views.viewer.layout import KNOWN, misfits

ESSENTIAL = ("position", "rotation")  # without these there is no robot to draw
TRUNCATED = re.compile(r"truncated file: eof = (\d+).*stored_eof = (\d+)")

MISSED = {each.name: each.missed for each in KNOWN if each.missed}  # in words
PER_INSTANT = (
    *(each.name for each in KNOWN if each.missed and each.changes),
    *("leg_deformation", "base_position", "base_rotation"),
)


class Opened(NamedTuple):
    """A result without what could not be read, and a sentence for each thing that is amiss."""

    dataset: xr.Dataset
    notes: tuple[str, ...]

    @staticmethod
    def nothing(why: str) -> "Opened":
        """The sentence that is shown where there is nothing to show."""
        return Opened(xr.Dataset(), (why,))


def opened(path: Path) -> Opened:
    """The result in a file: whole, partial, of another version, with variables missing.

    Raises InputError where the file is missing or cannot be read; of one that was cut off nothing can,
    since HDF5 keeps its index at the end.
    """
    if path.is_dir():
        raise InputError(f"{path} is a folder; give a result in it, {path / 'result.nc'} for instance")
    try:
        dataset = loaded(path)
    except FileNotFoundError:
        raise InputError(absent(path)) from None
    except Exception as error:  # the HDF5 readers raise many kinds for a damaged file
        raise InputError(f"{path} {damage(str(error) or type(error).__name__)}") from None
    return judged(dataset)


@contextmanager
def showing(path: Path) -> Iterator[None]:
    """Turn the errors of drawing a result whose variables do not fit together into one of input."""
    try:
        yield
    except InputError:
        raise
    except Exception as error:
        words = next(iter(str(error).splitlines()), "")
        raise InputError(
            f"{path} cannot be shown, its variables do not fit together: run the simulation again "
            f"({type(error).__name__}: {words[:200]})"
        ) from error


def damage(words: str) -> str:
    """The fault of a file, from the words of the HDF5 reader."""
    cut = TRUNCATED.search(words)
    if cut:
        return (
            f"is truncated: {cut[1]} of its {cut[2]} bytes are there, and its index, which stood at the end, "
            f"is not; copy it again, or run the simulation again"
        )
    reason = re.search(r"\(([^()]*)\)", words.splitlines()[0])
    return f"is damaged or no NetCDF-4 file: {reason[1] if reason else words.splitlines()[0]}"


def judged(dataset: xr.Dataset) -> Opened:
    """A dataset with what is to be said about it."""
    notes = []
    version = str(dataset.attrs.get("format"))  # of a damaged file it may be an array
    if version != FORMAT:
        notes.append(
            f"This file has format {version!r}, this parflex reads {FORMAT!r}: what both know is shown."
        )
    if np.any(dataset.attrs.get("partial")):
        why = str(dataset.attrs.get("stopped", "")) or "for a reason that the file does not tell"
        notes.append(f"Partial: the run stopped {why}.")
    strange = misfits(dataset)
    if strange:
        notes.append(f"Not what a result has there, and left out: {named(strange)}.")
    notes += incomplete(dataset, strange)
    return Opened(dataset.drop_vars(strange), tuple(notes))


def named(variables: list[str]) -> str:
    """Variables in words with their names; those that no view needs, by their names alone."""
    return ", ".join(f"{MISSED[name]} ({name})" if name in MISSED else name for name in variables)


def incomplete(dataset: xr.Dataset, strange: list[str]) -> list[str]:
    """A sentence about variables that the view needs and the file lacks, and one about entries that are
    not finite."""
    if not dataset.sizes.get("time", 1):
        return ["No instants: the run ended before its first."]
    lost = [name for name in MISSED if name not in dataset]
    notes = []
    if "platform_triangle" in {*lost, *strange}:
        lost = [name for name in lost if name != "platform_triangle"]
        notes.append("No platform mesh (platform_triangle): the platform is shown by its nodes.")
    if lost:
        notes.append(f"Missing: {named(lost)}.")
    there = [name for name in PER_INSTANT if name in dataset and name not in strange]
    broken = [name for name in there if not np.all(np.isfinite(dataset[name]))]
    if broken:
        notes.append(f"Not finite at some instants, which are left out: {named(broken)}.")
    return notes
