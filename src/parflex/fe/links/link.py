"""Flexible links of finite elements, clamped at the frame of their joint: the body of a `Joint`."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array, without_roundoff
from parflex.base.check import integer, scalar, single_rotation
from parflex.base.errors import InputError
from parflex.fe.body.attach import first
from parflex.fe.body.basis import ComputedModes
from parflex.fe.body.canonical import canonical
from parflex.fe.body.columns import independent_columns
from parflex.fe.body.free_body import FreeBody
from parflex.fe.body.integrals import by_node
from parflex.fe.body.joints import Holding, patch, with_places
from parflex.fe.links.buckling import doubt_buckling
from parflex.fe.links.clamped import Clamped, positive_inverse
from parflex.fe.links.places import Patches, patches
from parflex.fe.links.refixed import refixed
from parflex.fe.links.shortening import shortening
from parflex.robot.body import FlexibleBody
from parflex.robot.body import shortening as checked_shortening
from parflex.robot.modal import modal_diagonals, modal_mass
from parflex.robot.modes import Modes
from parflex.robot.moments import shifted, turned

MODES = 4  # of the body held at its frame, where their number is not given


def link(
    body: FreeBody | Modes,
    frame: ArrayLike | None = None,
    interfaces: ArrayLike | None = None,
    *,
    rotation: ArrayLike | None = None,
    ids: Sequence[Sequence[int]] | None = None,
    radius: float | None = None,
    n_modes: int | None = None,
    negligible: float = 0.0,
    damping_ratio: ArrayLike = 0.0,
    foreshortening: ArrayLike | None = None,
) -> FlexibleBody:
    """A part as a flexible link, as `pf.beam` is one: the body of a `Joint`, clamped at its frame.

    `body` is a solid (`solid_body(step_mesh(…), "steel")`), matrices (`read_matrices`, `calculix_body`), or
    the modes of a free body that another program computed. `frame` (3,) m is the origin of the joint's
    frame in the part's coordinates, `rotation` (3, 3) has the axes of that frame as columns, by default
    those of the part; `interfaces` (k, 3) m are the link's attachments, in their order. Each holds the face
    that it lies on or in whose hole it is, with a `radius` (m) the surface's nodes within it, or nodes by
    the numbers of the program: `ids` are those of the frame, then of each interface, whose points are their
    centres where none are given.

    The frame's nodes are fixed to it as one rigid piece; an interface moves and turns as its nodes do in
    the mean (an RBE3). The basis has the `n_modes` lowest modes of the body so held, by default 4, and the
    shapes of a force and of a moment at each interface along three axes: the static stiffness there is the
    finite elements'. Directions whose compliance is at most `negligible` of the largest of their kind at
    their interface count as rigid. Modes of another program are kept, by default all, less the motion of
    the frame's nodes in the mean: the static stiffness is that of those modes. `foreshortening` (k, 3, N,
    N), in the joint's axes, is computed of a solid; of others it may be given.

    Warns NoForeshortening where there is none. Raises InputError where a patch is missing, nowhere on the
    part, shares nodes with another or does not say how it turns, for a stiffness or mass that is not
    positive, and for more modes than there are.
    """
    if not isinstance(body, FreeBody | Modes):
        raise InputError(
            f"body is {type(body).__name__}; expected a FreeBody, as solid_body makes one, or Modes"
        )
    if isinstance(body, FreeBody) and not body.patches:
        raise InputError("body is a plate, of which no link is made; mesh it as a solid: pf.fe.outline_mesh")
    held = patches(body, frame, interfaces, ids, radius)
    R = np.eye(3) if rotation is None else single_rotation("rotation", rotation)
    part = 1.0 * scalar("negligible", negligible)
    modes: Modes
    H: Array | None
    if isinstance(body, FreeBody):
        count = MODES if n_modes is None else integer("n_modes", n_modes)
        modes, H = of_elements(body, held, count, part)
    else:
        modes, H = refixed(first(body, n_modes), held), None
    found = in_frame(modes, held.points[0], R, damping_ratio, H)
    if foreshortening is not None:
        given = checked_shortening(foreshortening, len(found.attachments), found.modes)
        return replace(found, foreshortening=given)
    if H is None:
        doubt_buckling(found)
    return found


def of_elements(
    body: FreeBody, held: Patches, count: int, negligible: float
) -> tuple[ComputedModes, Array | None]:
    """The modes of a body held at its frame, in the part's coordinates, at the frame and the interfaces;
    and H (k, 3, N, N) of the interfaces, of solids."""
    if body.solid is None:
        positive_inverse(
            "mass is not positive definite", body.mass[0::3, 0::3]
        )  # a product with 1 in three directions
    clamped = Clamped(body, held.nodes[0])
    ends = tuple(patch(body, *each) for each in zip(*(part[1:] for part in held), strict=True))
    loads = np.hstack([rows.toarray().T for end in ends for rows in (end.displacement, end.rotation)])
    bent = clamped.static(loads)
    span = np.hstack([bent[:, soft(loads, bent, negligible)], clamped.modes(count)])
    vectors = clamped_basis(body, span, ends)
    modes = at_places(body, vectors, held)
    if body.solid is None:
        return modes, None
    H = []
    for number, end in enumerate(ends):
        t = (end.point - held.points[0]) / np.linalg.norm(end.point - held.points[0])
        pulled = bent[:, 6 * number : 6 * number + 3] @ t
        H.append(shortening(body.nodes, body.solid, pulled, t, vectors))
    return modes, np.array(H)


def soft(loads: Array, bent: Array, negligible: float) -> Array:
    """The loads (p,) bool, three forces and three moments at each place, in whose direction the compliance is
    more than `negligible` of the largest of its kind there."""
    own = np.sum(loads * bent, axis=0).reshape(-1, 3)
    return np.asarray(own > negligible * np.max(own, axis=1, keepdims=True)).ravel()


def clamped_basis(body: FreeBody, vectors: Array, ends: Sequence[Holding]) -> Array:
    """The span (n, N) of vectors that are independent, with m_ee = 1, K diagonal and ascending, and canonical
    signs."""
    vectors = vectors[:, independent_columns(body, vectors, np.ones(vectors.shape[1], dtype=bool))]
    vectors = vectors / np.sqrt(np.sum(vectors * (body.mass @ vectors), axis=0))
    for _ in range(2):
        vectors = vectors @ np.linalg.inv(np.linalg.cholesky(modal_mass(body.moments(vectors)))).T
    squares, turn = np.linalg.eigh(vectors.T @ (body.stiffness @ vectors))
    vectors = vectors @ turn
    deflection = np.vstack([*(end.displacement @ vectors for end in ends), body.displacement @ vectors])
    return canonical(vectors, np.sqrt(squares), deflection, 3 * len(ends))


def at_places(body: FreeBody, vectors: Array, held: Patches) -> ComputedModes:
    """The modes of the vectors (n, N) at nodes, frame and interfaces; the nodes of the frame do not turn."""
    rotations = by_node(body.rotation @ vectors)
    rotations[:, held.nodes[0]] = 0.0
    squares = np.sum(vectors * (body.stiffness @ vectors), axis=0)
    modes = ComputedModes(
        nodes=body.nodes,
        triangles=body.triangles,
        shapes=by_node(body.displacement @ vectors),
        rotations=rotations,
        frequencies=np.sqrt(squares),
        frequency_error=np.full(len(squares), np.nan),
        moments=body.moments(vectors),
        corners=(),
        source=body.source,
    )
    return with_places(modes, list(held.nodes), list(held.points))


def in_frame(
    modes: Modes, origin: Array, R: Array, damping_ratio: ArrayLike, H: Array | None
) -> FlexibleBody:
    """The body of modes that are held at the frame and the interfaces, in the axes R of the joint's frame,
    whose origin is the first node."""
    moments = turned(shifted(modes.moments, origin), R)
    stiffness, damping = modal_diagonals(moments, modes.frequencies, damping_ratio)
    at = modes.corners[0]  # after the nodes of the part, before the interfaces
    order = [at, *range(at), *range(at + 1, len(modes.nodes))]
    assert modes.rotations is not None  # of patches
    return FlexibleBody(
        moments,
        without_roundoff((modes.nodes[order] - origin) @ R),
        modes.shapes[:, order] @ R,
        modes.rotations[:, order] @ R,
        stiffness,
        damping,
        modes.corners[1:],
        modes.triangles + 1,
        None if H is None else np.einsum("iakl,ab->ibkl", H, R),
    )
