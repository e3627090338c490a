"""The variables of a result that are not as the table of variables has them."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from parflex.simulation.variables import ALL_VARIABLES, COORDINATES
from parflex.simulation.variables.variable import Variable

THREE = ("axis", "platform_axis", "base_axis", "corner")  # dimensions of three entries
KNOWN = (*COORDINATES, *ALL_VARIABLES)


def misfits(data: xr.Dataset, known: Sequence[Variable] = KNOWN) -> list[str]:
    """The variables of other dimensions than they should have, that hold no numbers, or point nowhere."""
    return [each.name for each in known if each.name in data and not fits_table(data, each)]


def fits_table(data: xr.Dataset, variable: Variable) -> bool:
    """True where a variable has its dimensions, three entries where it must, and numbers in its range."""
    values, dims = data[variable.name], variable.dims
    if values.dims != dims or any(data.sizes[dim] != 3 for dim in dims if dim in THREE):
        return False
    if variable.text:
        return values.dtype.kind not in "iufc"
    if variable.numbers is not None:
        target, first = variable.numbers
        if values.dtype.kind not in "iu":
            return False
        return bool(np.all((values >= first) & (values < data.sizes.get(target, 0) + first)))
    # holes over time are told, and those instants left out
    return values.dtype.kind in "iuf" and (variable.changes or bool(np.all(np.isfinite(values))))
