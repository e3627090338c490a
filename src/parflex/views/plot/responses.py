"""A picture of frequency responses: magnitude and phase over frequency."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MultipleLocator, NullFormatter

from parflex.base.array import Array
from parflex.views.plot.canvas import COLOURS, STYLES, figure
from parflex.views.plot.entries import UNIT_OF_GAIN, Entry, Words, entries_of

if TYPE_CHECKING:
    import xarray as xr

FEW = 6  # curves that share axes
TALL = 3  # rows of outputs that still have room for their phases


def bode(
    frf: "xr.DataArray | Mapping[str, xr.DataArray]",
    *,
    outputs: Sequence[str] | None = None,
    inputs: Sequence[str] | None = None,
    decibels: bool = False,
) -> Figure:
    """Magnitude and unwrapped phase over frequency, of `lin.frf(omega)`, or of several systems by name:
    `bode({"open": frf, "closed": other})`.

    outputs and inputs choose entries by label, 36 at most. A few of one unit share their axes; others stand
    in a grid, outputs down and inputs across, with phases where there are up to three outputs. Magnitudes are
    in the entries' units, or in decibels of these.

    Raises InputError for what is no frequency response, unknown labels, and too many entries.
    """
    rows, names = entries_of(frf, outputs, inputs)
    every, words = [each for row in rows for each in row], Words.of(rows)
    loud = [each for each in every if not each.silent]
    if len(loud) * len(names) <= FEW and len({each.unit for each in loud}) == 1:
        fig = together(loud, names, decibels, words)
        if len(loud) < len(every):
            none = ", ".join(words.entry(each) for each in every if each.silent)
            fig.axes[0].set_title(f"{fig.axes[0].get_title()}\nnone: {none}", fontsize=9)
        return fig
    return bode_grid(rows, names, decibels)


def together(entries: list[Entry], names: list[str], decibels: bool, words: Words) -> Figure:
    """Entries of one unit in one pair of axes."""
    fig = figure(7.0, 4.8)
    upper, lower = fig.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    alone = len(entries) == 1
    for k, entry in enumerate(entries):
        for j, name in enumerate(names):
            at = k * len(names) + j
            parts = [name] if alone else [words.entry(entry), name]
            style = dict(color=COLOURS[at], linestyle=STYLES[at], label=", ".join(filter(None, parts)))
            draw(upper, lower, *entry.curves[name], decibels, style)
    upper.set_ylabel(f"magnitude ({magnitude_unit(entries[0].unit, decibels)})")
    lower.set_ylabel("phase (deg)")
    lower.set_xlabel("frequency (Hz)")
    finish(upper, lower, decibels)
    what = f"Frequency response {words.entry(entries[0])}" if alone else "Frequency responses"
    upper.set_title(what + words.place, fontsize=10)
    if not alone or len(names) > 1:
        legend_below(fig, upper, 3)
    fig.align_ylabels([upper, lower])
    return fig


def bode_grid(rows: list[list[Entry]], names: list[str], decibels: bool) -> Figure:
    """Entries in a grid of outputs and inputs."""
    phases = len(rows) <= TALL
    count, wide, words = len(rows), len(rows[0]), Words.of(rows)
    fig = figure(max(5.0, 2.35 * wide + 0.9), (3.2 if phases else 1.75) * count + 0.9)
    ratios = (3, 2) * count if phases else (1,) * count
    grid = fig.subplots(len(ratios), wide, sharex=True, squeeze=False, height_ratios=ratios)
    for i, row in enumerate(rows):
        for k, entry in enumerate(row):
            upper = grid[2 * i if phases else i, k]
            lower = grid[2 * i + 1, k] if phases else None
            cell(upper, lower, entry, names, decibels, words)
    for ax in grid[-1]:
        ax.set_xlabel("frequency (Hz)", fontsize=8)
    what = "Magnitude (above) and phase in degrees (below)" if phases else "Magnitude"
    more = "" if phases else f"; choose up to {TALL} outputs to see phases, too"
    fig.suptitle(f"{what} over frequency, input → output{words.place}{more}", fontsize=10)
    shown = next((ax for ax in grid.flat if ax.lines), None)
    if shown is not None and any(names):
        legend_below(fig, shown, len(names))
    return fig


def legend_below(fig: Figure, ax: Axes, columns: int) -> None:
    """A legend of the curves of some axes, under the figure."""
    handles, labels = ax.get_legend_handles_labels()
    where = dict(loc="outside lower center", ncols=columns)
    fig.legend(handles, labels, frameon=False, fontsize=8, handlelength=2.6, **where)


def heading(ax: Axes, text: str, unit: str, most: float, broad: int) -> None:
    """A title that is as small as its line needs, `broad` characters at `most` points."""
    lines = f"{text} ({unit})".split("\n") if len(text) + len(unit) < broad else [text, f"({unit})"]
    longest = max(len(line) for line in lines)
    ax.set_title("\n".join(lines), fontsize=max(4.5, min(most, most * broad / longest)))


def cell(
    upper: Axes, lower: Axes | None, entry: Entry, names: list[str], decibels: bool, words: Words
) -> None:
    """One entry of a grid."""
    heading(upper, words.entry(entry), magnitude_unit(entry.unit, decibels), 8.0, 34)
    for ax in filter(None, (upper, lower)):
        ax.tick_params(labelsize=7)
    if entry.silent:
        for ax in filter(None, (upper, lower)):
            ax.set_xscale("log")
            ax.set_yticks([])
        upper.text(0.5, 0.5, "none", transform=upper.transAxes, ha="center", color="0.4", fontsize=8)
        return
    for j, name in enumerate(names):
        style = dict(color=COLOURS[j], linestyle=STYLES[j % len(STYLES)], label=name)
        draw(upper, lower, *entry.curves[name], decibels, style)
    finish(upper, lower, decibels)


def draw(
    upper: Axes, lower: Axes | None, f: Array, H: Array, decibels: bool, style: Mapping[str, Any]
) -> None:
    """A curve of magnitude, and one of phase."""
    size = np.abs(H)
    size = np.where(size > 0, size, np.nan)
    upper.plot(f, 20 * np.log10(size) if decibels else size, lw=1.2, **style)
    if lower is not None:
        phase = np.degrees(np.unwrap(np.angle(H)))
        lower.plot(f, phase - 360.0 * np.ceil((phase[0] - 180.0 - 1e-6) / 360.0), lw=1.2, **style)


def finish(upper: Axes, lower: Axes | None, decibels: bool) -> None:
    """Scales, grids and ticks."""
    upper.set_xscale("log")
    if not decibels:
        upper.set_yscale("log")
        low, high = upper.get_ylim()
        if high < 100 * low:
            middle = np.sqrt(low * high)
            upper.set_ylim(middle / 10, middle * 10)
        upper.yaxis.set_major_locator(LogLocator(numticks=7))
        upper.yaxis.set_minor_formatter(NullFormatter())
    upper.margins(x=0)
    upper.grid(alpha=0.3)
    upper.grid(which="minor", axis="x", alpha=0.12)
    if lower is None:
        return
    low, high = lower.get_ylim()
    if high - low < 180:
        middle = 90 * np.round((low + high) / 180)
        low, high = min(low, middle - 95), max(high, middle + 95)
        lower.set_ylim(low, high)
    step = next(s for s in (45, 90, 180, 360, 720, 1440, 1e9) if (high - low) / s <= 6)
    lower.yaxis.set_major_locator(MultipleLocator(step))
    lower.set_xscale("log")
    lower.margins(x=0)
    lower.grid(alpha=0.3)
    lower.grid(which="minor", axis="x", alpha=0.12)


def magnitude_unit(unit: str, decibels: bool) -> str:
    """The unit of magnitudes."""
    unit = "–" if unit == UNIT_OF_GAIN else unit or "SI units"
    if not decibels:
        return unit
    return "dB" if unit == "–" else f"dB re 1 {unit}"
