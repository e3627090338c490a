"""Sizes, colours, axes with units and files that all pictures share."""

from collections.abc import Mapping
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.base.writing import replacing

if TYPE_CHECKING:  # which takes half a second to load
    import xarray as xr

    from parflex.simulation.result import Result

# Okabe and Ito, Color universal design, 2008: told apart by all readers, and in grey
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000", "#999999")
STYLES = ("-", "--", "-.", ":", (0, (5, 1)), (0, (3, 1, 1, 1)))


def save(figures: Mapping[str, Figure], folder: Path, suffix: str = "png") -> list[Path]:
    """Write figures by name as `folder/name.suffix`, each whole or not at all; png, pdf or svg.

    Raises InputError where one cannot be written.
    """
    paths = [folder / f"{name}.{suffix}" for name in figures]
    for path, figure in zip(paths, figures.values(), strict=True):
        with replacing(path) as part:
            figure.savefig(part, format=suffix)
    return paths


def figure(width: float, height: float) -> Figure:
    """An empty figure, inches."""
    return Figure(figsize=(width, height), layout="constrained", dpi=150)


def curves(ax: Axes, data: "xr.DataArray", dim: str, labels: list[str], factor: float = 1.0) -> None:
    """One curve per entry of a dimension, over time."""
    for i, label in enumerate(labels):
        style = STYLES[i % len(STYLES)]
        values = data.isel({dim: i}).values * factor
        ax.plot(data["time"].values, values, color=COLOURS[i % 8], linestyle=style, lw=1.2, label=label)
    ax.margins(x=0)
    ax.grid(alpha=0.3)
    ax.yaxis.set_major_locator(MaxNLocator(6))


def legend_right(ax: Axes) -> None:
    """A legend beside the axes, where it covers no curve."""
    ax.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False, fontsize=8, handlelength=2.6)


def time_label(ax: Axes) -> None:
    """The shared abscissa."""
    ax.set_xlabel("time (s)")


class Drawn(NamedTuple):
    """A figure as SVG, and where each of its axes is: left, bottom, right, top from 0 to 1."""

    svg: str
    boxes: tuple[tuple[float, float, float, float], ...]


def drawn(fig: Figure) -> Drawn:
    """The figure as a vector picture that stands by itself."""
    text = StringIO()
    fig.savefig(text, format="svg", metadata={"Date": None})
    return Drawn(text.getvalue(), tuple(tuple(ax.get_position().extents) for ax in fig.axes))


def frame_axes(ax: Any, points: Array) -> None:
    """Equal scales around all points, with units."""
    low, high = points.min(axis=0), points.max(axis=0)
    pad = 0.05 * np.max(high - low)
    low, high = low - pad, high + pad
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    ax.set_box_aspect(high - low, zoom=0.92)
    ax.set(xlabel="x (m)", ylabel="y (m)", zlabel="z (m)")
    ax.view_init(elev=24, azim=-62)
    for axis in (ax.xaxis, ax.yaxis, ax.zaxis):
        axis.set_major_locator(MaxNLocator(5))
        axis.set_tick_params(labelsize=7)


def require(result: "Result", name: str) -> None:
    """Raise InputError where a picture needs variables that the result does not hold."""
    if name not in result.dataset:
        held = ", ".join(sorted(map(str, result.dataset.data_vars)))
        raise InputError(f"the result has no {name!r}; it holds {held}")
