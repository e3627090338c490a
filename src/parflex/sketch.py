"""The robot at one state as points and lines, ready to be drawn."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from parflex.array import Array, mv
from parflex.assembly import LegTerms, assemble
from parflex.chain import tip_position
from parflex.kinematics import position_in_world
from parflex.state import State, coordinates

if TYPE_CHECKING:
    from parflex.model import Model
    from parflex.result import Result

SHOWN = 0.08  # of the platform's size: the largest deformation, as drawn


class Sketch(NamedTuple):
    """Points in the world, m."""

    lines: tuple[Array, ...]  # (n, 3) from a leg's base through the joints to a tip
    legs: tuple[int, ...]  # the leg of each line
    motors: Array  # (m, 3) where the actuated joints are
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
    model.legs(state)
    body = model.robot.platform
    x = coordinates(model.flat(state), model.robot.layout)
    bend = np.einsum("n,nka->ka", x.elastic, body.shapes)
    scale = drawn_scale(body.nodes, bend) if scale is None else scale
    nodes = position_in_world(body.nodes + scale * bend, x)
    attachments = nodes[list(body.attachments)]
    lines, legs, motors = [], [], [np.zeros((0, 3))]
    for leg in assemble(model.robot, x).legs:
        lines += leg_lines(leg, attachments)
        legs += list(leg.group.legs) * len(leg.group.tip_frames)
        motors += [in_world(leg, motor_place(leg, j)) for j in leg.group.actuated]
    actuated = np.concatenate(motors)
    return Sketch(tuple(lines), tuple(legs), actuated, nodes, bend, body.triangles, attachments, scale)


def leg_lines(leg: LegTerms, attachments: Array) -> list[Array]:
    """For each tip of the legs of a group, the line from the base to the attachment as drawn."""
    lines: list[Array] = []
    for t, j in enumerate(leg.group.tip_frames):
        joints = [leg.frames.p_0j[k] for k in leg.group.chain.path(j)]
        tip = tip_position(leg.frames, j, leg.group.offsets[:, t])
        points = np.stack([in_world(leg, p) for p in (np.zeros(3), *joints, tip)], axis=1)
        drawn = attachments[leg.group.attachments[:, t]]
        lines += [stretched(line, end) for line, end in zip(points, drawn, strict=True)]
    return lines


def stretched(line: Array, end: Array) -> Array:
    """The line (n, 3), moved in proportion to the way along it so that it ends at `end`."""
    way = np.cumsum(np.linalg.norm(np.diff(line, axis=0, prepend=line[:1]), axis=1))
    return line + (way / (way[-1] or 1.0))[:, None] * (end - line[-1])


def motor_place(leg: LegTerms, j: int) -> Array:
    """A turning joint's origin; for a sliding one the middle of its slide, in the base frame."""
    before, own = leg.group.chain.antecedent[j], leg.frames.p_0j[j]
    start = np.zeros(3) if before < 0 else leg.frames.p_0j[before]
    return 0.5 * (start + own) if leg.group.chain.sigma[j] else own


def in_world(leg: LegTerms, p: Array) -> Array:
    """Points (L, 3) of the legs' base frames in the world."""
    return leg.group.origin + mv(leg.group.rotation, np.broadcast_to(p, leg.group.origin.shape))


def drawn_scale(nodes: Array, bend: Array) -> float:
    """What makes the largest deformation 8 % of the platform's size."""
    largest = np.max(np.linalg.norm(bend, axis=1), initial=0.0)
    return float(SHOWN * np.max(np.ptp(nodes, axis=0)) / largest) if largest > 1e-12 else 1.0


def instant_of_largest_bend(result: "Result") -> int:
    """The output time with the largest deformation at the attachments."""
    bend = np.abs(result.dataset["attachment_deformation"].values)
    return int(np.argmax(bend.max(axis=(1, 2), initial=0.0)))
