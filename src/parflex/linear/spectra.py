"""Random vibration: the power spectra of outputs of those of inputs, and their RMS values."""

import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import finite
from parflex.base.errors import ImplausibleValue, InputError
from parflex.base.nearest import nearest

COARSE = 0.02  # of the RMS: a change, where every other frequency is left out, that tells a grid too coarse
ROUNDOFF = 1e-9  # of the largest entry of a cross-spectral matrix


def power_spectrum(frf: Any, psd: Mapping[str, ArrayLike] | ArrayLike) -> Any:
    """The power spectral densities of outputs under random inputs, and their RMS values, a Dataset.

    frf (output, input, omega) is a response such as `lin.frf(omega)` or `pf.transmissibility(lin,
    node)(omega)` at frequencies dense enough for its peaks. psd holds the densities of the inputs at these
    frequencies, one-sided and per hertz, in SI units such as N²/Hz: by the labels of inputs, numbers or
    arrays (w,), others being zero; or an array (r, w), such as `pf.load_psd` reads, of inputs that are
    uncorrelated; or their full cross-spectral matrix (r, r, w), entries E[x_i x_j*], which is
    `scipy.signal.csd(x_j, x_i)`.

    With S_y = H S H*, psd (output, omega) is its diagonal, rms (output) the root of its integral over the
    band, cumulative_rms (output, omega) that of its integral up to a frequency, and rms_by_input (output,
    input) the part of each of uncorrelated inputs; units are in output_units and psd_units.

    Source: Crandall and Mark, Random Vibration in Mechanical Systems, ch. 2. Raises InputError for values
    that are negative or not finite, other shapes and labels, and a matrix that is no cross-spectral one;
    warns of an `ImplausibleValue` where the frequencies are too coarse for the peaks.
    """
    import xarray as xr

    H, f = checked(frf)
    S = densities(psd, frf, f)
    parts = np.abs(H) ** 2 * S if S.ndim == 2 else None
    spectrum = np.einsum("oiw,ijw,ojw->ow", H, S, H.conj()).real if parts is None else parts.sum(axis=1)
    spectrum = np.maximum(spectrum, 0.0)
    summed = cumulative(spectrum, f)
    rms = np.sqrt(summed[:, -1])
    warn_if_coarse(spectrum, f, rms)
    data: dict[str, Any] = {
        "psd": (("output", "omega"), spectrum, {"long_name": "power spectral density, one-sided, per Hz"}),
        "rms": (("output",), rms, {"long_name": "root mean square in the band"}),
        "cumulative_rms": (
            ("output", "omega"),
            np.sqrt(summed),
            {"long_name": "RMS of all frequencies up to it"},
        ),
    }
    if parts is not None:
        each = np.sqrt(np.stack([cumulative(part, f)[:, -1] for part in np.moveaxis(parts, 1, 0)], axis=1))
        data["rms_by_input"] = (("output", "input"), each, {"long_name": "RMS that an input alone gives"})
    coords: dict[str, Any] = {
        "output": [str(label) for label in frf.output.values],
        "omega": ("omega", 2 * np.pi * f, {"units": "rad/s", "long_name": "circular frequency"}),
        "frequency": ("omega", f, {"units": "Hz", "long_name": "frequency"}),
    }
    coords |= {} if parts is None else {"input": [str(label) for label in frf.input.values]}
    if "output_units" in frf.coords:
        units = [str(unit) for unit in frf.output_units.values]
        coords["output_units"] = ("output", units)
        coords["psd_units"] = ("output", [f"({unit})^2/Hz" for unit in units])
    return xr.Dataset(data, coords)


def checked(frf: Any) -> tuple[Array, Array]:
    """The responses (o, r, w) and their frequencies (w,) Hz."""
    if getattr(frf, "dims", None) != ("output", "input", "omega") or not {"output", "input"} <= set(
        frf.coords
    ):
        raise InputError("frf is no response (output, input, omega); give what lin.frf(omega) returns")
    f = frf.omega.values / (2 * np.pi)
    if len(f) < 3 or not np.all(np.diff(f) > 0):
        raise InputError("frf has fewer than three frequencies, or they do not increase; give a band")
    if not np.all(np.isfinite(frf.values)):
        raise InputError("frf holds values that are not finite; leave those frequencies out")
    return frf.values, f


