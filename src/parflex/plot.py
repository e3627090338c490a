"""Pictures of results and modes. They compute nothing: labels and units come from the data."""

from collections.abc import Mapping
from io import StringIO
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import CubicTriInterpolator, Triangulation, UniformTriRefiner
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

from parflex.array import Array
from parflex.errors import InputError
from parflex.files.writing import replacing
from parflex.modes import Modes
from parflex.result import Result
from parflex.sketch import Sketch

if TYPE_CHECKING:
    from parflex.fe import Fields

# Okabe and Ito, Color universal design, 2008: told apart by all readers, and in grey
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000", "#999999")
ENERGIES = ("kinetic", "gravity", "strain", "dissipated", "actuators", "wrenches")
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


def curves(ax: Axes, data: xr.DataArray, dim: str, labels: list[str], factor: float = 1.0) -> None:
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


def over_time(result: Result) -> dict[str, Figure]:
    """The figures of a run over time that its result has the data for, by what they show."""
    made = {
        "Actuator forces": (actuator_forces, {"forces", "actuator_name"}),
        "Accelerations": (accelerations, {"acceleration", "acceleration_error"}),
        "Deformation at the origin": (origin_deformation, {"origin_deformation"}),
        "Deformation at the attachments": (attachment_deformation, {"attachment_deformation"}),
        "Energy balance": (energy, {f"energy_{name}" for name in (*ENERGIES, "residual")}),
    }
    bends = result.dataset.sizes.get("mode", 0) > 0
    return {
        words: draw(result)
        for words, (draw, needed) in made.items()
        if needed <= set(result.dataset.variables) and (bends or "Deformation" not in words)
    }


def actuator_forces(result: Result) -> Figure:
    """Actuator forces over time (the paper's Fig. 4)."""
    fig = figure(7.0, 3.4)
    ax = fig.subplots()
    data = result.dataset["forces"]
    curves(ax, data, "actuator", list(data["actuator_name"].values))
    ax.set_ylabel(f"actuator force ({data.attrs.get('units', 'N')})")
    time_label(ax)
    legend_right(ax)
    ax.set_title("Actuator forces")
    return fig


def accelerations(result: Result) -> Figure:
    """Platform acceleration and its difference from the desired one (the paper's Fig. 5).

    Raises InputError for a run without a desired trajectory.
    """
    require(result, "acceleration_error")
    fig = figure(7.0, 7.2)
    panels = fig.subplots(4, 1, sharex=True)
    both = (("acceleration", "acceleration"), ("acceleration_error", "desired − calculated"))
    for row, (name, words) in enumerate(both):
        data = result.dataset[name]
        linear, angular = data.isel(component=slice(0, 3)), data.isel(component=slice(3, 6))
        curves(panels[2 * row], linear, "component", ["$\\dot v_x$", "$\\dot v_y$", "$\\dot v_z$"])
        panels[2 * row].set_ylabel(f"linear\n{words}\n(m/s²)")
        names = ["$\\dot\\omega_x$", "$\\dot\\omega_y$", "$\\dot\\omega_z$"]
        curves(panels[2 * row + 1], angular, "component", names)
        panels[2 * row + 1].set_ylabel(f"angular\n{words}\n(rad/s²)")
    for ax in panels:
        legend_right(ax)
    panels[0].set_title("Acceleration of the platform frame by the direct model, in platform axes")
    time_label(panels[-1])
    fig.align_ylabels(panels)
    return fig


def origin_deformation(result: Result) -> Figure:
    """Linear and angular deformation at the platform's origin (the paper's Fig. 6).

    Raises InputError for a platform without a node at its origin.
    """
    require(result, "origin_deformation")
    data = result.dataset["origin_deformation"]
    fig = figure(7.0, 4.6)
    upper, lower = fig.subplots(2, 1, sharex=True)
    curves(upper, data.isel(component=slice(0, 3)), "component", list("xyz"), 1e3)
    upper.set_ylabel("linear deformation\n(mm)")
    curves(lower, data.isel(component=slice(3, 6)), "component", list("xyz"), 1e3)
    lower.set_ylabel("angular deformation\n(mrad)")
    for ax in (upper, lower):
        legend_right(ax)
    upper.set_title("Deformation at the platform origin, in platform axes")
    time_label(lower)
    fig.align_ylabels([upper, lower])
    return fig


