"""The parts of the legs, from the points and axes of their joints: rods, joints, motors, and their sizes."""

from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from parflex.base.array import Array, mtv
from parflex.mechanics.paths import LINK
from parflex.views.viewer.solids import Solid, ball, cone, cylinder, drum, tube

STEEL, DARK, MOTOR, FORCE = 0x9AA5B1, 0x525E6B, 0xD55E00, 0x009E73


class Part(NamedTuple):
    """Solids of one colour, and for the page the kind of placing that moves them, with its numbers.

    `still` (4, 4) places a part that does not move on its own, at the start. Indices count points of all
    paths, path by path.
    """

    solids: tuple[Solid, ...]
    colour: int
    moves: dict[str, Any]
    still: Array | None = None


class Legs(NamedTuple):
    """The stations of the legs' paths."""

    points: Array  # (T, P, S, 3) m in the world
    axes: Array  # (T, P, S, 3)
    words: Array  # (P, S): base, R or P for a joint, with a star where there is a motor, link, tip, or empty
    owners: Array  # (P,), the leg of each path
    width: float  # m, the radius of a rod
    base: tuple[Array, Array] | None = None  # places (T, 3) and rotations (T, 3, 3) of one that moves

    def seen(self, p: int, s: int) -> tuple[Array, Array]:
        """Points and axes (T, 3) of a station, from the base and in its axes."""
        points, axes = self.points[:, p, s], self.axes[:, p, s]
        if self.base is None:
            return points, axes
        place, rotation = self.base
        return mtv(rotation, points - place), mtv(rotation, axes)


def legs_of(data: xr.Dataset) -> Legs | None:
    """The legs of a result, or None where it holds none; rods are as thick as the robot is big."""
    names = ("leg_path", "leg_axis", "leg_station", "path_leg")
    if not {*names, "path_attachment", "attachment_deformation"} <= set(data):
        return None
    points, axes, words, owners = (data[name].values for name in names)
    extent = np.ptp(points.reshape(-1, 3), axis=0) if points.size else np.zeros(3)
    width, moving = 0.005 * float(np.linalg.norm(extent)), {"base_position", "base_rotation"} <= set(data)
    base = (data["base_position"].values, data["base_rotation"].values) if moving else None
    return Legs(points, axes, words, owners, width, base)


def parts_of(legs: Legs) -> list[Part]:
    """Rods, joints and motors of the legs; a part that two paths of a leg share is there once."""
    parts: list[Part] = []
    for p, row in enumerate(legs.words):
        for s, word in enumerate(row):
            if word and not shared(legs, p, s):
                parts += station(legs, p, s)
    return parts


def station(legs: Legs, p: int, s: int) -> list[Part]:
    """The parts that stand at a station, and those that lead to it."""
    word = str(legs.words[p, s])
    if word == LINK:
        return [] if legs.words[p, s - 1] == LINK else [bent_link(legs, p, s)]
    if word == "base":
        return [] if slides(legs, p, s + 1) else [pedestal(legs, p)]
    if word == "tip":
        return [*rod(legs, p, s), solid(legs, p, s, ball(), DARK, 1.9)]
    colour = MOTOR if word.endswith("*") else DARK
    if word.startswith("R"):
        return [*rod(legs, p, s), pin(legs, p, s, colour)]
    if s == 1:
        return [rail(legs, p, s), solid(legs, p, s, drum(), colour, 2.6)]
    if legs.words[p, s - 1] == LINK:  # the tube of the bent cylinder is there
        return [*rod(legs, p, s), solid(legs, p, s, drum(), colour, 1.4)]
    return [*rod(legs, p, s), *sleeve(legs, p, s, colour)]


def shared(legs: Legs, p: int, s: int) -> bool:
    """True where an earlier path of the same leg has been here too."""
    earlier = [k for k in range(p) if legs.owners[k] == legs.owners[p]]
    return any(
        np.array_equal(legs.words[k, : s + 1], legs.words[p, : s + 1])
        and np.array_equal(legs.points[:, k, : s + 1], legs.points[:, p, : s + 1])
        for k in earlier
    )


def slides(legs: Legs, p: int, s: int) -> bool:
    """True where a sliding joint is at the station."""
    return str(legs.words[p, s]).startswith("P")


def index(legs: Legs, p: int, s: int) -> int:
    """The number of a station among those of all paths."""
    return p * legs.points.shape[2] + s


def distance(legs: Legs, p: int, s: int) -> Array:
    """The distance from the station before, (T,) m."""
    return np.asarray(np.linalg.norm(legs.points[:, p, s] - legs.points[:, p, s - 1], axis=-1))


def rod(legs: Legs, p: int, s: int) -> list[Part]:
    """The rod from the station before to this one, where they are apart and no bent link leads there."""
    if legs.words[p, s] == "tip" and legs.words[p, s - 1] == LINK:
        return []
    if np.max(distance(legs, p, s), initial=0.0) < 0.5 * legs.width:
        return []
    moves = {"kind": "link", "from": index(legs, p, s - 1), "to": index(legs, p, s), "width": legs.width}
    return [Part((cylinder(),), STEEL, moves)]


