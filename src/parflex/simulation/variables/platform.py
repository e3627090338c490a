"""The platform: where it is held, how it bends there, its nodes and its modes."""

import numpy as np

from parflex.base.array import Array
from parflex.mechanics.kinematics import position_in_world
from parflex.simulation.variables.recorded import Recorded
from parflex.simulation.variables.variable import Variable


def attachment_positions(run: Recorded) -> Array:
    """(T, k, 3) m in the world."""
    points = run.robot.platform.attachment_points + run.attachment_deformation
    return position_in_world(points, run.state)


def frequencies(run: Recorded) -> Array:
    """(N,) rad/s."""
    body = run.robot.platform
    return np.sqrt(body.stiffness / np.diagonal(body.m_ee))


def damping_ratios(run: Recorded) -> Array:
    """(N,) of the critical damping."""
    body = run.robot.platform
    return body.damping / np.maximum(2 * frequencies(run) * np.diagonal(body.m_ee), 1e-300)


def triangles(run: Recorded) -> Array | None:
    """(T, 3) numbers of nodes, from 0."""
    found = run.robot.platform.triangles
    return None if found is None else np.asarray(found, dtype=np.int64)


def origin_deformation(run: Recorded) -> Array | None:
    """(T, 6) m and rad."""
    body = run.robot.platform
    node = body.origin_node
    if node is None:
        return None
    rotations = np.zeros_like(body.shapes) if body.rotation_shapes is None else body.rotation_shapes
    return run.state.elastic @ np.concatenate([body.shapes[:, node], rotations[:, node]], axis=-1)


PLATFORM_VARIABLES = (
    Variable(
        "attachment_position",
        ("time", "attachment", "axis"),
        "m",
        "position of the attachment points in the world",
        attachment_positions,
        missed="where the legs hold the platform",
        pictured=True,
    ),
    Variable(
        "attachment_deformation",
        ("time", "attachment", "axis"),
        "m",
        "deformation at the attachment points, in platform axes",
        lambda run: run.attachment_deformation,
        missed="the deformation where the legs hold the platform",
        pictured=True,
    ),
    Variable(
        "platform_node",
        ("node", "axis"),
        "m",
        "nodes of the platform, in platform axes",
        lambda run: run.robot.platform.nodes,
        missed="the platform's nodes",
        pictured=True,
    ),
    Variable(
        "platform_shape",
        ("mode", "node", "axis"),
        "kg-0.5",
        "displacement shapes at the nodes",
        lambda run: run.robot.platform.shapes,
        missed="the platform's mode shapes",
        pictured=True,
    ),
    Variable(
        "frequency",
        ("mode",),
        "rad s-1",
        "natural frequencies of the free platform",
        frequencies,
        missed="the natural frequencies",
    ),
    Variable(
        "damping_ratio",
        ("mode",),
        "1",
        "damping ratios",
        damping_ratios,
    ),
    Variable(
        "platform_triangle",
        ("triangle", "corner"),
        "1",
        "surface, node numbers from 0",
        triangles,
        missed="the platform's surface",
        numbers=("node", 0),
    ),
    Variable(
        "origin_deformation",
        ("time", "component"),
        "m, rad",
        "deformation at the platform's origin, in platform axes",
        origin_deformation,
    ),
)