def densities(psd: Any, frf: Any, f: Array) -> Array:
    """The densities (r, w) of uncorrelated inputs, or their matrix (r, r, w)."""
    labels, w = [str(label) for label in frf.input.values], len(f)
    if isinstance(psd, Mapping):
        return by_label(psd, labels, w)
    if hasattr(psd, "coords") and [str(label) for label in psd.input.values] != labels:
        raise InputError(
            f"psd is of {', '.join(map(str, psd.input.values))}, and frf has the inputs {', '.join(labels)}; "
            f"read it for this frf"
        )
    given, r = getattr(psd, "values", psd), len(labels)
    if isinstance(given, np.ndarray) and given.shape == (r, r, w):
        return cross_spectral(given)
    found = finite("psd", given)
    if found.shape != (r, w):
        raise InputError(
            f"psd has shape {found.shape}; expected ({r}, {w}), inputs by frequencies, or ({r}, {r}, {w})"
        )
    return positive_everywhere(found, labels, f)


def by_label(psd: Mapping[str, ArrayLike], labels: list[str], w: int) -> Array:
    """Densities (r, w) of those that are named."""
    found = np.zeros((len(labels), w))
    for name, given in psd.items():
        if name not in labels:
            close = nearest(str(name), labels)
            words = f"did you mean {close!r}?" if close else f"there are {', '.join(labels)}"
            raise InputError(f"psd names {name!r}, which is no input; {words}")
        values = finite(f"psd[{name!r}]", given)
        if values.shape not in ((), (w,)):
            raise InputError(f"psd[{name!r}] has shape {values.shape}; give a number, or one for each of {w}")
        if np.any(values < 0):
            raise InputError(
                f"psd[{name!r}] is {np.min(values):.4g}; a power spectral density is not negative"
            )
        found[labels.index(name)] = values
    if not psd:
        raise InputError(f"psd is empty; name an input, such as {labels[0]!r}")
    return found


def positive_everywhere(found: Array, labels: list[str], f: Array) -> Array:
    """The densities (r, w); raises InputError where one is negative."""
    if np.any(found < 0):
        i, k = np.unravel_index(np.argmin(found), found.shape)
        raise InputError(
            f"psd of {labels[i]} is {found[i, k]:.4g} at {f[k]:.4g} Hz; power spectra are not negative"
        )
    return found


def cross_spectral(given: Array) -> Array:
    """The matrix (r, r, w); raises InputError where it is no cross-spectral one."""
    if given.dtype.kind not in "iufc" or not np.all(np.isfinite(given)):
        raise InputError("psd holds values that are not finite; leave those frequencies out")
    matrices = np.moveaxis(given, -1, 0)
    near = ROUNDOFF * float(np.max(np.abs(given), initial=0.0))
    if np.max(np.abs(matrices - matrices.conj().swapaxes(1, 2)), initial=0.0) > near:
        raise InputError(
            "psd is no cross-spectral matrix: entries (i, j) and (j, i) are not conjugate; give E[x_i x_j*]"
        )
    if np.min(np.linalg.eigvalsh(matrices), initial=0.0) < -near:
        raise InputError(
            "psd is no cross-spectral matrix: it gives a sum of inputs negative power; check its coherences"
        )
    return given


def cumulative(spectrum: Array, f: Array) -> Array:
    """The integral (o, w) of densities (o, w) up to each frequency, by trapezoids."""
    pieces = 0.5 * (spectrum[:, 1:] + spectrum[:, :-1]) * np.diff(f)
    return np.concatenate([np.zeros((len(spectrum), 1)), np.cumsum(pieces, axis=1)], axis=1)


def warn_if_coarse(spectrum: Array, f: Array, rms: Array) -> None:
    """Warn where every other frequency gives another RMS."""
    kept = np.unique(np.append(np.arange(0, len(f), 2), len(f) - 1))
    fewer = np.sqrt(cumulative(spectrum[:, kept], f[kept])[:, -1])
    change = float(np.max(np.abs(fewer - rms) / np.where(rms > 0, rms, 1.0), initial=0.0))
    if change > COARSE:
        warnings.warn(
            f"frf has too few frequencies for its peaks: without every other one the RMS changes by "
            f"{100 * change:.2g} %; give more, close together about the resonances",
            ImplausibleValue,
            stacklevel=3,
        )
