"""The places where legs and tools hold a body: a node that can turn, or a patch of nodes that move as one."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import count
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse
from scipy.spatial import cKDTree

from parflex.base.array import Array, skew
from parflex.base.check import exactly, positive
from parflex.base.errors import InputError
from parflex.fe.body.free_body import FreeBody
from parflex.fe.body.integrals import Sparse
from parflex.robot.attachments import attachment_nodes
from parflex.robot.modes import Modes

AnyModes = TypeVar("AnyModes", bound=Modes)

PATCH = 0.025  # of the body's diagonal: a patch's radius where none is given
FEWEST = 3  # nodes of a patch
TOOL = "tool"


class Holding(NamedTuple):
    """A point fixed to the body: its displacement (3, n) and rotation (3, n) from the unknowns."""

    name: str
    point: Array  # (3,) m
    nodes: Array  # one of the body, or those of a patch
    displacement: Sparse
    rotation: Sparse

    @property
    def is_tool(self) -> bool:
        """True where wrenches act, and no leg."""
        return self.name == TOOL


def places(
    body: FreeBody,
    points: Sequence[int] | ArrayLike | None,
    tool: int | ArrayLike | None = None,
    radius: float | None = None,
) -> tuple[Holding, ...]:
    """The joints, "joint 1" and so on, and the tool last where there is one.

    points are node numbers or coordinates (k, 3) m, by default the body's corners; tool is one of
    either. On a body of `patches` each is a patch: the mean motion of the surface's nodes within
    `radius` m, by default 2.5 % of the body's diagonal, at the point (an RBE3).

    Raises InputError for a point off the body, for patches of fewer than three nodes, and where two
    of them share nodes.
    """
    wanted = located("points", body, body.corners if points is None else points)
    names = [f"joint {number}" for number in range(1, len(wanted) + 1)]
    if tool is not None:
        wanted = np.vstack([wanted, located("tool", body, [tool])])
        names.append(TOOL)
    if not body.patches:
        return at_nodes(body, names, wanted)
    diagonal = float(np.linalg.norm(np.ptp(body.nodes, axis=0)))
    reach = PATCH * diagonal if radius is None else positive("radius", radius)
    held = nodes_within(body.nodes, body.triangles, names, wanted, reach)
    return tuple(patch(body, *each) for each in zip(names, wanted, held, strict=True))


def located(name: str, body: FreeBody, wanted: Any) -> Array:
    """Coordinates (k, 3) of node numbers, or of points."""
    try:
        array = np.asarray(wanted)
    except ValueError:
        raise InputError(f"{name} is ragged; give node numbers, or points (k, 3)") from None
    if array.ndim == 1 and (array.dtype.kind in "iu" or array.size == 0):
        for number, node in enumerate(array):
            if not 0 <= node < len(body.nodes):
                raise InputError(
                    f"{name}[{number}] is node {node}; this body has nodes 0 … {len(body.nodes) - 1}"
                )
        return body.nodes[array.astype(int)]
    return exactly(name, array, (None, 3))


def at_nodes(body: FreeBody, names: list[str], wanted: Array) -> tuple[Holding, ...]:
    """The places that are each a node of their own."""
    found = [np.array([node]) for node in attachment_nodes(body.nodes, wanted)]
    unshared(names, found)
    matrices = [body.displacement.tocsr(), body.rotation.tocsr()]
    return tuple(
        Holding(name, body.nodes[node[0]], node, *(X[3 * node[0] : 3 * node[0] + 3] for X in matrices))
        for name, node in zip(names, found, strict=True)
    )


def nodes_within(
    nodes: Array, triangles: Array, names: list[str], wanted: Array, reach: float
) -> list[Array]:
    """Numbers of the surface's nodes within reach (m) of each point, no node in two of them.

    Raises InputError as `places` does.
    """
    surface = np.unique(triangles) if len(triangles) else np.arange(len(nodes))
    tree = cKDTree(nodes[surface])
    held = []
    for name, point in zip(names, wanted, strict=True):
        distance, nearest = tree.query(point)
        near = surface[tree.query_ball_point(point, reach)]
        if len(near) == 0:
            raise InputError(
                f"{name} at {point} is off the body: the nearest node of the surface, at "
                f"{nodes[surface[nearest]]}, is {distance:.4g} m away; move it, or give a larger radius"
            )
        if len(near) < FEWEST:
            raise InputError(
                f"{name} at {point} has {len(near)} of the surface's nodes within {reach:.4g} m, too few for "
                f"a patch; refine the mesh there, or give a larger radius"
            )
        held.append(np.sort(near))
    unshared(names, held)
    return held


def patch(body: FreeBody, name: str, point: Array, near: Array) -> Holding:
    """The mean displacement and rotation of nodes, carried to the point."""
    carried, turn = mean_motion(body.nodes[near], point)
    chosen = body.displacement.tocsr()[(3 * near[:, None] + np.arange(3)).ravel()]
    return Holding(name, point, near, sparse.csr_array(carried @ chosen), sparse.csr_array(turn @ chosen))


def mean_motion(r: Array, point: Array) -> tuple[Array, Array]:
    """Displacement at a point and rotation, (3, 3n) each, of nodes (n, 3) from their displacements.

    ū = mean u, θ = J⁻¹ Σ s × u with J = Σ (|s|² 1 − s sᵀ), s from the nodes' centre; u(p) = ū + θ × (p − c).
    """
    centre = np.mean(r, axis=0)
    s = r - centre
    J = np.sum(s**2) * np.eye(3) - s.T @ s
    turn = np.linalg.pinv(J, rcond=1e-9) @ np.concatenate([skew(each) for each in s], axis=1)
    return np.tile(np.eye(3) / len(r), len(r)) - skew(point - centre) @ turn, turn


def with_places(modes: AnyModes, groups: list[Array], centres: list[Array]) -> AnyModes:
    """The modes held at groups of nodes: at the node of a group of one, else at one more node, at the centre
    (3,) m, which moves and turns as the group does in the mean."""
    patches = [each for each in zip(groups, centres, strict=True) if len(each[0]) > 1]
    new = count(len(modes.nodes))
    corners = tuple(int(group[0]) if len(group) == 1 else next(new) for group in groups)
    if not patches:
        return replace(modes, corners=corners)
    N = len(modes.shapes)
    motions = [
        np.stack(mean_motion(modes.nodes[group], centre)) @ modes.shapes[:, group].reshape(N, -1).T
        for group, centre in patches
    ]
    moved, turned = np.transpose(motions, (1, 3, 0, 2))
    turns = np.zeros_like(modes.shapes) if modes.rotations is None else modes.rotations
    return replace(
        modes,
        nodes=np.vstack([modes.nodes, *(centre for _, centre in patches)]),
        shapes=np.concatenate([modes.shapes, moved], axis=1),
        rotations=np.concatenate([turns, turned], axis=1),
        corners=corners,
        ids=modes.ids and (*modes.ids, *[0] * len(patches)),
    )


def unshared(names: list[str], held: list[Array]) -> None:
    """Raise InputError where two places hold the same node."""
    owner: dict[int, str] = {}
    for name, nodes in zip(names, held, strict=True):
        for node in nodes:
            if int(node) in owner:
                raise InputError(
                    f"{owner[int(node)]} and {name} both hold node {node}; move them apart, or give a "
                    f"smaller radius"
                )
            owner[int(node)] = name