def attachment_deformation(result: Result) -> Figure:
    """Deformation at the attachment points along each axis that moves (the paper's Fig. 7)."""
    data = result.dataset["attachment_deformation"]
    size = np.max(np.abs(data.values), initial=0.0)
    moving = [i for i in range(3) if np.max(np.abs(data.isel(axis=i).values), initial=0) > 1e-9 * size]
    shown = moving if size > 0 else [2]
    fig = figure(7.0, 1.2 + 2.4 * len(shown))
    panels = fig.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
    labels = [f"$p_{{{i}}}$" for i in data["attachment"].values]
    for ax, axis in zip(panels, shown, strict=True):
        curves(ax, data.isel(axis=axis), "attachment", labels, 1e3)
        ax.set_ylabel(f"deformation along ${'xyz'[axis]}_p$\n(mm)")
        legend_right(ax)
    still = [f"${'xyz'[i]}_p$" for i in range(3) if i not in shown]
    note = f"; none along {' and '.join(still)}" if still else ""
    panels[0].set_title(f"Deformation at the attachment points, in platform axes{note}")
    time_label(panels[-1])
    return fig


def energy(result: Result) -> Figure:
    """The energy ledger and the residual of its balance."""
    fig = figure(7.0, 4.6)
    upper, lower = fig.subplots(2, 1, sharex=True, height_ratios=(3, 1))
    for i, name in enumerate(ENERGIES):
        data = result.dataset[f"energy_{name}"]
        words = {"gravity": "gravity (change)", "actuators": "work of actuators"}
        words["wrenches"] = "work of wrenches"
        values = data - data[0] if name == "gravity" else data
        upper.plot(data["time"], values, color=COLOURS[i], linestyle=STYLES[i], label=words.get(name, name))
    upper.set_ylabel("energy (J)")
    legend_right(upper)
    residual = result.dataset["energy_residual"]
    lower.plot(residual["time"], residual, color=COLOURS[6], lw=1.0)
    lower.set_ylabel("residual (J)")
    for ax in (upper, lower):
        ax.margins(x=0)
        ax.grid(alpha=0.3)
    upper.set_title("Energy balance")
    time_label(lower)
    fig.align_ylabels([upper, lower])
    return fig


def mode_shapes(modes: Modes, columns: int = 4) -> Figure:
    """A platform's modes, each scaled to its largest value: of a flat one the deflection, of a solid its
    bent surface."""
    flat = np.ptp(modes.nodes[:, 2]) == 0
    bends = np.max(np.abs(modes.shapes[..., 2]), axis=1) > 0.5 * np.max(np.abs(modes.shapes), axis=(1, 2))
    return flat_shapes(modes, columns) if flat and np.all(bends) else solid_shapes(modes, columns)


