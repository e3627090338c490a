"""The scene of a result for the page: arrays over time, the platform's modes, the parts of the legs."""

from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from parflex.base.array import Array
from parflex.mechanics.paths import shares
from parflex.views.sketch import SHOWN
from parflex.views.viewer.colours import Colouring, colourings_of
from parflex.views.viewer.opening import ESSENTIAL, PER_INSTANT, Opened
from parflex.views.viewer.parts import Legs, Part, arrow, legs_of, parts_of

MOST_INSTANTS = 2000  # more than a screen has columns for the timeline
ARROW = 0.45  # of the platform's size: the longest force
SCALES = (0, 1, 1.5, 2, 3, 5, 7, 10, 15, 20, 30, 50, 70, 100, 150, 200, 300, 500, 700, 1000, 2000, 5000)

SHAPED = ("platform_shape", "platform_stress")  # of use with elastic coordinates only


class Platform(NamedTuple):
    """Nodes (K, 3) m and shapes (N, K, 3) in platform axes; triangles (T, 3) where there are any."""

    nodes: Array
    shapes: Array
    triangles: Array | None
    size: float  # m
    stress: Array | None = None  # (N, K, 6) of the modes, Pa per unit of their coordinates


class Scene(NamedTuple):
    """A robot that the page can move; `meta` is what it reads beside the arrays."""

    platform: Platform
    colourings: dict[str, Colouring]
    parts: list[Part]
    arrays: dict[str, Array]
    meta: dict[str, Any]
    bounds: Array  # (2, 3) m, of all that moves
    still: bool = False  # True where the robot at the first instant is seen, pale, beside the one that moves


def scene_of(result: Opened) -> Scene | None:
    """The scene of a result, or None where it does not tell where the platform is."""
    data = at_some_instants(finite_part(result.dataset))
    if data is None:
        return None
    legs = legs_of(data)
    elastic = data["elastic"].values if "elastic" in data else np.zeros((data.sizes["time"], 0))
    body = platform_of(data if "elastic" in data else data.drop_vars(SHAPED, errors="ignore"))
    elastic = elastic[:, : len(body.shapes)]
    colourings = colourings_of(body.shapes, body.stress, elastic)
    parts = [*(parts_of(legs) if legs else []), *arrows(data, body.size)]
    arrays = arrays_of(data, body, legs, elastic)
    meta = timing(arrays["time"]) | sizes(data, legs) | modes_of(data, body, colourings)
    meta |= {"scale": scale_of(body, elastic, arrays), "metresPerNewton": metres_per_newton(data, body.size)}
    meta["bends"] = bool(len(body.shapes)) or "leg_deformation" in arrays
    meta["scales"] = sorted({*SCALES, meta["scale"]})
    return Scene(body, colourings, parts, arrays, meta, bounds_of(data, body, legs))


def finite_part(data: xr.Dataset) -> xr.Dataset | None:
    """The instants at which the platform is somewhere."""
    if any(name not in data or not data[name].size for name in ESSENTIAL):
        return None
    good = np.ones(data.sizes["time"], dtype=bool)
    for name in PER_INSTANT:
        if name in data:
            good &= np.isfinite(data[name].values).reshape(len(good), -1).all(axis=1)
    return data.isel(time=good) if good.any() else None


def at_some_instants(data: xr.Dataset | None) -> xr.Dataset | None:
    """Every n-th instant of a long run, and its last."""
    if data is None or data.sizes["time"] <= MOST_INSTANTS:
        return data
    last = data.sizes["time"] - 1
    return data.isel(time=np.unique(np.linspace(0, last, MOST_INSTANTS).round().astype(int)))


def platform_of(data: xr.Dataset) -> Platform:
    """The platform's surface; of an inner mesh only what is seen."""
    if "platform_node" not in data:
        held = data["attachment_position"] - data["position"] if "attachment_position" in data else None
        nodes = np.zeros((1, 3)) if held is None else held.isel(time=0).values @ data["rotation"].values[0]
        return Platform(nodes, np.zeros((0, len(nodes), 3)), None, size_of(nodes))
    nodes = data["platform_node"].values
    shapes = data["platform_shape"].values if "platform_shape" in data else np.zeros((0, len(nodes), 3))
    if "platform_triangle" not in data:
        return Platform(nodes, shapes, None, size_of(nodes))
    stress = data["platform_stress"].values if "platform_stress" in data else None
    seen, triangles = np.unique(data["platform_triangle"].values, return_inverse=True)
    triangles = facing_up(nodes[seen], triangles.reshape(-1, 3))
    stress = None if stress is None else stress[:, seen]
    return Platform(nodes[seen], shapes[:, seen], triangles, size_of(nodes), stress)


def size_of(nodes: Array) -> float:
    """The longest side of the box about the nodes, m; a metre for a single one."""
    return float(np.max(np.ptp(nodes, axis=0), initial=0.0)) or 1.0


