"""Power spectral densities from a file of comma-separated values, whose header names inputs with units."""

import os
import re
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from parflex.base import kinds
from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.base.kinds import Kind
from parflex.files.quantity import LONGEST, factor, shown
from parflex.files.sample_file import SPELT, complaint, read_table, unit_of

CLOCK = "f"
FAMILIES = (  # of units of inputs: the quantity and its derivatives, and the unit of its square
    ((kinds.LENGTH, "m^2"), (kinds.SPEED, "m^2/s^2"), (kinds.ACCELERATION, "m^2/s^4")),
    ((kinds.ANGLE, "rad^2"), (kinds.TURN_RATE, "rad^2/s^2"), (kinds.ANGULAR_ACCELERATION, "rad^2/s^4")),
    ((kinds.FORCE, "N^2"),),
    ((kinds.TORQUE, "N^2 m^2"),),
)
PER_HERTZ = re.compile(r"(.+?)\s*/\s*Hz")
SQUARE = re.compile(r"(?:\(\s*(.+)\s*\)|([^\W\d_]+))\s*(?:\^|\*\*)\s*2")
MANY = 10  # rows: fewer are corner points, between which the lines are straight
GAP = 3.5  # times the steps beside it, on both a straight and a logarithmic scale


class Density(NamedTuple):
    """The ways to give the density of an input: as its own square, or that of a derivative."""

    family: tuple[tuple[Kind, str], ...]
    own: int
    orders: dict[str, int]  # by column, as the file has it: noted where the unit is read


def load_psd(path: str | os.PathLike[str], frf: Any) -> Any:
    """The power spectral densities of the inputs of a response (output, input, omega), at its frequencies, of
    a file of comma-separated values: a DataArray (input, omega) for `pf.power_spectrum`.

    Its header is like `f [Hz], base_z [(um/s)^2/Hz], force[0] [N^2/Hz]`: the frequency, and one-sided
    densities of inputs by their labels; inputs without a column rest. Displacements, velocities and
    accelerations, angles likewise, may stand for each other: S_v = (2πf)² S_x. Between rows log S is linear
    in log f.

    Raises InputError, with the line where there is one, for units that are missing or no squares per hertz,
    unknown columns, cells that are no finite numbers, values that are negative, gaps, and frequencies of frf
    beyond the file's.
    """
    import xarray as xr

    if getattr(frf, "dims", None) != ("output", "input", "omega") or "input_units" not in frf.coords:
        raise InputError(
            "frf is no response (output, input, omega) with units; give what lin.frf(omega) returns"
        )
    name, labels = Path(path).name, [str(label) for label in frf.input.values]
    orders: dict[str, int] = {}
    known: dict[str, Any] = {CLOCK: kinds.FREQUENCY}
    known |= {
        label: density(str(unit), orders) for label, unit in zip(labels, frf.input_units.values, strict=True)
    }
    example = f"{CLOCK} [Hz], {labels[0]} [{written(known[labels[0]])}]"
    f, columns = read_table(path, "a file of power spectra", known, unit_of_density, example)
    check_rows(name, f)
    w = frf.omega.values / (2 * np.pi)
    check_band(name, f, w)
    found = np.zeros((len(labels), len(w)))
    for label, values in columns.items():
        if np.any(values < 0):
            k = int(np.argmin(values))
            raise InputError(
                f"{name}: {label} is negative at {f[k]:.6g} Hz; a power spectral density is not negative"
            )
        found[labels.index(label)] = between(w, f, values) * (2 * np.pi * w) ** (2 * orders[label])
    coords = {"input": labels, "omega": ("omega", frf.omega.values, {"units": "rad/s"})}
    coords |= {"psd_units": ("input", [f"({unit})^2/Hz" for unit in frf.input_units.values])}
    return xr.DataArray(found, coords, ("input", "omega"), "psd")


