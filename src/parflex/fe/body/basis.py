"""Bases for the elastic motion of a platform: values that make `Modes` of a free body.

`FreeFree(n)` keeps the lowest free–free modes. `FreeFreeWithAttachment(n)` adds what they leave of
the body's static response to forces at its joints: residual attachment modes under inertia relief,

    u_i = (K⁺ − Φ ω⁻² Φᵀ) f_i,      K⁺ f: deformation of the free body under f and its inertia forces

(Craig 1981, ch. 19; Rixen 2004). Both are made M-orthonormal with K diagonal, without momentum.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import integer, scalar
from parflex.base.errors import InputError
from parflex.fe.body.canonical import canonical, cut_pair
from parflex.fe.body.free_body import FreeBody
from parflex.fe.body.integrals import rigid_momentum
from parflex.fe.body.joints import Place, places
from parflex.fe.body.response import static_response
from parflex.robot.modes import Modes
from parflex.robot.moments import shifted

NEGLIGIBLE = 1e-3  # compliance of a direction, of the largest
DEPENDENT = 1e-8  # modal mass that is left of a vector beside the others


class Columns(NamedTuple):
    """Vectors of unknowns (n, N) that span a basis, and what must be said of them."""

    vectors: Array
    notes: tuple[str, ...] = ()


class Reduction(NamedTuple):
    """A body, its places, and the vectors (n, N) that its motion was reduced to."""

    body: FreeBody
    held: tuple[Place, ...]
    vectors: Array
    basis: "Basis"


@dataclass(frozen=True, eq=False)
class Basis(ABC):
    """What is kept of a body's elastic motion.

    n free–free modes. points are the joints, node numbers or (k, 3) m, by default the body's corners;
    tool is one more place, where a wrench may act; on solids each is the patch of surface
    nodes within `radius` m (`joints.places`). Directions whose static compliance is below `negligible`
    of the largest at their place count as rigid.
    """

    n: int
    points: Sequence[int] | ArrayLike | None = None
    tool: int | ArrayLike | None = None
    radius: float | None = None
    negligible: float = NEGLIGIBLE

    def __post_init__(self) -> None:
        integer("n", self.n)
        if not 0 <= scalar("negligible", self.negligible) < 1:
            raise InputError(f"negligible is {self.negligible}; give a part of the largest compliance, 0 … 1")

    @abstractmethod
    def columns(self, body: FreeBody, held: tuple[Place, ...]) -> Columns:
        """The elastic vectors, in any order and scale."""

    def modes(self, body: FreeBody) -> Modes:
        """The modes of a body in this basis, attached at its places.

        Raises InputError for places that are off the body or share nodes, for a body that is not free,
        and for more modes than its mesh can carry.
        """
        held = places(body, self.points, self.tool, self.radius)
        chosen = self.columns(body, held)
        vectors = orthonormal(body, chosen.vectors, held)
        return tabulated(Reduction(body, held, vectors, self), chosen.notes)


@dataclass(frozen=True, eq=False)
class FreeFree(Basis):
    """The n lowest free–free modes: for a platform that nothing stiff holds."""

    def columns(self, body: FreeBody, held: tuple[Place, ...]) -> Columns:
        squares, vectors = body.free_modes(self.n)
        return Columns(vectors[:, : self.n], cut_pair(np.sqrt(squares), self.n))


@dataclass(frozen=True, eq=False)
class FreeFreeWithAttachment(Basis):
    """The n lowest free–free modes and residual attachment modes: for a platform held at its joints.

    One vector for each force direction at each joint and for each component of a wrench at the tool;
    those that would add less than `negligible` of the largest compliance of their kind there are left
    out, and named in the notes.
    """

    def columns(self, body: FreeBody, held: tuple[Place, ...]) -> Columns:
        squares, vectors = body.free_modes(self.n)
        squares, vectors = squares[: self.n], vectors[:, : self.n]
        static = static_response(body, held)
        loads = static.loads
        residual = static.flexed - vectors @ ((vectors.T @ loads.columns) / squares[:, None])
        kept = static.soft(np.sum(loads.columns * residual, axis=0), self.negligible)
        kept = independent(body, residual, kept)
        return Columns(np.hstack([vectors, residual[:, kept]]), left_out(loads.names, kept))


def left_out(names: tuple[str, ...], kept: Array) -> tuple[str, ...]:
    """A note that names the loads (place, direction) without an attachment mode."""
    by_direction: dict[str, list[str]] = {}
    for name, keep in zip(names, kept, strict=True):
        place, _, direction = name.partition(" along ")
        if not keep:
            by_direction.setdefault(direction, []).append(place)
    words = [f"{', '.join(places)} along {direction}" for direction, places in by_direction.items()]
    return (f"no attachment modes, since too stiff: {'; '.join(words)}",) if words else ()


def independent(body: FreeBody, vectors: Array, kept: Array) -> Array:
    """Which of the vectors kept add something to those before them; (p,) bool."""
    basis = np.zeros((body.unknowns, 0))
    out = kept.copy()
    for column in np.flatnonzero(kept):
        v = vectors[:, column] / np.sqrt(vectors[:, column] @ (body.mass @ vectors[:, column]))
        for _ in range(2):
            v = v - basis @ (basis.T @ (body.mass @ v))
        left = float(v @ (body.mass @ v))
        if left < DEPENDENT:
            out[column] = False
        else:
            basis = np.column_stack([basis, v / np.sqrt(left)])
    return out


def orthonormal(body: FreeBody, vectors: Array, held: tuple[Place, ...]) -> Array:
    """The same space, with m_ee = 1, K diagonal and ascending, S = β = 0, and canonical signs."""
    vectors = vectors / np.sqrt(np.sum(vectors * (body.mass @ vectors), axis=0))
    for _ in range(2):
        vectors = without_momentum(body, vectors)
        modal = np.trace(body.moments(vectors).P2, axis1=-2, axis2=-1)
        vectors = vectors @ np.linalg.inv(np.linalg.cholesky(modal)).T
    squares, turn = np.linalg.eigh(vectors.T @ (body.stiffness @ vectors))
    vectors = vectors @ turn
    deflection = np.vstack([*(place.displacement @ vectors for place in held), body.displacement @ vectors])
    return canonical(vectors, np.sqrt(squares), deflection, 3 * len(held))


def without_momentum(body: FreeBody, vectors: Array) -> Array:
    """Columns less the rigid motion that carries their momentum, measured by the body's integrals."""
    at = body.can_move
    found = body.moments(vectors)
    momentum = rigid_momentum(shifted(found, found.MS0 / found.m))[at]
    return vectors - body.rigid[:, at] @ np.linalg.solve(body.rigid_inertia, momentum)