def facing_up(nodes: Array, triangles: Array) -> Array:
    """The triangles of a flat surface with their normals on one side; of another as they are."""
    middle = nodes - nodes.mean(axis=0)
    spread, directions = np.linalg.svd(middle, full_matrices=False)[1:]
    if len(spread) < 3 or spread[2] > 1e-6 * spread[0]:
        return triangles
    a, b, c = (nodes[triangles[:, k]] for k in range(3))
    down = np.cross(b - a, c - a) @ directions[2] < 0
    return np.where(down[:, None], triangles[:, ::-1], triangles)


def arrows(data: xr.Dataset, size: float) -> list[Part]:
    """A part for each contact force."""
    needed = {"contact_forces", "attachment_position", "attachment_deformation"}
    count = data.sizes["attachment"] if needed <= set(data) else 0
    return [arrow(k, 0.008 * size) for k in range(count)]


def metres_per_newton(data: xr.Dataset, size: float) -> float:
    """The scale at which the largest contact force is as long as it may be."""
    if "contact_forces" not in data:
        return 0.0
    largest = float(np.max(np.linalg.norm(data["contact_forces"].values, axis=-1), initial=0.0))
    return ARROW * size / largest if largest > 0 else 0.0


def scale_of(body: Platform, elastic: Array, arrays: dict[str, Array]) -> float:
    """The factor, of two digits, that makes the run's largest deformation 8 % of the platform's size."""
    bent = np.linalg.norm(arrays.get("leg_deformation", np.zeros(3)), axis=-1)
    largest = max(largest_bend(body.shapes, elastic), float(np.max(bent, initial=0.0)))
    return float(f"{SHOWN * body.size / largest:.2g}") if largest > 1e-12 else 1.0


def largest_bend(shapes: Array, elastic: Array) -> float:
    """The largest displacement of any node at any instant, m."""
    blocks = (
        np.array_split(elastic, max(1, shapes[0].size * len(elastic) // 2_000_000)) if len(shapes) else []
    )
    bends = (np.linalg.norm(np.tensordot(block, shapes, 1), axis=-1) for block in blocks)
    return max((float(bend.max(initial=0.0)) for bend in bends), default=0.0)


def arrays_of(data: xr.Dataset, body: Platform, legs: Legs | None, elastic: Array) -> dict[str, Array]:
    """All numbers of the page, in single precision when they are written."""
    arrays = {name: data[name].values for name in PER_INSTANT if name in data}
    arrays |= {"time": data["time"].values, "nodes": body.nodes, "shapes": body.shapes, "elastic": elastic}
    if not legs:
        for name in ("leg_path", "leg_axis", "leg_deformation"):
            arrays.pop(name, None)
    elif "leg_deformation" not in arrays:
        arrays["leg_share"] = shares(legs.points)
    if body.stress is not None:
        arrays["stress"] = body.stress
    return arrays


def timing(t: Array) -> dict[str, Any]:
    """The begin and end of the run, and the digits that its times are told with."""
    step = float(np.min(np.diff(t), initial=1.0))
    digits = int(np.clip(np.ceil(-np.log10(max(step, 1e-9))), 1, 6))
    return {"start": float(t[0]), "end": float(t[-1]), "instants": len(t), "digits": digits}


def sizes(data: xr.Dataset, legs: Legs | None) -> dict[str, Any]:
    """The numbers of paths and stations by which the arrays of the legs are read."""
    if legs is None:
        return {"paths": 0, "stations": 0, "ends": []}
    _, paths, stations, _ = legs.points.shape
    return {"paths": paths, "stations": stations, "ends": (data["path_attachment"].values - 1).tolist()}


def modes_of(data: xr.Dataset, body: Platform, colourings: dict[str, Colouring]) -> dict[str, Any]:
    """The modes' frequencies in words, their largest values, and the size they are shown with."""
    count = len(body.shapes)
    omega = data["frequency"].values if "frequency" in data else np.full(count, np.nan)
    words = [f"{w:.1f} rad/s ({w / (2 * np.pi):.1f} Hz)" if np.isfinite(w) else "" for w in omega[:count]]
    unit = np.eye(count)
    peaks = [
        {name: colouring.largest(unit[k : k + 1]) or 1.0 for name, colouring in colourings.items()}
        | {"magnitude": largest_bend(body.shapes[k : k + 1], np.ones((1, 1))) or 1.0}
        for k in range(count)
    ]
    return {"modes": count, "frequencies": words, "modePeaks": peaks, "shown": 1.5 * SHOWN * body.size}


def bounds_of(data: xr.Dataset, body: Platform, legs: Legs | None) -> Array:
    """The box (2, 3) m about the platform and the legs during the run."""
    corners = body.nodes[[*np.argmin(body.nodes, axis=0), *np.argmax(body.nodes, axis=0)]]
    places = data["position"].values[:, None] + np.einsum("tij,kj->tki", data["rotation"].values, corners)
    below = places.reshape(-1, 3) - [0.0, 0.0, 0.12 * body.size]  # where bending is drawn larger
    points = [places.reshape(-1, 3), below, *([legs.points.reshape(-1, 3)] if legs else [])]
    every = np.concatenate(points)
    return np.stack([every.min(axis=0), every.max(axis=0)])
