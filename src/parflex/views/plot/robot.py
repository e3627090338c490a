"""Pictures of robots at one state."""

from typing import Any

import numpy as np
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

from parflex.base.array import Array
from parflex.views.plot.canvas import COLOURS, figure, frame_axes
from parflex.views.sketch import Sketch


def robot_at(sketch: Sketch, title: str = "") -> Figure:
    """The robot at one state, of legs of any kind, its platform coloured by its deflection."""
    fig = figure(6.4, 4.8)
    ax: Any = fig.add_subplot(projection="3d", computed_zorder=False)
    lines = Line3DCollection(list(sketch.lines), colors="0.45", linewidths=3, zorder=1)
    ax.add_collection3d(lines)
    for leg, line in dict(zip(sketch.legs, sketch.lines, strict=True)).items():
        ax.scatter(*line[0], s=28, color="0.15", marker="s", depthshade=False, zorder=1)
        ax.text(*line[0], f" {leg}", fontsize=8, va="top", zorder=3)
    if len(sketch.joints):
        ax.scatter(*sketch.joints.T, s=12, color="0.25", depthshade=False, zorder=1)
    if len(sketch.motors):
        ax.scatter(*sketch.motors.T, s=26, color=COLOURS[1], depthshade=False, zorder=3, label="motor")
        ax.legend(loc="upper left", frameon=False, fontsize=8)
    draw_platform(fig, ax, sketch.triangles, sketch.nodes, sketch.bend)
    if sketch.triangles is None:
        ax.plot(
            *np.vstack([sketch.attachments, sketch.attachments[:1]]).T, color=COLOURS[0], lw=1.5, zorder=2
        )
    frame_axes(ax, np.vstack([sketch.lines.reshape(-1, 3), sketch.nodes]))
    bent = f"deformation × {sketch.scale:.0f}" if sketch.scale != 1.0 else ""
    ax.set_title(", ".join(filter(None, (title, bent))), fontsize=9, y=0.98)
    return fig


def draw_platform(fig: Figure, ax: Any, triangles: Array | None, world: Array, bend: Array) -> None:
    """The surface, coloured by the deflection along z_p; without a surface, its nodes."""
    if triangles is None:
        ax.scatter(*world.T, s=12, color=COLOURS[0])
        return
    surface = Poly3DCollection(world[triangles], edgecolor=(0, 0, 0, 0.15), linewidth=0.2, zorder=2)
    ax.add_collection3d(surface)
    if not bend.any():
        surface.set_facecolor("#BFD7E8")
        return
    deflection = bend[triangles, 2].mean(axis=1) * 1e3
    limit = float(np.max(np.abs(bend[:, 2]))) * 1e3 or 1.0
    surface.set_cmap("RdBu_r")
    surface.set_norm(Normalize(-limit, limit))
    surface.set_array(deflection)
    bar = fig.colorbar(surface, ax=ax, shrink=0.6, pad=0.08)
    bar.set_label("deflection along $z_p$ (mm)", fontsize=8)
