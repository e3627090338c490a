"""A picture of random vibration: power spectra, and the RMS that has gathered up to each frequency."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure

from parflex.base.errors import InputError
from parflex.views.plot.canvas import COLOURS, STYLES, figure
from parflex.views.plot.entries import NOTHING, chosen, common, raised

if TYPE_CHECKING:
    import xarray as xr

MOST = len(COLOURS)  # curves


def power_spectrum(
    data: "xr.Dataset | Mapping[str, xr.Dataset]", *, outputs: Sequence[str] | None = None
) -> Figure:
    """Power spectral densities of outputs as `pf.power_spectrum` gives them, or of several by name, over
    frequency, and below the RMS of all frequencies up to each; outputs of unlike units stand side by side.

    Raises InputError for another dataset, unknown outputs, and more curves than a picture holds.
    """
    given: dict[str, Any] = dict(data) if not hasattr(data, "data_vars") else {"": data}
    for each in given.values():
        if not {"psd", "cumulative_rms"} <= set(getattr(each, "data_vars", ())):
            raise InputError("data holds no power spectra; give what pf.power_spectrum returns")
    labels = chosen("outputs", outputs, next(iter(given.values())).output.values) if given else []
    for name, each in given.items():
        chosen(f"outputs of {name!r}", labels, each.output.values)
    if not 1 <= len(labels) * len(given) <= MOST:
        raise InputError(
            f"data holds {len(labels)} outputs of {len(given)} systems, and a picture {MOST} curves; choose "
            f"some with outputs=[…]"
        )
    units: dict[str, list[str]] = {}
    for label in labels:
        units.setdefault(unit_of(next(iter(given.values())), label), []).append(label)
    fig = figure(max(6.4, 4.6 * len(units)), 5.2)
    grid = fig.subplots(2, len(units), sharex=True, squeeze=False, height_ratios=(3, 2))
    place, at = common(labels), 0
    for (upper, lower), (unit, own) in zip(grid.T, units.items(), strict=True):
        for label in own:
            for name, each in given.items():
                f, one = each.omega.values / (2 * np.pi), each.sel(output=label)
                rms = float(one.rms)
                words = f"{label.removeprefix(place)}, RMS {rms:.3g} {raised(unit)}{name and f', {name}'}"
                style = dict(color=COLOURS[at], linestyle=STYLES[at % len(STYLES)], lw=1.2)
                at += 1
                if rms <= NOTHING * max(float(each.rms.sel(output=other)) for other in own):
                    upper.plot([], [], " ", label=f"{label.removeprefix(place)}: none")
                    continue
                shown = (f > 0) & (one.psd.values > 0)
                upper.plot(f[shown], one.psd.values[shown], label=words, **style)
                lower.plot(f[f > 0], one.cumulative_rms.values[f > 0], **style)
        square = f"({raised(unit)})²" if set(unit) & set("/ ") else f"{unit}²"
        upper.set(xscale="log", yscale="log", ylabel=f"power spectral density ({square}/Hz)")
        lower.set(xscale="log", ylabel=f"RMS up to\nthe frequency ({raised(unit)})", xlabel="frequency (Hz)")
        lower.set_ylim(bottom=0)
        lower.ticklabel_format(axis="y", scilimits=(-2, 3))
        for ax in (upper, lower):
            ax.margins(x=0)
            ax.grid(alpha=0.3)
            ax.grid(which="minor", axis="x", alpha=0.12)
        fig.align_ylabels([upper, lower])
        upper.legend(frameon=False, fontsize=8, handlelength=2.6)
    where = f" of {place.removesuffix('_')}" if place else ""
    fig.suptitle(f"Random vibration{where}: one-sided power spectra, and cumulative RMS", fontsize=10)
    return fig


def unit_of(data: Any, label: str) -> str:
    """The unit of an output."""
    return str(data.output_units.sel(output=label).item()) if "output_units" in data.coords else "SI"
