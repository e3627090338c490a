"""Pictures of platforms: modes, frequencies, stresses."""

from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.tri import CubicTriInterpolator, Triangulation, UniformTriRefiner
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from parflex.base.array import Array
from parflex.robot.modes import Modes
from parflex.views.plot.canvas import COLOURS, figure, frame_axes

if TYPE_CHECKING:
    from parflex.fe import Fields
    from parflex.simulation.result import Result


def mode_shapes(modes: Modes, *, columns: int = 4) -> Figure:
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
    if getattr(modes, "solid", None):  # the corners of each face, whose four triangles are listed together
        surface = surface.reshape(-1, 4, 3)[:, :3, 1]
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


def shapes_of(result: "Result", *, columns: int = 5) -> Figure:
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
