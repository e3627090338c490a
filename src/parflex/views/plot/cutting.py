"""A picture of stability lobes: depth of cut over spindle speed."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure

from parflex.base.errors import InputError
from parflex.views.plot.canvas import COLOURS, STYLES, figure, legend_right

if TYPE_CHECKING:
    import xarray as xr

HIGH = 6.0  # times the lowest limit: how far up the picture goes, at least


def lobes(data: "xr.Dataset | Mapping[str, xr.Dataset]") -> Figure:
    """The stability lobes of a cut as `pf.stability_lobes` gives them, or of several by name: the depth that
    is stable at each spindle speed, and the frequency of the chatter that limits it.

    Raises InputError for another dataset.
    """
    given: dict[str, Any] = dict(data) if not hasattr(data, "data_vars") else {"": data}
    for each in given.values():
        if not {"limit", "chatter", "lowest"} <= set(getattr(each, "data_vars", ())):
            raise InputError("data holds no stability lobes; give what pf.stability_lobes returns")
    if not 1 <= len(given) <= len(COLOURS):
        raise InputError(f"data holds {len(given)} cuts; give one to {len(COLOURS)}, by name")
    fig = figure(7.0, 5.0)
    upper, lower = fig.subplots(2, 1, sharex=True, height_ratios=(3, 1.4))
    lows = [float(each.lowest) for each in given.values()]
    tops = [
        float(np.max(each.limit.values[np.isfinite(each.limit.values)], initial=0)) for each in given.values()
    ]
    top = 1e3 * min(HIGH * max(lows), max(1.15 * max(tops), 2.0 * max(lows)))
    for k, (name, each) in enumerate(given.items()):
        speed = each.speed.values
        limit = np.where(np.isfinite(each.limit.values), 1e3 * each.limit.values, 2.0 * top)
        if len(given) == 1:
            upper.fill_between(speed, 0, limit, color=COLOURS[2], alpha=0.13, lw=0)
        style = dict(color=COLOURS[k], linestyle=STYLES[k % len(STYLES)])
        upper.plot(speed, limit, lw=1.5, label=name, **style)
        upper.axhline(1e3 * lows[k], color=COLOURS[k], lw=0.8, ls=":")
        upper.annotate(
            f"{1e3 * lows[k]:.3g} mm at any speed", (speed[-1], 1e3 * lows[k]), (-3, 2), color=COLOURS[k],
            textcoords="offset points", ha="right", va="bottom", fontsize=7,
        )  # fmt: skip
        lower.plot(speed, each.chatter.values, ".", ms=2.0, color=COLOURS[k])
    upper.set_ylim(0, top)
    upper.set_ylabel("depth of cut (mm)")
    below = "below the curves" if len(given) > 1 else "where it is shaded,"
    upper.set_title(f"Stability lobes: {below} the cut does not chatter", fontsize=10)
    lower.set_ylabel("chatter\nfrequency (Hz)")
    lower.set_xlabel("spindle speed (1/min)")
    for ax in (upper, lower):
        ax.margins(x=0)
        ax.grid(alpha=0.3)
    if any(given):
        legend_right(upper)
    fig.align_ylabels([upper, lower])
    return fig
