"""The places where legs hold an imported platform: nodes by id, points, or patches of nodes."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import exactly, integer, of_type, positive
from parflex.base.errors import InputError
from parflex.fe.body.basis import without_reduction
from parflex.fe.body.canonical import cut_pair
from parflex.fe.body.joints import FEWEST, AnyModes, nodes_within, unshared, with_places
from parflex.robot.attachments import attachment_nodes
from parflex.robot.modes import Modes


def attached(
    modes: AnyModes,
    ids: Sequence[int | Sequence[int]] | None = None,
    points: ArrayLike | None = None,
    radius: float | None = None,
) -> AnyModes:
    """The modes, held at places of a body: `FlexibleBody.from_modes(attached(…))` needs no more.

    ids are the other program's node numbers, or a list of them for a patch; or points (k, 3) m are
    nodes' coordinates, and with a radius (m) the centres of patches of the surface's nodes around them. A
    patch is one more node, at the centre of its nodes or at the point, which moves and turns as they do
    in the mean (an RBE3).

    Raises InputError for a node that is not there, a point on no node or off the body, a patch of fewer
    than three nodes, and for places that share nodes.
    """
    of_type("modes", modes, Modes)
    if not isinstance(ids, Sequence | np.ndarray | None):
        raise InputError(f"ids is {type(ids).__name__}; give a list of node numbers")
    if ids is not None and points is None:
        groups = [by_id(modes, number, given) for number, given in enumerate(ids)]
        centres = [np.mean(modes.nodes[group], axis=0) for group in groups]
    elif points is not None and ids is None:
        wanted = exactly("points", points, (None, 3))
        groups, centres = rows_near(modes, wanted, radius), list(wanted)
    else:
        raise InputError(
            "ids and points are both given, or neither; give node numbers, or points (k, 3) in m"
        )
    unshared([f"place {number}" for number in range(1, len(groups) + 1)], groups)
    return with_places(without_reduction(modes), groups, centres)


def by_id(modes: Modes, number: int, given: int | Sequence[int]) -> Array:
    """Rows of nodes of one place."""
    wanted = list(given) if isinstance(given, Sequence) else [given]
    row = {node: k for k, node in enumerate(modes.ids) if node > 0}
    for node in wanted:
        if integer(f"ids[{number}]", node) not in row:
            raise InputError(f"ids[{number}] has node {node}, which the model has not ({len(row)} nodes)")
    if isinstance(given, Sequence) and len(set(wanted)) < FEWEST:
        raise InputError(
            f"ids[{number}] is a patch of {len(set(wanted))} nodes; give three or more, or one alone"
        )
    return np.array(sorted({row[node] for node in wanted}))


def rows_near(modes: Modes, wanted: Array, radius: float | None) -> list[Array]:
    """Rows of nodes at points, or around them."""
    if radius is None:
        return [np.array([node]) for node in attachment_nodes(modes.nodes, wanted)]
    names = [f"points[{number}]" for number in range(len(wanted))]
    return nodes_within(modes.nodes, modes.triangles, names, wanted, positive("radius", radius))


def first(modes: AnyModes, n: int | None) -> AnyModes:
    """The n lowest modes, all for None; a note where they cut a degenerate pair in two.

    Raises InputError where there are fewer.
    """
    if n is None or integer("modes", n) == len(modes.frequencies):
        return modes
    if n > len(modes.frequencies):
        raise InputError(
            f"modes is {n}, but the file has {len(modes.frequencies)} elastic ones; compute more"
        )
    moments = modes.moments
    return replace(
        without_reduction(modes),
        shapes=modes.shapes[:n],
        rotations=None if modes.rotations is None else modes.rotations[:n],
        frequencies=modes.frequencies[:n],
        frequency_error=modes.frequency_error[:n],
        moments=moments._replace(S=moments.S[:, :n], P1=moments.P1[:n], P2=moments.P2[:n, :n]),
        notes=(*modes.notes, *cut_pair(modes.frequencies, n)),
    )
