"""A picture of gravity sag over elevation."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.views.plot.canvas import COLOURS, STYLES, figure, legend_right

if TYPE_CHECKING:
    import xarray as xr

PREFIXES = ((1e-3, 1e3, "m"), (1e-6, 1e6, "µ"), (0.0, 1e9, "n"))  # of displacements and turns: mm, µm, nm
MOST = 2  # robots, whose curves differ by their style


def sag(data: "xr.Dataset | Mapping[str, xr.Dataset]") -> Figure:
    """Displacement and rotation over elevation as `pf.sag` gives them, or of two robots by name.

    Raises InputError for another dataset.
    """
    given: dict[str, Any] = dict(data) if not hasattr(data, "data_vars") else {"": data}
    for each in given.values():
        if not {"displacement", "rotation"} <= set(getattr(each, "data_vars", ())):
            raise InputError("data holds no sag over elevation; give what pf.sag returns")
    if not 1 <= len(given) <= MOST:
        raise InputError(f"data holds {len(given)} robots; give one or {MOST}, by name")
    fig = figure(7.0, 5.0)
    panels = fig.subplots(2, 1, sharex=True)
    for ax, name, unit in zip(panels, ("displacement", "rotation"), ("m", "rad"), strict=True):
        factor, prefix = scale(np.concatenate([each[name].values for each in given.values()]))
        for j, (words, each) in enumerate(given.items()):
            order = np.argsort(each.elevation.values)
            angle, values = np.degrees(each.elevation.values[order]), factor * each[name].values[order]
            for k, axis in enumerate("xyz"):
                about = "r" if name == "rotation" else ""
                label = ", ".join(filter(None, (f"{about}{axis}", words)))
                style = STYLES[k] if len(given) == 1 else STYLES[j]
                marker = "." if len(angle) <= 40 else ""
                ax.plot(angle, values[:, k], marker=marker, color=COLOURS[k], ls=style, lw=1.3, label=label)
        ax.set_ylabel(f"{name} ({prefix}{unit})")
        ax.axhline(0, color="0.5", lw=0.6)
        ax.margins(x=0)
        ax.grid(alpha=0.3)
        legend_right(ax)
    held = {str(each.attrs.get("motors", "")) for each in given.values()}
    how = {"locked": ", motors locked", "springs": ", motors on springs"}.get("".join(held), "")
    first = next(iter(given.values()))
    home = f" against {np.degrees(float(first.attrs.get('home', 0.0))):.4g}°"
    panels[0].set_title(f"Gravity sag{home}, in the axes of the base{how}", fontsize=10)
    panels[-1].set_xlabel("elevation: turn of the base (deg)")
    fig.align_ylabels(list(panels))
    return fig


def scale(values: Array) -> tuple[float, str]:
    """The factor and the prefix with which values are easy to read."""
    largest = float(np.max(np.abs(values), initial=0.0))
    return next((factor, prefix) for least, factor, prefix in PREFIXES if largest >= least)