def bent_link(legs: Legs, p: int, s: int) -> Part:
    """A flexible link as a tube along its bent axis; the cylinder of a telescope is wider, in the joint's
    colour."""
    row, last = legs.words[p], s
    while last + 1 < len(row) and row[last + 1] == LINK:
        last += 1
    following = str(row[last + 1]) if last + 1 < len(row) else ""
    telescope = following.startswith("P")
    last += following == "tip"
    colour = (MOTOR if following.endswith("*") else DARK) if telescope else STEEL
    width = (1.8 if telescope else 1.0) * legs.width
    moves = {"kind": "tube", "from": index(legs, p, s - 1), "to": index(legs, p, last), "width": width}
    return Part((tube(last - s + 2),), colour, moves)


def sleeve(legs: Legs, p: int, s: int, colour: int) -> list[Part]:
    """The outer tube of a telescope, as long as the shortest slide."""
    length = 0.8 * float(np.min(distance(legs, p, s), initial=np.inf))
    if not legs.width < length < np.inf:
        return [solid(legs, p, s, drum(), colour, 2.6)]
    moves = {"kind": "link", "from": index(legs, p, s - 1), "to": index(legs, p, s)}
    return [Part((cylinder(),), colour, moves | {"width": 1.8 * legs.width, "length": length})]


def pin(legs: Legs, p: int, s: int, colour: int) -> Part:
    """A turning joint, along its axis."""
    moves = {"kind": "pin", "at": index(legs, p, s), "width": 1.7 * legs.width, "length": 5.5 * legs.width}
    return Part((cylinder(),), colour, moves)


def solid(legs: Legs, p: int, s: int, shape: Solid, colour: int, times: float) -> Part:
    """A solid about a station, so many times as wide as a rod, along the axis there."""
    return Part((shape,), colour, {"kind": "solid", "at": index(legs, p, s), "width": times * legs.width})


def pedestal(legs: Legs, p: int) -> Part:
    """The foot of a leg: a flat drum on the base."""
    place = np.eye(4)
    place[:3, :3] = np.diag([3.2, 3.2, 0.7]) * legs.width
    place[:3, 3] = legs.seen(p, 0)[0][0] - [0, 0, 2.2 * legs.width]
    return on_base(legs, drum(), DARK, place)


def rail(legs: Legs, p: int, s: int) -> Part:
    """The rail of a carriage, along its axis, a little longer than its way."""
    points, axes = legs.seen(p, s)
    axis = axes[0]
    way = (points - points[0]) @ axis
    low, high = float(np.min(way)) - 8 * legs.width, float(np.max(way)) + 8 * legs.width
    across = np.cross(axis, [1.0, 0, 0] if abs(axis[0]) < 0.9 else [0, 1.0, 0])
    across /= np.linalg.norm(across)
    place = np.eye(4)
    place[:3, :3] = np.stack(
        [1.3 * legs.width * across, 1.3 * legs.width * np.cross(axis, across), (high - low) * axis], axis=-1
    )
    place[:3, 3] = points[0] + low * axis
    return on_base(legs, cylinder(), STEEL, place)


def on_base(legs: Legs, shape: Solid, colour: int, place: Array) -> Part:
    """A solid that is fixed to the base, (4, 4) in its axes."""
    if legs.base is None:
        return Part((shape,), colour, {"kind": "still"}, place)
    start = np.eye(4)
    start[:3, :3], start[:3, 3] = legs.base[1][0], legs.base[0][0]
    moves = {"kind": "carried", "place": place[:3].ravel().tolist()}
    return Part((shape,), colour, moves, start @ place)


def arrow(attachment: int, width: float) -> Part:
    """A force at an attachment: shaft and head."""
    return Part((cylinder(), cone()), FORCE, {"kind": "arrow", "at": attachment, "width": width})


def borne_arrow(start: Array, way: Array, width: float, moved: Array) -> list[Part]:
    """A force along a way (3,) m from a point, which moves by (3,) m at the amplitude 1: shaft and head."""
    length = float(np.linalg.norm(way))
    z = way / length
    x = np.cross(z, [1.0, 0, 0] if abs(z[0]) < 0.9 else [0, 1.0, 0])
    x /= np.linalg.norm(x)
    head = min(0.5 * length, 4 * width)
    found = []
    for shape, wide, long, place in (
        (cylinder(), width, length - head, start),
        (cone(), 2.4 * width, head, start + (length - head) * z),
    ):
        columns = np.stack([wide * x, wide * np.cross(z, x), long * z])
        moves = {"kind": "borne", "columns": columns.tolist(), "place": place.tolist()}
        found.append(Part((shape,), FORCE, moves | {"moved": moved.tolist()}))
    return found
