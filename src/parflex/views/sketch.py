"""The robot at one state as points and lines, ready to be drawn: from a model, or from a result."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.mechanics.kinematics import position_in_world
from parflex.mechanics.paths import LINK, deformation, leg_paths, stretched
from parflex.model.core import core_of
from parflex.robot.state import State

if TYPE_CHECKING:
    from parflex.model.model import Model
    from parflex.simulation.result import Result

SHOWN = 0.08  # of the platform's size: the largest deformation, of platform or links, as drawn


class Sketch(NamedTuple):
    """Points in the world, m."""

    lines: Array  # (lines, n, 3), flexible links as they are bent, their deformation times `scale`
    joints: Array  # (j, 3), at which the lines have joints and tips
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
    bent = deformation(system, paths) if any(system.mechanism.layout.elastic) else None
    scale = drawn_scale(body.nodes, bend, bent) if scale is None else scale
    nodes = position_in_world(body.nodes + scale * bend, x)
    attachments = nodes[list(body.attachments)]
    lines = drawn_lines(paths.points, bent, scale, attachments[list(paths.attachments)])
    legs, words = np.array(paths.legs, dtype=int) + 1, np.array(paths.stations)
    motors = paths.motors if bent is None else motors_on(lines, words, legs)
    joints = joints_on(lines, words)
    return Sketch(lines, joints, legs, motors, nodes, bend, body.triangles, attachments, scale)


def sketch_of(result: "Result", index: int = 0, scale: float | None = None) -> Sketch:
    """The robot at an output time of a result; scale as in `sketch`."""
    at = result.dataset.isel(time=index)
    R, nodes = at["rotation"].values, at["platform_node"].values
    bend = np.einsum("n,nka->ka", at["elastic"].values, at["platform_shape"].values)
    bent = at["leg_deformation"].values if {"leg_deformation", "leg_station"} <= set(at) else None
    scale = drawn_scale(nodes, bend, bent) if scale is None else scale
    more = (scale - 1.0) * at["attachment_deformation"].values @ R.T
    attachments = at["attachment_position"].values + more
    lines = drawn_lines(at["leg_path"].values, bent, scale, attachments[at["path_attachment"].values - 1])
    triangles = at["platform_triangle"].values if "platform_triangle" in at else None
    world = at["position"].values + (nodes + scale * bend) @ R.T
    legs = at["path_leg"].values
    words = at["leg_station"].values if bent is not None else np.full(lines.shape[:2], "joint")
    motors = at["motor_position"].values if bent is None else motors_on(lines, words, legs)
    joints = joints_on(lines, words)
    return Sketch(lines, joints, legs, motors, world, bend, triangles, attachments, scale)


def drawn_lines(lines: Array, bent: Array | None, scale: float, ends: Array) -> Array:
    """Lines (l, n, 3) with their deformation times a scale; of rigid links such that they end at (l, 3)."""
    return stretched(lines, ends) if bent is None else lines + (scale - 1.0) * bent


def joints_on(lines: Array, words: Array) -> Array:
    """The places (j, 3) of joints and tips on lines whose points are (l, n) words."""
    there = (words != LINK) & (words != "")
    there[:, :1] = False
    return np.asarray(lines[there])


def motors_on(lines: Array, words: Array, legs: Array) -> Array:
    """The places (m, 3) of motors on lines of bent links: a sliding one in the middle of its slide."""
    found: dict[tuple[int, tuple[str, ...]], Array] = {}
    for line, row, leg in zip(lines, words, legs, strict=True):
        for s in np.flatnonzero(np.char.endswith(row.astype(str), "*")):
            before = max((k for k in range(s) if row[k] != LINK), default=s)
            place = line[(before + s) // 2] if s - before > 1 else 0.5 * (line[before] + line[s])
            own = (int(leg), tuple(map(str, row[: s + 1])))
            found.setdefault(own, place if row[s] == "P*" else line[s])
    return np.array(list(found.values())).reshape(-1, 3)


def drawn_scale(nodes: Array, bend: Array, bent: Array | None = None) -> float:
    """The factor that makes the largest deformation, of nodes or of the legs, 8 % of the platform's size."""
    moved = [bend, np.zeros((0, 3)) if bent is None else bent.reshape(-1, 3)]
    largest = np.max(np.linalg.norm(np.concatenate(moved), axis=1), initial=0.0)
    return float(SHOWN * np.max(np.ptp(nodes, axis=0)) / largest) if largest > 1e-12 else 1.0


def instant_of_largest_bend(result: "Result") -> int:
    """The output time with the largest deformation at the attachments."""
    bend = np.abs(result.dataset["attachment_deformation"].values)
    return int(np.argmax(bend.max(axis=(1, 2), initial=0.0)))
