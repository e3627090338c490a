"""The robot at one state as points and lines, ready to be drawn: from a model, or from a result."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from parflex.array import Array, mv
from parflex.assembly import LegTerms, System
from parflex.chain import tip_position
from parflex.kinematics import position_in_world
from parflex.state import State

if TYPE_CHECKING:
    from parflex.model import Model
    from parflex.result import Result

SHOWN = 0.08  # of the platform's size: the largest deformation, as drawn


class Paths(NamedTuple):
    """The legs as lines in the world, m: from the base through the joints to each tip."""

    points: Array  # (…, lines, n, 3), shorter lines end with their last point again
    axes: Array  # (…, lines, n, 3), along which the joints there act; zero where there is none
    stations: tuple[tuple[str, ...], ...]  # what is there, a word per point of each line
    legs: tuple[int, ...]  # of each line
    attachments: tuple[int, ...]
    motors: Array  # (…, motors, 3), where the actuated joints are


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
    system, body = model.system(state), model.robot.platform
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


def leg_paths(system: System) -> Paths:
    """The legs of a robot at a state, or at a batch of them."""
    lines: list[Array] = []
    axes: list[Array] = []
    words: list[tuple[str, ...]] = []
    legs: list[int] = []
    held: list[int] = []
    motors: list[Array] = []
    for leg in system.legs:
        chain = leg.group.chain
        for t, j in enumerate(leg.group.tip_frames):
            way, none = chain.path(j), np.zeros(3)
            tip = tip_position(leg.frames, j, leg.group.offsets[:, t])
            stations = [none, *(leg.frames.p_0j[k] for k in way), tip]
            along = [none, *(leg.frames.R_0j[k][..., 2] for k in way), none]
            lines.append(np.stack([in_world(leg, p) for p in stations], axis=-2))
            axes.append(np.stack([turned(leg, a) for a in along], axis=-2))
            words += [("base", *(joint_word(leg, k) for k in way), "tip")] * len(leg.group.legs)
            legs += leg.group.legs
            held += list(leg.group.attachments[:, t])
        motors += [in_world(leg, motor_place(leg, j)) for j in leg.group.actuated]
    batch = system.x.position.shape[:-1]
    longest = max((line.shape[-2] for line in lines), default=0)
    nothing = np.zeros((*batch, 0, longest, 3))
    points = np.concatenate([nothing, *(lengthened(line, longest) for line in lines)], axis=-3)
    directions = np.concatenate([nothing, *(lengthened(axis, longest) for axis in axes)], axis=-3)
    named = tuple((*word, *("",) * (longest - len(word))) for word in words)
    places = np.concatenate([np.zeros((*batch, 0, 3)), *motors], axis=-2)
    return Paths(points, directions, named, tuple(legs), tuple(int(a) for a in held), places)


def lengthened(line: Array, count: int) -> Array:
    """Points (…, n, 3) as (…, count, 3), the last one again and again."""
    return line[..., np.minimum(np.arange(count), line.shape[-2] - 1), :]


def joint_word(leg: LegTerms, j: int) -> str:
    """What a joint is, with a star where there is a motor: R, P, R* or P*."""
    return "RP"[leg.group.chain.sigma[j]] + "*" * (j in leg.group.actuated)


def stretched(lines: Array, ends: Array) -> Array:
    """Lines (l, n, 3), moved in proportion to the way along them so that they end at (l, 3)."""
    steps = np.linalg.norm(np.diff(lines, axis=-2, prepend=lines[:, :1]), axis=-1)
    way = np.cumsum(steps, axis=-1)
    part = way / np.maximum(way[:, -1:], 1e-300)
    return lines + part[..., None] * (ends - lines[:, -1])[:, None]


def motor_place(leg: LegTerms, j: int) -> Array:
    """A turning joint's origin; for a sliding one the middle of its slide, in the base frame."""
    before, own = leg.group.chain.antecedent[j], leg.frames.p_0j[j]
    start = np.zeros(3) if before < 0 else leg.frames.p_0j[before]
    return 0.5 * (start + own) if leg.group.chain.sigma[j] else own


def in_world(leg: LegTerms, p: Array) -> Array:
    """Points (…, L, 3) of the legs' base frames in the world."""
    return leg.group.origin + turned(leg, p)


def turned(leg: LegTerms, v: Array) -> Array:
    """Vectors (…, L, 3) of the legs' base frames in the world's axes."""
    return mv(leg.group.rotation, np.broadcast_to(v, leg.qd.shape[:-1] + (3,)))


def drawn_scale(nodes: Array, bend: Array) -> float:
    """What makes the largest deformation 8 % of the platform's size."""
    largest = np.max(np.linalg.norm(bend, axis=1), initial=0.0)
    return float(SHOWN * np.max(np.ptp(nodes, axis=0)) / largest) if largest > 1e-12 else 1.0


def instant_of_largest_bend(result: "Result") -> int:
    """The output time with the largest deformation at the attachments."""
    bend = np.abs(result.dataset["attachment_deformation"].values)
    return int(np.argmax(bend.max(axis=(1, 2), initial=0.0)))
