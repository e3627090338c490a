"""The scene in K3D, which draws in the browser; its JavaScript comes inside its own wheel."""

from typing import Any

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.views.viewer.colours import Colouring
from parflex.views.viewer.parts import Part
from parflex.views.viewer.scene import Platform, Scene
from parflex.views.viewer.solids import Solid

Ids = tuple[Any, dict[str, int], list[list[int]]]

PLAIN = 0xBFD7E8
GRID = 0xC9D1D9
PALE = 0x8A97A5
VIEW = np.array([0.62, -1.25, 0.62])  # from where to look, times the size of what is seen


def k3d() -> Any:
    """The library; raises InputError where it is not installed."""
    try:
        import k3d
    except ImportError:
        raise InputError(
            'the viewer needs k3d, which is not installed: pip install "parflex[view]"'
        ) from None
    return k3d


def drawn(scene: Scene) -> Ids:
    """The plot, the id of the platform in each colouring, and the ids of each part's solids."""
    library = k3d()
    plot = library.plot(
        grid_visible=False,
        camera_auto_fit=False,
        menu_visibility=False,
        antialias=0,
        logarithmic_depth_buffer=False,
        axes_helper=0,
        camera_fov=32,
        camera_mode="orbit",
        colorbar_object_id=0,
        background_color=0xFFFFFF,
        lighting=1.7,
        name="parflex",
    )
    plates = {name: plate(library, scene.platform, each) for name, each in scene.colourings.items()}
    parts = [[solid(library, part, each) for each in part.solids] for part in scene.parts]
    pale = ghost(library, scene) if scene.still else []
    solids = [one for part in parts for one in part]
    for each in [*plates.values(), *solids, *pale, ground(library, scene.bounds)]:
        plot += each
    plot.camera = camera(scene.bounds)
    return (
        plot,
        {name: each.id for name, each in plates.items()},
        [[one.id for one in part] for part in parts],
    )


def plate(library: Any, platform: Platform, colouring: Colouring) -> Any:
    """The platform with a colour value from 0 to 1 at each node; by its nodes where it has no surface."""
    values = {}
    if len(platform.shapes):
        stops = np.linspace(0, 1, len(colouring.colours))[:, None]
        colours = np.concatenate([stops, np.array(colouring.colours) / 255], axis=1)
        values = {
            "attribute": np.full(len(platform.nodes), 0.5, dtype=np.float32),
            "color_map": colours.astype(np.float32).ravel(),
            "color_range": [0.0, 1.0],
        }
    nodes = platform.nodes.astype(np.float32)
    if platform.triangles is None:
        size = 0.03 * platform.size
        return library.points(nodes, point_size=size, shader="3d", color=PLAIN, name="platform", **values)
    return library.mesh(
        nodes,
        platform.triangles.astype(np.uint32),
        color=PLAIN,
        flat_shading=False,
        side="double",
        roughness=0.9,
        name="platform",
        **values,
    )


def solid(library: Any, part: Part, shape: Solid) -> Any:
    """One solid of a part, where it stands or for the page to place."""
    place = np.eye(4) if part.still is None else part.still
    return library.mesh(
        shape.vertices.astype(np.float32),
        shape.triangles.astype(np.uint32),
        normals=shape.normals.astype(np.float32),
        color=part.colour,
        flat_shading=False,
        roughness=0.6,
        model_matrix=place.astype(np.float32),
    )


def ghost(library: Any, scene: Scene) -> list[Any]:
    """The robot at the first instant as lines: its legs, and the edges of its platform."""
    lines = list(scene.arrays["leg_path"][0]) if "leg_path" in scene.arrays else []
    if scene.platform.triangles is not None:
        R, p = scene.arrays["rotation"][0], scene.arrays["position"][0]
        lines += list((scene.platform.nodes @ R.T + p)[edges(scene.platform)])
    ends = [np.stack([line[:-1], line[1:]], axis=1).reshape(-1, 3) for line in lines]
    if not ends:
        return []
    points = np.concatenate(ends).astype(np.float32)
    pairs = np.arange(len(points), dtype=np.uint32).reshape(-1, 2)
    kind = {"indices_type": "segment", "shader": "simple"}
    return [library.lines(points, pairs, color=PALE, name="at rest", **kind)]


def edges(platform: Platform) -> Array:
    """The edges (e, 2) of a surface: where it ends, and where it turns by more than 30 degrees."""
    assert platform.triangles is not None, "nodes alone have no edges"
    t, nodes = platform.triangles, platform.nodes
    normals = np.cross(nodes[t[:, 1]] - nodes[t[:, 0]], nodes[t[:, 2]] - nodes[t[:, 0]])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    every = np.sort(np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]]), axis=1)
    pairs, which, counts = np.unique(every, axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(which.ravel(), kind="stable")
    first = np.cumsum(counts) - counts
    one, other = (np.tile(np.arange(len(t)), 3)[order][first + k] for k in (0, np.minimum(counts, 2) - 1))
    turned = np.abs(np.sum(normals[one] * normals[other], axis=1)) < np.cos(np.pi / 6)
    found: Array = pairs[(counts == 1) | turned]
    return found


def ground(library: Any, bounds: Array) -> Any:
    """A grid of lines below everything, a square of some ten cells."""
    (x0, y0, z), (x1, y1, _) = bounds
    cell = 10.0 ** np.floor(np.log10(max(x1 - x0, y1 - y0, 1e-3))) / 2
    low = np.floor(np.array([x0, y0]) / cell - 1).astype(int)
    high = np.ceil(np.array([x1, y1]) / cell + 1).astype(int)
    xs, ys = (np.arange(low[i], high[i] + 1) * cell for i in range(2))
    lines = [[(x, ys[0], z), (x, ys[-1], z)] for x in xs] + [[(xs[0], y, z), (xs[-1], y, z)] for y in ys]
    ends = np.array(lines, dtype=np.float32).reshape(-1, 3)
    pairs = np.arange(len(ends), dtype=np.uint32).reshape(-1, 2)
    return library.lines(ends, pairs, indices_type="segment", shader="simple", color=GRID, name="ground")


def camera(bounds: Array) -> list[float]:
    """The position of the camera, its target, and the direction that is up."""
    middle = bounds.mean(axis=0)
    size = float(np.linalg.norm(bounds[1] - bounds[0]))
    return [*(middle + 1.35 * size * VIEW), *middle, 0.0, 0.0, 1.0]
