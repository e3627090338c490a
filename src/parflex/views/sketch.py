"""The robot at one state as points and lines, ready to be drawn: from a model, or from a result."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.mechanics.kinematics import position_in_world
from parflex.mechanics.paths import leg_paths
from parflex.model.core import core_of
from parflex.robot.state import State

if TYPE_CHECKING:
    from parflex.model.model import Model
    from parflex.simulation.result import Result

SHOWN = 0.08  # of the platform's size: the largest deformation, as drawn


class Sketch(NamedTuple):
    """Points in the world, m."""

    lines: Array  # (lines, n, 3)
    legs: Array  # (lines,), the number of each line's leg, from 1
    motors: Array  # (m, 3)
    nodes: Array  # (K, 3) of the platform, its deformation times `scale`
    bend: Array  # (K, 3) the deformation itself, in platform axes
    triangles: Array | None  # (T, 3)
    attachments: Array  # (k, 3), as drawn
    scale: float


def sketch(model: "Model", state: State, scale: float | None = None) -> Sketch:
    """The robot at a state.

    scale exaggerates the deformation; by default the largest becomes 8 % of the platform's size.
    Raises OutOfReach and SingularPose where a leg's inverse geometry fails.
    """
    system, body = core_of(model).system(state), model.robot.platform
    x, paths = system.x, leg_paths(system)
    bend = np.einsum("n,nka->ka", x.elastic, body.shapes)
    scale = drawn_scale(body.nodes, bend) if scale is None else scale
    nodes = position_in_world(body.nodes + scale * bend, x)
    attachments = nodes[list(body.attachments)]
    lines = stretched(paths.points, attachments[list(paths.attachments)])
    legs = np.array(paths.legs, dtype=int) + 1
    return Sketch(lines, legs, paths.motors, nodes, bend, body.triangles, attachments, scale)


def sketch_of(result: "Result", index: int = 0, scale: float | None = None) -> Sketch:
    """The robot at an output time of a result; scale as in `sketch`."""
    at = result.dataset.isel(time=index)
    R, nodes = at["rotation"].values, at["platform_node"].values
    bend = np.einsum("n,nka->ka", at["elastic"].values, at["platform_shape"].values)
    scale = drawn_scale(nodes, bend) if scale is None else scale
    more = (scale - 1.0) * at["attachment_deformation"].values @ R.T
    attachments = at["attachment_position"].values + more
    lines = stretched(at["leg_path"].values, attachments[at["path_attachment"].values - 1])
    triangles = at["platform_triangle"].values if "platform_triangle" in at else None
    world = at["position"].values + (nodes + scale * bend) @ R.T
    legs, motors = at["path_leg"].values, at["motor_position"].values
    return Sketch(lines, legs, motors, world, bend, triangles, attachments, scale)


def stretched(lines: Array, ends: Array) -> Array:
    """Lines (l, n, 3), moved in proportion to the way along them so that they end at (l, 3)."""
    steps = np.linalg.norm(np.diff(lines, axis=-2, prepend=lines[:, :1]), axis=-1)
    way = np.cumsum(steps, axis=-1)
    part = way / np.maximum(way[:, -1:], 1e-300)
    return lines + part[..., None] * (ends - lines[:, -1])[:, None]


def drawn_scale(nodes: Array, bend: Array) -> float:
    """The factor that makes the largest deformation 8 % of the platform's size."""
    largest = np.max(np.linalg.norm(bend, axis=1), initial=0.0)
    return float(SHOWN * np.max(np.ptp(nodes, axis=0)) / largest) if largest > 1e-12 else 1.0


def instant_of_largest_bend(result: "Result") -> int:
    """The output time with the largest deformation at the attachments."""
    bend = np.abs(result.dataset["attachment_deformation"].values)
    return int(np.argmax(bend.max(axis=(1, 2), initial=0.0)))
