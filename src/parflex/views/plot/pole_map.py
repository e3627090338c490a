"""A picture of poles: how fast motions swing and die out."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.views.plot.canvas import COLOURS, figure

if TYPE_CHECKING:
    from parflex.linear.system import LinearModel

RATIOS = (0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9)
MARKS = "xo+s^dv*"
RAYS = 6  # that are drawn
SAME = 1e-3  # of the window: poles that lie on each other


def poles(
    lin: "LinearModel | Mapping[str, LinearModel]", *, band: tuple[float, float] | None = None
) -> Figure:
    """The poles of a linear system, or of several by name, in the upper half plane in hertz, with rays of
    equal damping ratio; the unstable half is shaded.

    band (Hz) chooses frequencies |pole| / 2π; the number of poles outside is told in the title.

    Raises InputError for what has no poles, or a band without any.
    """
    given = dict(lin) if isinstance(lin, Mapping) else {"": lin}
    if not 1 <= len(given) <= len(MARKS) or not all(hasattr(each, "poles") for each in given.values()):
        raise InputError(
            f"lin is no linear system with poles, nor up to {len(MARKS)} of them by name; give what "
            f"model.linearise returns"
        )
    low, high = (0.0, np.inf) if band is None else (float(band[0]), float(band[1]))
    found = {name: upper(np.asarray(each.poles)) / (2 * np.pi) for name, each in given.items()}
    shown = {name: s[(np.abs(s) >= low) & (np.abs(s) <= high)] for name, s in found.items()}
    every = np.concatenate(list(shown.values()))
    if not len(every):
        raise InputError(f"band is {low:g} … {high:g} Hz, where there are no poles; give another")
    fig = figure(6.4, 5.0)
    ax = fig.subplots()
    window(ax, every)
    rays(ax)
    for k, (name, s) in enumerate(shown.items()):
        face = {} if MARKS[k] in "x+" else {"mfc": "none"}
        ax.plot(s.real, s.imag, MARKS[k], color=COLOURS[k], ms=7, mew=1.5, label=name, zorder=3, **face)
        counted(ax, s, COLOURS[k])
    ax.set_xlabel("real part / 2π (Hz): decay to the left")
    ax.set_ylabel("imaginary part / 2π (Hz): frequency")
    outside = sum(len(found[name]) - len(shown[name]) for name in found)
    more = f"; {outside} outside {low:g} … {high:g} Hz" if outside else ""
    ax.set_title(f"Poles, one of each pair{more}; rays: damping ratio", fontsize=10)
    if any(given):
        ax.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False, fontsize=8)
    return fig


def upper(s: Array) -> Array:
    """One of each pair of conjugate poles, and the real ones."""
    return s[s.imag >= 0]


def window(ax: Axes, s: Array) -> None:
    """Limits about poles and the axes; a strip of the unstable half, shaded."""
    wide = max(float(np.max(-s.real)), 1e-3 * float(np.max(np.abs(s))))
    right = max(float(np.max(s.real)), 0.0)
    left, right = -1.18 * wide, max(1.25 * right, 0.12 * wide)
    top = 1.1 * max(float(np.max(s.imag)), 0.2 * wide)
    ax.set(xlim=(left, right), ylim=(-0.03 * top, top))
    ax.axvspan(0, right, color=COLOURS[1], alpha=0.12, lw=0)
    ax.axvline(0, color="0.3", lw=0.8)
    ax.axhline(0, color="0.3", lw=0.8)
    ax.grid(alpha=0.2)


def rays(ax: Axes) -> None:
    """Lines of equal damping ratio, labelled where they leave the window."""
    left, top = ax.get_xlim()[0], ax.get_ylim()[1]
    slope = -left / top
    ratios = [z for z in RATIOS if 0.12 < z / np.sqrt(1 - z * z) / slope < 8.0]
    for z in ratios[:: max(1, -(-len(ratios) // RAYS))]:
        tangent = z / np.sqrt(1 - z * z)
        end = min(top, -left / tangent)
        ax.plot([0, -tangent * end], [0, end], color="0.6", lw=0.7, ls=(0, (4, 3)), zorder=1)
        beside = end < top
        at = (left, end) if beside else (-tangent * end, end)
        ax.annotate(
            f"{100 * z:g} %", at, (3, 3) if beside else (0, -2), textcoords="offset points", fontsize=7,
            color="0.35", ha="left" if beside else "center", va="bottom" if beside else "top",
            bbox=dict(fc="white", ec="none", pad=0.6, alpha=0.8), zorder=2,
        )  # fmt: skip


def counted(ax: Axes, s: Array, colour: str) -> None:
    """The number of poles that lie on each other, beside their mark."""
    wide = np.ptp(ax.get_xlim()), np.ptp(ax.get_ylim())
    left = list(s)
    while left:
        here = left[0]
        on = [abs((p - here).real) < SAME * wide[0] and abs((p - here).imag) < SAME * wide[1] for p in left]
        if sum(on) > 1:
            ax.annotate(
                f"×{sum(on)}", (here.real, here.imag), (6, 4), textcoords="offset points", fontsize=7,
                color=colour,
            )  # fmt: skip
        left = [p for p, same in zip(left, on, strict=True) if not same]
