"""The change of frequencies from a coarser mesh, which estimates their error."""

from dataclasses import replace

import numpy as np

from parflex.base.array import Array
from parflex.fe.body.basis import ComputedModes, reduction_of
from parflex.fe.body.free_body import FreeBody


def change(frequencies: Array, coarse: Array) -> Array:
    """The relative change (N,) of frequencies (N,) from coarse ones (any number), NaN where there is none."""
    known = min(len(frequencies), len(coarse))
    found = np.full(len(frequencies), np.nan)
    found[:known] = np.abs(coarse[:known] / frequencies[:known] - 1.0)
    return found


def with_mesh_error(modes: ComputedModes, coarse: FreeBody) -> ComputedModes:
    """The same modes, with the change of the free–free ones' frequencies from a coarser mesh.

    Raises InputError where their model is not at hand, or the coarser mesh cannot carry them.
    """
    n = reduction_of(modes).basis.n
    found = change(modes.frequencies, np.sqrt(coarse.free_modes(n)[0][:n]))
    return replace(modes, frequency_error=found)