def solid_shapes(modes: Modes, columns: int = 4) -> Figure:
    """The surface of a solid bent by each mode, coloured by its displacement."""
    count = len(modes.frequencies)
    columns = max(1, min(columns, count))
    rows = max(1, -(-count // columns))
    fig = figure(2.2 * columns + 0.8, 1.9 * rows + 0.5)
    surface = modes.triangles
    if modes.solid is not None:  # the corners of each face, whose four triangles are listed together
        surface = surface.reshape(-1, 4, 3)[:, [0, 1, 2], [0, 1, 2]]
    held = modes.nodes[list(modes.corners)]
    size = float(np.max(np.ptp(modes.nodes, axis=0)))
    for k in range(count):
        ax: Any = fig.add_subplot(rows, columns, k + 1, projection="3d")
        moved = modes.shapes[k] / np.max(np.linalg.norm(modes.shapes[k], axis=1))
        bent = modes.nodes + 0.12 * size * moved
        drawn = Poly3DCollection(bent[surface], cmap="viridis", edgecolor="none")
        drawn.set_array(np.linalg.norm(moved, axis=1)[surface].mean(axis=1))
        drawn.set_clim(0, 1)
        ax.add_collection3d(drawn)
        ax.scatter(*held.T, s=6, color="0.1", depthshade=False)
        middle = 0.5 * (bent.min(axis=0) + bent.max(axis=0))
        half = np.maximum(0.5 * np.ptp(bent, axis=0), 0.02 * size)
        low, high = middle - half, middle + half
        ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
        ax.set_box_aspect(high - low, zoom=1.3)
        ax.set_axis_off()
        ax.set_title(f"mode {k + 1}, {modes.frequencies[k]:.0f} rad/s", fontsize=8, y=0.95)
    fig.suptitle("Modes of the platform (dots: joints; colour: displacement)", fontsize=9)
    return fig


def stress(modes: Modes, fields: "Fields", title: str = "") -> Figure:
    """The surface of a bent solid, coloured by its von Mises stress at the nodes; its deformation is
    exaggerated to 5 % of its size."""
    fig = figure(6.4, 4.4)
    ax: Any = fig.add_subplot(projection="3d")
    bend = fields.displacement
    size = float(np.max(np.ptp(modes.nodes, axis=0)))
    scale = 0.05 * size / (float(np.max(np.linalg.norm(bend, axis=1))) or 1.0)
    bent = modes.nodes + scale * bend
    drawn = Poly3DCollection(bent[modes.triangles], cmap="inferno", edgecolor="none")
    drawn.set_array(fields.mises[modes.triangles].mean(axis=1) * 1e-6)
    ax.add_collection3d(drawn)
    ax.scatter(*bent[list(modes.corners)].T, s=14, color=COLOURS[4], depthshade=False)
    frame_axes(ax, bent)
    fig.colorbar(drawn, ax=ax, shrink=0.6, pad=0.1).set_label("von Mises stress (MPa)", fontsize=8)
    ax.set_title(", ".join(filter(None, (title, f"deformation × {scale:.0f}"))), fontsize=9, y=0.98)
    return fig


def flat_shapes(modes: Modes, columns: int = 4) -> Figure:
    """Deflection of a flat platform's modes, each scaled to its largest value."""
    count = len(modes.frequencies)
    columns = max(1, min(columns, count))
    rows = max(1, -(-count // columns))
    fig = figure(1.9 * columns + 0.8, 2.0 * rows + 0.4)
    panels = fig.subplots(rows, columns, squeeze=False)
    image, rim = None, edges_of_one(modes.triangles)
    for k, ax in enumerate(panels.flat):
        ax.set_axis_off()
        if k >= count:
            continue
        mesh, w = smooth_deflection(modes, k)
        image = ax.tricontourf(mesh, w / np.max(np.abs(w)), np.linspace(-1, 1, 21), cmap="RdBu_r")
        ax.tricontour(mesh, w, [0.0], colors="0.3", linewidths=0.7)
        for edge in rim:
            ax.plot(*modes.nodes[edge, :2].T, color="0.2", lw=0.8, clip_on=False)
        for node in modes.corners[:1]:
            ax.plot(*modes.nodes[node, :2], "o", color="0.1", ms=4, clip_on=False)
        ax.set_aspect("equal")
        ax.set_title(f"mode {k + 1}\n{modes.frequencies[k]:.1f} rad/s", fontsize=8)
    if image is not None:
        bar = fig.colorbar(image, ax=panels, shrink=0.6, ticks=[-1, 0, 1])
        bar.set_label("deflection / largest deflection", fontsize=8)
    fig.suptitle("Elastic modes of the free plate (dot: first attachment; line: no deflection)", fontsize=9)
    return fig


def shapes_of(result: Result, columns: int = 5) -> Figure:
    """Deflection of a flat platform's modes as its result has them, each scaled to its largest value."""
    data = result.dataset
    mesh = Triangulation(*data["platform_node"].values[:, :2].T, data["platform_triangle"].values)
    shapes = data["platform_shape"].values[..., 2]
    columns = min(columns, len(shapes))
    rows = -(-len(shapes) // columns)
    fig = figure(1.7 * columns + 0.4, 1.9 * rows + 0.4)
    panels = fig.subplots(rows, columns, squeeze=False)
    for k, ax in enumerate(panels.flat):
        ax.set_axis_off()
        if k < len(shapes):
            w = shapes[k] / (np.max(np.abs(shapes[k])) or 1.0)
            ax.tripcolor(mesh, w, shading="gouraud", cmap="RdBu_r", vmin=-1, vmax=1, rasterized=True)
            ax.set_aspect("equal")
            ax.set_title(f"mode {k + 1}", fontsize=8)
    fig.suptitle("Elastic modes: deflection along $z_p$ over its largest value (red +, blue −)", fontsize=9)
    return fig


def edges_of_one(triangles: Array) -> Array:
    """The edges (E, 2) that one triangle alone has."""
    every = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, count = np.unique(every, axis=0, return_counts=True)
    return np.asarray(edges[count == 1])


def smooth_deflection(modes: Modes, k: int) -> tuple[Triangulation, Array]:
    """The deflection of mode k between the nodes, from its values and slopes there."""
    on, triangles = np.unique(modes.triangles, return_inverse=True)  # patches have nodes on no element
    mesh = Triangulation(*modes.nodes[on, :2].T, triangles.reshape(-1, 3))
    w = modes.shapes[k, on, 2]
    if modes.rotations is None:
        return mesh, w
    slopes = (-modes.rotations[k, on, 1], modes.rotations[k, on, 0])
    cubic = CubicTriInterpolator(mesh, w, kind="user", dz=slopes)
    fine, values = UniformTriRefiner(mesh).refine_field(w, cubic, subdiv=2)
    return fine, np.asarray(values)


def frequency_table(computed: Array, published: Array, notes: list[str]) -> Figure:
    """Published and computed frequencies (rad/s) side by side, as a table."""
    count = min(len(computed), len(published))
    lines = [line for note in notes for line in wrap(note, 88)]
    height = 0.45 + 0.24 * (count + 1)
    fig = figure(5.6, height + 0.15 * len(lines))
    ax = fig.subplots()
    ax.set_axis_off()
    rows = [
        (f"{k + 1}", f"{k + 7}", f"{published[k]:.2f}", f"{computed[k]:.2f}",
         f"{100 * (computed[k] / published[k] - 1):+.2f} %".replace("-", "−"))
        for k in range(count)
    ]  # fmt: skip
    heads = ("elastic mode", "no. in paper", "Table 2 (rad/s)", "computed (rad/s)", "difference")
    table = ax.table(rows, colLabels=heads, bbox=(0, 0, 1, 1), cellLoc="center", edges="horizontal")
    table.auto_set_font_size(False)
    table.set_fontsize(8)
    for cell in table.get_celld().values():
        cell.set_linewidth(0.4)
    ax.set_title("Natural frequencies of the free plate", fontsize=9)
    fig.supxlabel("\n".join(lines), fontsize=7, x=0.02, ha="left")
    return fig


def robot_at(sketch: Sketch, title: str = "") -> Figure:
    """The robot at one state, of legs of any kind, its platform coloured by its deflection."""
    fig = figure(6.4, 4.8)
    ax: Any = fig.add_subplot(projection="3d", computed_zorder=False)
    lines = Line3DCollection(list(sketch.lines), colors="0.45", linewidths=3, zorder=1)
    ax.add_collection3d(lines)
    for leg, line in dict(zip(sketch.legs, sketch.lines, strict=True)).items():
        ax.scatter(*line[0], s=28, color="0.15", marker="s", depthshade=False, zorder=1)
        ax.text(*line[0], f" {leg}", fontsize=8, va="top", zorder=3)
    if len(sketch.lines):
        ax.scatter(*sketch.lines[:, 1:].reshape(-1, 3).T, s=12, color="0.25", depthshade=False, zorder=1)
    if len(sketch.motors):
        ax.scatter(*sketch.motors.T, s=26, color=COLOURS[1], depthshade=False, zorder=3, label="motor")
        ax.legend(loc="upper left", frameon=False, fontsize=8)
    draw_platform(fig, ax, sketch.triangles, sketch.nodes, sketch.bend)
    if sketch.triangles is None:
        ax.plot(
            *np.vstack([sketch.attachments, sketch.attachments[:1]]).T, color=COLOURS[0], lw=1.5, zorder=2
        )
    frame_axes(ax, np.vstack([sketch.lines.reshape(-1, 3), sketch.nodes]))
    bent = f"deformation × {sketch.scale:.0f}" if sketch.bend.any() else ""
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


def require(result: Result, name: str) -> None:
    """Say so where a picture needs what the result does not hold."""
    if name not in result.dataset:
        held = ", ".join(sorted(map(str, result.dataset.data_vars)))
        raise InputError(f"the result has no {name!r}; it holds {held}")