def tabulated(reduction: Reduction, notes: tuple[str, ...]) -> Modes:
    """Shapes at the nodes and at the places, frequencies, integrals."""
    body, held, vectors, basis = reduction
    tool = basis.tool is not None
    extra = [place for place in held if place.node is None]
    shapes = by_node(np.vstack([body.displacement @ vectors, *(p.displacement @ vectors for p in extra)]))
    rotations = by_node(np.vstack([body.rotation @ vectors, *(p.rotation @ vectors for p in extra)]))
    numbers = place_numbers(body, held)
    squares = np.sum(vectors * (body.stiffness @ vectors), axis=0)
    return Modes(
        nodes=np.vstack([body.nodes, *(p.point[None] for p in extra)]),
        triangles=body.triangles,
        shapes=shapes,
        rotations=rotations,
        frequencies=np.sqrt(squares),
        frequency_error=np.full(len(squares), np.nan),
        moments=body.moments(vectors),
        corners=numbers[: len(held) - tool],
        source=body.source,
        notes=(*body.notes, *notes),
        tool=numbers[-1] if tool else None,
        solid=body.solid,
        reduction=reduction,
    )


def place_numbers(body: FreeBody, held: tuple[Place, ...]) -> tuple[int, ...]:
    """The node of each place; those of patches follow the body's own."""
    own, free = [], len(body.nodes)
    for place in held:
        own.append(free if place.node is None else place.node)
        free += place.node is None
    return tuple(own)


def by_node(rows: Array) -> Array:
    """(3K, N) as (N, K, 3)."""
    return np.ascontiguousarray(rows.T.reshape(rows.shape[1], len(rows) // 3, 3))
