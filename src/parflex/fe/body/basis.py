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
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import integer, of_type, scalar
from parflex.base.errors import InputError
from parflex.fe.body.accuracy import BasisError, error_of, gram_of, truth_of
from parflex.fe.body.canonical import cut_pair
from parflex.fe.body.check_report import Report
from parflex.fe.body.columns import independent_columns, left_out, orthonormal
from parflex.fe.body.free_body import FreeBody
from parflex.fe.body.integrals import by_node
from parflex.fe.body.joints import Holding, places, with_places
from parflex.fe.body.missed import missed_at_nodes
from parflex.fe.body.response import static_response
from parflex.fe.body.search import smallest
from parflex.fe.body.solid import Solid
from parflex.robot.material import Material
from parflex.robot.modes import Modes

NEGLIGIBLE = 1e-3  # compliance of a direction, of the largest

Columns = tuple[Array, tuple[str, ...]]  # vectors (n, N) that span a basis, and notes about them


class Reduction(NamedTuple):
    """A body, its places, the vectors (n, N) that its motion was reduced to, and the basis of them."""

    body: FreeBody
    held: tuple[Holding, ...]
    vectors: Array
    basis: "Basis"


@dataclass(frozen=True, eq=False, repr=False)
class ComputedModes(Modes):
    """Modes with what is known of their origin.

    `report` is the check report of imported ones; `materials` are those of the body, where they are known;
    `solid` are elements and materials, for stresses;
    `reduction` is the model that the modes were computed from, None where they were read or imported.
    """

    report: Report | None = None
    materials: tuple[Material, ...] = ()
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

    static: ClassVar[bool] = False  # whether static shapes at the places are kept

    @abstractmethod
    def columns(self, body: FreeBody, held: tuple[Holding, ...]) -> Columns:
        """The elastic vectors, in any order and scale."""

    def modes(self, body: FreeBody) -> ComputedModes:
        """The modes of a body in this basis, attached at its places.

        Raises InputError for places that are off the body or share nodes, for a body that is not free,
        and for more modes than its mesh can carry.
        """
        of_type("body", body, FreeBody)
        held = places(body, self.points, self.tool, self.radius)
        vectors, notes = self.columns(body, held)
        return tabulated(Reduction(body, held, orthonormal(body, vectors, held), self), notes)


@dataclass(frozen=True, eq=False)
class FreeFree(Basis):
    """The n lowest free–free modes: for a platform that nothing stiff holds."""

    def columns(self, body: FreeBody, held: tuple[Holding, ...]) -> Columns:
        squares, vectors = body.free_modes(self.n)
        return vectors[:, : self.n], cut_pair(np.sqrt(squares), self.n)


@dataclass(frozen=True, eq=False)
class FreeFreeWithAttachment(Basis):
    """The n lowest free–free modes and residual attachment modes: for a platform held at its joints.

    One vector for each force direction at each joint and for each component of a wrench at the tool;
    those that would add less than `negligible` of the largest compliance of their kind there are left
    out, and named in the notes.
    """

    static = True

    def columns(self, body: FreeBody, held: tuple[Holding, ...]) -> Columns:
        squares, vectors = body.free_modes(self.n)
        squares, vectors = squares[: self.n], vectors[:, : self.n]
        static = static_response(body, held)
        residual = static.flexed - vectors @ ((vectors.T @ static.columns) / squares[:, None])
        soft = static.soft(np.sum(static.columns * residual, axis=0), self.negligible)
        kept = independent_columns(body, residual, soft)
        return np.hstack([vectors, residual[:, kept]]), left_out(static.names, kept)


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
    choice = smallest(body, held, tolerance, up_to)
    kind = FreeFreeWithAttachment if choice.attachment else FreeFree
    return kind(choice.n, basis.points, basis.tool, basis.radius, choice.negligible).modes(body)


def change(frequencies: Array, coarse: Array) -> Array:
    """The relative change (N,) of frequencies (N,) from coarse ones (any number), NaN where there is none."""
    known = min(len(frequencies), len(coarse))
    found = np.full(len(frequencies), np.nan)
    found[:known] = np.abs(coarse[:known] / frequencies[:known] - 1.0)
    return found


def with_mesh_error(modes: ComputedModes, coarse: FreeBody) -> ComputedModes:
    """The same modes, with the change of the free–free ones' frequencies from a coarser mesh.

    Raises InputError where their model is not at hand, or the coarser mesh cannot carry them.
    """
    n = reduction_of(modes).basis.n
    of_type("coarse", coarse, FreeBody)
    return replace(modes, frequency_error=change(modes.frequencies, np.sqrt(coarse.free_modes(n)[0][:n])))


def tabulated(reduction: Reduction, notes: tuple[str, ...]) -> ComputedModes:
    """Shapes at the nodes and at the places, frequencies, integrals."""
    body, held, vectors, basis = reduction
    squares = np.sum(vectors * (body.stiffness @ vectors), axis=0)
    own = ComputedModes(
        nodes=body.nodes,
        triangles=body.triangles,
        shapes=by_node(body.displacement @ vectors),
        rotations=by_node(body.rotation @ vectors),
        frequencies=np.sqrt(squares),
        frequency_error=np.full(len(squares), np.nan),
        moments=body.moments(vectors),
        corners=(),
        source=body.source,
        notes=(*body.notes, *notes),
        report=body.report,
        materials=body.materials,
        solid=body.solid,
        reduction=reduction,
    )
    found = with_places(own, [place.nodes for place in held], [place.point for place in held])
    band = float(np.sqrt(body.free_modes(max(basis.n, 1))[0][max(basis.n, 1) - 1]))
    missed = np.full(len(found.nodes), np.nan)
    missed[: len(body.nodes)] = missed_at_nodes(body, vectors, squares)
    if basis.static:
        missed[list(found.corners)] = 0.0
    found = replace(found, band=band, missed=missed)
    if basis.tool is None:
        return found
    return replace(found, corners=found.corners[:-1], tool=found.corners[-1])
