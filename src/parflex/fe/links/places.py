"""The patches of a link: where the frame of its joint holds it, and its interfaces."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import exactly, integer, positive
from parflex.base.errors import InputError
from parflex.fe.body.free_body import FreeBody
from parflex.fe.body.joints import FEWEST, nodes_within, unshared
from parflex.fe.links.face import face_at
from parflex.robot.modes import Modes

SLENDER = 1e-6  # a patch that is thinner, of its length, does not say how it turns
FEW = "which do not say how it turns, since they are fewer than three or in one line; give more nodes"


class Patches(NamedTuple):
    """The names of the frame and the interfaces, their points (3,) m and the rows of their nodes."""

    names: tuple[str, ...]
    points: tuple[Array, ...]
    nodes: tuple[Array, ...]


def patches(
    body: FreeBody | Modes,
    frame: ArrayLike | None,
    interfaces: ArrayLike | None,
    ids: Sequence[Sequence[int]] | None,
    radius: float | None,
) -> Patches:
    """The frame's patch, then those of the interfaces.

    Raises InputError where one is missing, nowhere on the part, shares nodes with another, or does not say
    how it turns.
    """
    if ids is not None:
        if not isinstance(ids, Sequence | np.ndarray) or isinstance(ids, str):
            raise InputError(f"ids is {type(ids).__name__}; give a list of lists of node numbers")
        names, points, found = by_number(body, list(ids), frame, interfaces, radius)
    else:
        names, points = wanted_points(frame, interfaces)
        if radius is None:
            found = [face_at(body.nodes, body.triangles, *each) for each in zip(names, points, strict=True)]
        else:
            reach = positive("radius", radius)
            found = nodes_within(body.nodes, body.triangles, list(names), np.array(points), reach)
    unshared(list(names), found)
    for name, nodes in zip(names, found, strict=True):
        check_turns(name, body.nodes[nodes])
    check_apart(names, points)
    return Patches(names, points, tuple(found))


def wanted_points(
    frame: ArrayLike | None, interfaces: ArrayLike | None
) -> tuple[tuple[str, ...], tuple[Array, ...]]:
    """The points of the frame and of the interfaces, by name."""
    if frame is None:
        raise InputError(
            "frame is missing; give the point of the part that is the origin of the joint's frame, (3,) m, "
            "or ids, the nodes of the frame and of each interface"
        )
    if interfaces is None or (isinstance(interfaces, Sequence) and not interfaces):
        interfaces = np.zeros((0, 3))
    points = exactly("interfaces", interfaces, (None, 3))
    if not len(points):
        raise InputError(
            "interfaces is missing; give the points (k, 3) m of the part where next joints and tips sit"
        )
    names = ("frame", *(f"interfaces[{k}]" for k in range(len(points))))
    return names, (exactly("frame", frame, (3,)), *points)


def by_number(
    body: FreeBody | Modes,
    groups: list[Sequence[int]],
    frame: ArrayLike | None,
    interfaces: ArrayLike | None,
    radius: float | None,
) -> tuple[tuple[str, ...], tuple[Array, ...], list[Array]]:
    """Names, points and rows of the patches whose nodes are given by their numbers."""
    if radius is not None:
        raise InputError(f"radius is {radius} beside ids, which name all nodes of the patches; keep one")
    if len(groups) < 2:
        raise InputError(
            f"ids has {len(groups)} lists of nodes; give the nodes of the frame, then of each interface"
        )
    found = [numbered(body, k, group) for k, group in enumerate(groups)]
    names = ("frame", *(f"interfaces[{k}]" for k in range(len(groups) - 1)))
    return names, centres(body, found, frame, interfaces), found


def numbered(body: FreeBody | Modes, number: int, group: Sequence[int]) -> Array:
    """The rows of nodes that are given by the numbers of the program; from 0 where it has none."""
    if not isinstance(group, Sequence | np.ndarray) or isinstance(group, str):
        raise InputError(f"ids[{number}] is {group!r}; give a list of node numbers")
    known = body.ids or range(len(body.nodes))
    rows = {node: row for row, node in enumerate(known)}
    for node in group:
        if integer(f"ids[{number}]", node) not in rows:
            raise InputError(f"ids[{number}] has node {node}, which the model has not ({len(rows)} nodes)")
    return np.array(sorted({rows[node] for node in group}), dtype=int)


def centres(
    body: FreeBody | Modes, found: Sequence[Array], frame: ArrayLike | None, interfaces: ArrayLike | None
) -> tuple[Array, ...]:
    """The points that are given, else the centres of the patches."""
    middle = [np.mean(body.nodes[nodes], axis=0) if len(nodes) else np.zeros(3) for nodes in found]
    first = middle[0] if frame is None else exactly("frame", frame, (3,))
    rest = middle[1:] if interfaces is None else exactly("interfaces", interfaces, (len(found) - 1, 3))
    return (first, *rest)


def check_turns(name: str, nodes: Array) -> None:
    """Raise InputError for nodes (n, 3) whose displacements do not tell a rotation."""
    spread = np.linalg.svd(nodes - np.mean(nodes, axis=0), compute_uv=False) if len(nodes) else np.zeros(3)
    if len(nodes) < FEWEST or spread[1] <= SLENDER * spread[0]:
        raise InputError(f"{name} is a patch of {len(nodes)} nodes, {FEW}")


def check_apart(names: Sequence[str], points: Sequence[Array]) -> None:
    """Raise InputError for an interface at the frame's origin, to which no tension has a direction."""
    for name, point in zip(names[1:], points[1:], strict=True):
        if not np.linalg.norm(point - points[0]) > 0.0:
            raise InputError(f"{name} is at {point} m, the origin of the frame; give another point")