def density(unit: str, orders: dict[str, int]) -> Density:
    """The ways in which the density of an input of this unit may be given."""
    for family in FAMILIES:
        for own, (kind, _) in enumerate(family):
            if kind.unit == unit:
                return Density(family, own, orders)
    raise InputError(f"frf has an input in {unit}, whose power spectra files cannot give; give an array")


def written(density: Density) -> str:
    """The unit of a density as it may be written."""
    return f"{density.family[density.own][1]}/Hz"


def unit_of_density(where: str, name: str, unit: str | None, kind: Kind | Density) -> float:
    """The number of SI units that one unit of a column is; the order of the derivative is noted."""
    if isinstance(kind, Kind):
        return unit_of(where, name, unit, kind)
    instead = f"write {name} [{written(kind)}]"
    if not unit or not unit.strip():
        raise complaint(where, f"column {name} has no unit; {instead}, or another square per hertz")
    plain = unit.strip().replace("²", "^2").replace("⁴", "^4")
    parts = PER_HERTZ.fullmatch(plain) if len(plain) <= LONGEST else None
    if parts is None:
        raise complaint(
            where,
            f"the unit of column {name} is {shown(unit)}, which is no square per Hz; {instead}",
        )
    for order, (quantity, squared) in enumerate(kind.family):
        try:
            found = of_square(parts.group(1), quantity, squared)
        except InputError:
            continue
        kind.orders[name] = kind.own - order
        return found
    words = " or ".join(quantity.words for quantity, _ in kind.family)
    raise complaint(
        where,
        f"the unit of column {name} is {shown(unit)}, which is not the square of {words} per Hz; {instead}",
    )


def of_square(text: str, kind: Kind, squared: str) -> float:
    """The number of SI units of a squared quantity that one of the text is."""
    parts = SQUARE.fullmatch(text.strip())
    if parts is not None:
        unit = next(part for part in parts.groups() if part)
        return factor(text, SPELT.get((kind, unit), unit), kind) ** 2
    return factor(text, text, Kind(f"the square of {kind.words}", squared, squared))


def check_rows(name: str, f: Array) -> None:
    """Raise InputError for frequencies that are too few, not positive, or leave a gap."""
    if len(f) < 2 or f[0] <= 0:
        raise InputError(f"{name} has fewer than two rows, or one at {CLOCK} = 0; give positive frequencies")
    if len(f) < MANY:
        return
    wide = [np.diff(f), np.diff(np.log(f))]
    for k in range(len(f) - 1):
        beside = [j for j in (k - 1, k + 1) if 0 <= j < len(f) - 1]
        if all(step[k] > GAP * max(step[j] for j in beside) for step in wide):
            raise InputError(
                f"{name} has a gap from {f[k]:.6g} to {f[k + 1]:.6g} Hz, where rows beside it are "
                f"{wide[0][beside[0]]:.3g} Hz apart; give the rows between, or corner points alone"
            )


def check_band(name: str, f: Array, w: Array) -> None:
    """Raise InputError where frequencies of a response are beyond those of the file."""
    outside = (w < f[0] * (1 - 1e-9)) | (w > f[-1] * (1 + 1e-9))
    if np.any(outside):
        raise InputError(
            f"{name} goes from {f[0]:.6g} to {f[-1]:.6g} Hz, and frf asks for {w[outside][0]:.6g} Hz; give a "
            f"response inside that band, or more rows"
        )


def between(w: Array, f: Array, values: Array) -> Array:
    """The densities at frequencies w: straight in logarithms, or as they are beside a zero."""
    straight: Array = np.interp(w, f, values)
    if np.any(values <= 0):
        found = np.interp(np.log(w), np.log(f), np.log(np.where(values > 0, values, 1.0)))
        right = np.clip(np.searchsorted(f, w), 1, len(f) - 1)
        zero = (values[right] <= 0) | (values[right - 1] <= 0)
        return np.where(zero, straight, np.exp(found))
    return np.exp(np.interp(np.log(w), np.log(f), np.log(values)))
