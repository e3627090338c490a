"""The robot at rest and displaced along small motions, as the scene takes the instants of a run."""

from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from parflex.base.array import Array
from parflex.linear.system import LinearModel
from parflex.mechanics.closure import displaced
from parflex.mechanics.paths import leg_paths
from parflex.mechanics.system import assembled
from parflex.views.viewer.scene import facing_up

STEP = 1e-5  # of the robot's size: of central differences, whose error is its square


class Frames(NamedTuple):
    """The robot at rest, and its small motions per unit of displacements: (1 + n, …), rest first."""

    position: Array
    rotation: Array
    elastic: Array
    path: Array
    axis: Array

    def with_motions(self, factors: Array) -> "Frames":
        """The robot at rest, and displaced by each motion times a factor (n,)."""
        return Frames(
            *(
                np.concatenate([all_[:1], all_[0] + factors.reshape(-1, *[1] * (all_.ndim - 1)) * all_[1:]])
                for all_ in self
            )
        )


def frames_of(lin: LinearModel, shapes: Array) -> Frames:
    """The robot at rest and its motions along displacements (n, 6 + N + z), by central differences."""
    mechanism, x = lin.point.mechanism, lin.point.x
    sizes = np.max(np.abs(shapes), axis=1, initial=0.0)
    steps = STEP * mechanism.size * shapes / np.where(sizes > 0, sizes, 1.0)[:, None]
    many = np.concatenate([np.zeros_like(steps[:1]), steps, -steps]) if len(shapes) else np.zeros((1, 0))
    flat = np.tile(x, (len(many), 1))
    system = assembled(mechanism, displaced(mechanism, flat, many) if len(shapes) else flat)
    paths, n = leg_paths(system), len(shapes)
    seen = (system.x.position, system.x.rotation, system.x.elastic, paths.points, paths.axes)
    scale = np.where(sizes > 0, sizes, 0.0) / (2 * STEP * mechanism.size)
    found = []
    for each in seen:
        by = scale.reshape(-1, *[1] * (each.ndim - 1))
        found.append(np.concatenate([each[:1], by * (each[1 : n + 1] - each[n + 1 :])]))
    return Frames(*found)


def largest_motions(lin: LinearModel, frames: Frames) -> Array:
    """(n,) m, the largest displacement of any node of the platform or point of the legs."""
    body, at = lin.point.mechanism.platform.body, frames.position
    nodes = body.nodes + np.einsum("n,nka->ka", frames.elastic[0], body.shapes)
    bend = np.einsum("tn,nka->tka", frames.elastic[1:], body.shapes) @ frames.rotation[0].T
    moved = at[1:, None] + np.einsum("tij,kj->tki", frames.rotation[1:], nodes) + bend
    largest: Array = np.maximum(
        np.max(np.linalg.norm(moved, axis=-1), axis=-1, initial=0.0),
        np.max(np.linalg.norm(frames.path[1:], axis=-1), axis=(-1, -2), initial=0.0),
    )
    return largest


def as_dataset(lin: LinearModel, frames: Frames) -> xr.Dataset:
    """Frames as the scene takes a run; the bend at rest is in the nodes, so that colours tell the motion."""
    body = lin.point.mechanism.platform.body
    paths, count, attachments = leg_paths(lin.point.system), len(frames.position), len(body.attachments)
    words = np.array(paths.stations, dtype=str).reshape(frames.path.shape[-3:-1])
    data: dict[str, Any] = {
        "position": (("time", "axis"), frames.position),
        "rotation": (("time", "axis", "platform_axis"), frames.rotation),
        "elastic": (("time", "mode"), frames.elastic - frames.elastic[0]),
        "platform_node": (
            ("node", "axis"),
            body.nodes + np.einsum("n,nka->ka", frames.elastic[0], body.shapes),
        ),
        "platform_shape": (("mode", "node", "axis"), body.shapes),
        "leg_path": (("time", "path", "station", "axis"), frames.path),
        "leg_axis": (("time", "path", "station", "axis"), frames.axis),
        "leg_station": (("path", "station"), words),
        "path_leg": (("path",), np.array(paths.legs, dtype=int) + 1),
        "path_attachment": (("path",), np.array(paths.attachments, dtype=int) + 1),
        "attachment_deformation": (("time", "attachment", "axis"), np.zeros((count, attachments, 3))),
    }
    if body.triangles is not None:
        data["platform_triangle"] = (("triangle", "corner"), facing_up(body.nodes, body.triangles))
    return xr.Dataset(data, {"time": np.linspace(0.0, 1.0, count)})
