"""A picture of frequency responses in the complex plane."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from parflex.views.plot.canvas import COLOURS, STYLES, figure
from parflex.views.plot.entries import UNIT_OF_GAIN, Entry, Words, entries_of, size
from parflex.views.plot.responses import heading, legend_below, magnitude_unit

if TYPE_CHECKING:
    import xarray as xr

RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def nyquist(
    frf: "xr.DataArray | Mapping[str, xr.DataArray]",
    *,
    outputs: Sequence[str] | None = None,
    inputs: Sequence[str] | None = None,
) -> Figure:
    """The responses of `bode` in the complex plane, at positive frequencies; dots and their hertz stand where
    each is largest, and a cross at −1 where the units of output and input are alike.

    Raises InputError as `bode`.
    """
    rows, names = entries_of(frf, outputs, inputs)
    count, wide, words = len(rows), len(rows[0]), Words.of(rows)
    one = count * wide == 1
    fig = figure(5.4, 4.8) if one else figure(max(5.0, 2.35 * wide + 0.4), 2.35 * count + 0.8)
    grid = fig.subplots(count, wide, squeeze=False)
    for row, axes in zip(rows, grid, strict=True):
        for entry, ax in zip(row, axes, strict=True):
            locus(ax, entry, names, one)
            if not one:
                heading(ax, words.entry(entry), scale_of(entry)[1], 8.0, 34)
    if one:
        fig.suptitle(f"Frequency response {words.entry(rows[0][0])}{words.place}", fontsize=10)
    else:
        fig.suptitle(f"Imaginary part (up) over real part (right), input → output{words.place}", fontsize=10)
    shown = next((ax for ax in grid.flat if ax.lines), None)
    if shown is not None and any(names):
        legend_below(fig, shown, len(names))
    return fig


def scale_of(entry: Entry) -> tuple[float, str]:
    """The power of a thousand in which an entry is drawn, and the unit with it."""
    power = 0 if entry.silent else 3 * int(np.floor(np.log10(size(entry)) / 3 + 1e-9))
    unit = magnitude_unit(entry.unit, False)
    raised = f"10{str(power).translate(RAISED)}"
    return 10.0**power, unit if not power else raised if unit == "–" else f"{raised} {unit}"


def locus(ax: Axes, entry: Entry, names: list[str], one: bool) -> None:
    """One entry in the complex plane, with equal scales."""
    text = 8.0 if one else 6.0
    ax.tick_params(labelsize=text)
    if entry.silent:
        ax.set(xticks=[], yticks=[])
        ax.text(0.5, 0.5, "none", transform=ax.transAxes, ha="center", color="0.4", fontsize=8)
        return
    scale, unit = scale_of(entry)
    ax.axhline(0, color="0.6", lw=0.6)
    ax.axvline(0, color="0.6", lw=0.6)
    for j, name in enumerate(names):
        f, H = entry.curves[name][0], entry.curves[name][1] / scale
        ax.plot(H.real, H.imag, color=COLOURS[j], linestyle=STYLES[j % len(STYLES)], lw=1.2, label=name)
        top = int(np.argmax(np.abs(H)))
        ax.plot(H.real[top], H.imag[top], "o", color=COLOURS[j], ms=3.5)
        ax.annotate(
            f"{f[top]:.4g} Hz", (H.real[top], H.imag[top]), (4, -3), textcoords="offset points",
            fontsize=text, va="top", color=COLOURS[j],
            bbox=dict(fc="white", ec="none", pad=0.4, alpha=0.7),
        )  # fmt: skip
    if entry.unit == UNIT_OF_GAIN:
        ax.plot(-1 / scale, 0, "+", color="0.1", ms=8)
    if one:
        ax.set_xlabel(f"real part ({unit})")
        ax.set_ylabel(f"imaginary part ({unit})")
    ax.set_aspect("equal", adjustable="datalim")
    ax.margins(0.14)
    ax.locator_params(nbins=5)
    ax.grid(alpha=0.3)
