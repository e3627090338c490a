"""The places where legs and tools hold a body: a node that can turn, or a patch of nodes that move as one."""

from collections.abc import Sequence
from typing import NamedTuple

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

PATCH = 0.025  # of the body's diagonal: a patch's radius where none is given
FEWEST = 3  # nodes of a patch
TOOL = "tool"


class Place(NamedTuple):
    """A point fixed to the body: its displacement (3, n) and rotation (3, n) from the unknowns."""

    name: str
    point: Array  # (3,) m
    node: int | None  # where it is a node of the body
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
) -> tuple[Place, ...]:
    """The joints, "joint 1" and so on, and the tool last where there is one.

    points are node numbers or coordinates (k, 3) m, by default the body's corners; tool is one of
    either. On a body of `patches` each is a patch: the mean motion of the surface's nodes within
    `radius` m, by default 2.5 % of the body's diagonal, at the point (an RBE3).

    Raises InputError for a point off the body, for patches of fewer than three nodes, and where two
    of them share nodes.
    """
    wanted = located(body, body.corners if points is None else points)
    names = [f"joint {number}" for number in range(1, len(wanted) + 1)]
    if tool is not None:
        wanted = np.vstack([wanted, located(body, np.asarray(tool)[None])])
        names.append(TOOL)
    if not body.patches:
        return at_nodes(body, names, wanted)
    size = float(np.linalg.norm(np.ptp(body.nodes, axis=0)))
    reach = PATCH * size if radius is None else positive("radius", radius)
    return patches(body, names, wanted, reach)


def located(body: FreeBody, wanted: Sequence[int] | ArrayLike) -> Array:
    """Coordinates (k, 3) of node numbers, or of points."""
    try:
        array = np.asarray(wanted)
    except ValueError:
        raise InputError("points is ragged; give node numbers, or points (k, 3)") from None
    if array.ndim == 1 and (array.dtype.kind in "iu" or array.size == 0):
        for number, node in enumerate(array):
            if not 0 <= node < len(body.nodes):
                raise InputError(
                    f"points[{number}] is node {node}; this body has nodes 0 … {len(body.nodes) - 1}"
                )
        return body.nodes[array.astype(int)]
    return exactly("points", array, (None, 3))


def at_nodes(body: FreeBody, names: list[str], wanted: Array) -> tuple[Place, ...]:
    """Each on a node of its own."""
    found = attachment_nodes(body.nodes, wanted)
    unshared(names, [np.array([node]) for node in found])
    rows = [slice(3 * node, 3 * node + 3) for node in found]
    displacement, rotation = body.displacement.tocsr(), body.rotation.tocsr()
    return tuple(
        Place(name, body.nodes[node], node, displacement[at], rotation[at])
        for name, node, at in zip(names, found, rows, strict=True)
    )


def patches(body: FreeBody, names: list[str], wanted: Array, reach: float) -> tuple[Place, ...]:
    """The surface's nodes within reach of each point."""
    held = nodes_within(body.nodes, body.triangles, names, wanted, reach)
    return tuple(
        patch(body, name, point, near) for name, point, near in zip(names, wanted, held, strict=True)
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


def patch(body: FreeBody, name: str, point: Array, near: Array) -> Place:
    """The mean displacement and rotation of nodes, carried to the point."""
    carried, turn = mean_motion(body.nodes[near], point)
    rows = (3 * near[:, None] + np.arange(3)).ravel()
    chosen = body.displacement.tocsr()[rows]
    return Place(name, point, None, sparse.csr_array(carried @ chosen), sparse.csr_array(turn @ chosen))


def mean_motion(r: Array, point: Array) -> tuple[Array, Array]:
    """Displacement at a point and rotation, (3, 3n) each, of nodes (n, 3) from their displacements.

    ū = mean u, θ = J⁻¹ Σ s × u with J = Σ (|s|² 1 − s sᵀ), s from the nodes' centre; u(p) = ū + θ × (p − c).
    """
    centre = np.mean(r, axis=0)
    s = r - centre
    J = np.sum(s**2) * np.eye(3) - s.T @ s
    turn = np.linalg.pinv(J, rcond=1e-9) @ np.concatenate([skew(each) for each in s], axis=1)
    mean = np.tile(np.eye(3) / len(r), len(r))
    return mean - skew(point - centre) @ turn, turn


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
