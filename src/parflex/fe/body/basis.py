"""Bases for the elastic motion of a platform: values that make `Modes` of a free body.

`FreeFree(n)` keeps the lowest free–free modes. `FreeFreeWithAttachment(n)` adds what they leave of
the body's static response to forces at its joints: residual attachment modes under inertia relief,

    u_i = (K⁺ − Φ ω⁻² Φᵀ) f_i,      K⁺ f: deformation of the free body under f and its inertia forces

(Craig 1981, ch. 19; Rixen 2004). Both are made M-orthonormal with K diagonal, without momentum.

A basis makes modes, and modes find a better basis: so both are here.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import integer, of_type, scalar
from parflex.base.errors import InputError
from parflex.fe.body.accuracy import BasisError, error_of, gram_of
from parflex.fe.body.canonical import cut_pair
from parflex.fe.body.check_report import Report
from parflex.fe.body.columns import independent, left_out, orthonormal
from parflex.fe.body.free_body import FreeBody
from parflex.fe.body.integrals import by_node
from parflex.fe.body.joints import Place, places
from parflex.fe.body.material import Solid
from parflex.fe.body.pinned import truth_of
from parflex.fe.body.response import static_response
from parflex.fe.body.search import smallest
from parflex.robot.modes import Modes

NEGLIGIBLE = 1e-3  # compliance of a direction, of the largest


class Columns(NamedTuple):
    """Vectors of unknowns (n, N) that span a basis, and what must be said of them."""

    vectors: Array
    notes: tuple[str, ...] = ()


class Reduction(NamedTuple):
    """A body, its places, the vectors (n, N) that its motion was reduced to, and the basis of them."""

    body: FreeBody
    held: tuple[Place, ...]
    vectors: Array
    basis: "Basis"


@dataclass(frozen=True, eq=False, repr=False)
class ComputedModes(Modes):
    """Modes with what is known of their origin.

    `report` is the check report of imported ones; `solid` are elements and materials, for stresses;
    `reduction` is the model that the modes were computed from, None where they were read or imported.
    """

    report: Report | None = None
    solid: Solid | None = None
    reduction: Reduction | None = None

    @cached_property
    def error(self) -> BasisError:
        """The errors of the basis; see `basis_error`."""
        return basis_error(self)

    def converged(self, tolerance: float = 0.01, up_to: float | None = None) -> "ComputedModes":
        """The modes of the smallest basis that is right to a tolerance; see `converged`."""
        return converged(self, tolerance, up_to)


@dataclass(frozen=True, eq=False)
class Basis(ABC):
    """A choice of what is kept of a body's elastic motion.

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

    def modes(self, body: FreeBody) -> ComputedModes:
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


def reduction_of(modes: Modes) -> Reduction:
    """The model that modes were computed from. Raises InputError where it is not at hand."""
    of_type("modes", modes, Modes)
    found = modes.reduction if isinstance(modes, ComputedModes) else None
    if found is None:
        raise InputError(
            "the model of these modes is not at hand: they were read from a file, or imported; compute "
            "them with a basis of pf.fe from the body itself"
        )
    return found


def without_reduction(modes: Any) -> Any:
    """Modes that are to be changed, so that they no longer are those of their model."""
    return replace(modes, reduction=None) if isinstance(modes, ComputedModes) else modes


def basis_error(modes: Modes, up_to: float | None = None) -> BasisError:
    """The errors of the basis against the full model.

    They are those of the static compliance at joints and tool, and of the frequencies of the body pinned
    at its joints, up to `up_to` rad/s, by default the first five.

    Raises InputError where the model is not at hand.
    """
    body, held, vectors, basis = reduction_of(modes)
    truth = truth_of(body, held, basis.negligible, up_to)
    return error_of(body, held, truth, gram_of(body, vectors, truth.static))


def converged(modes: Modes, tolerance: float = 0.01, up_to: float | None = None) -> ComputedModes:
    """The modes of the smallest basis of free–free and attachment modes that is right to a tolerance.

    So much may the frequencies of the body pinned at its joints lie above those of the full model, up to
    `up_to` rad/s, by default the first five, and its static compliance at joints and tool differ.

    Raises InputError where the model is not at hand, and NotConverged where no basis of reasonable size
    is that good.
    """
    body, held, _, basis = reduction_of(modes)
    n, attachment, negligible = smallest(body, held, tolerance, up_to)
    kind = FreeFreeWithAttachment if attachment else FreeFree
    return kind(n, basis.points, basis.tool, basis.radius, negligible).modes(body)


def tabulated(reduction: Reduction, notes: tuple[str, ...]) -> ComputedModes:
    """Shapes at the nodes and at the places, frequencies, integrals."""
    body, held, vectors, basis = reduction
    tool = basis.tool is not None
    extra = [place for place in held if place.node is None]
    shapes = by_node(np.vstack([body.displacement @ vectors, *(p.displacement @ vectors for p in extra)]))
    rotations = by_node(np.vstack([body.rotation @ vectors, *(p.rotation @ vectors for p in extra)]))
    numbers = place_numbers(body, held)
    squares = np.sum(vectors * (body.stiffness @ vectors), axis=0)
    return ComputedModes(
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
        report=body.report,
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
