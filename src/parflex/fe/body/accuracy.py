"""What a basis leaves out, measured against the model it was made of.

Static compliance at the places under inertia relief, Fᵀ K⁺ F, and the frequencies of the body
pinned at its joints, in all directions that are not negligibly stiff.
"""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import eigh, null_space, pinvh
from scipy.sparse.linalg import LinearOperator, eigsh

from parflex.base.array import Array
from parflex.base.check import positive
from parflex.base.errors import InputError, NotConverged
from parflex.base.progress import waiting
from parflex.fe.body.basis import DEPENDENT, Basis, FreeFree, FreeFreeWithAttachment, Reduction
from parflex.fe.body.free_body import FreeBody
from parflex.fe.body.joints import Place
from parflex.fe.body.response import Static, static_response
from parflex.robot.modes import Modes

Places = tuple[Any, Any, float | None, float]  # points, tool, radius, negligible: of a basis

FIRST = 5  # pinned frequencies that are looked at where nothing else is said
COUNTS = (12, 24, 48, 96)  # free–free modes that are tried
PARTS = (1.0, 0.1, 0.01)  # of the tolerance, below which a direction is left out
MOVING = 1e-3  # a pinned frequency that is none, of the highest


class BasisError(NamedTuple):
    """Errors of a basis against the full model.

    `compliance` (p,) of each of `places`, relative, in norm; `pinned` (m,) rad/s the frequencies of the
    full model pinned at its joints, `kept` (m,) those of the basis, infinite where it has none.
    """

    places: tuple[str, ...]
    compliance: Array
    pinned: Array
    kept: Array

    @property
    def pinned_error(self) -> Array:
        """kept / pinned − 1, (m,)."""
        return np.asarray(self.kept / self.pinned - 1.0)

    def within(self, tolerance: float) -> bool:
        """Whether all errors are at most the tolerance."""
        both = np.concatenate([self.compliance, self.pinned_error])
        return bool(np.all(np.abs(both) <= tolerance))


class Truth(NamedTuple):
    """What the full model answers: its static response, the constraints that pin the joints (p,) bool of
    the loads, frequencies with them."""

    static: Static
    pins: Array
    pinned: Array


class Gram(NamedTuple):
    """A set of vectors as the small matrices see it: Wᵀ M W, Wᵀ K W, and the places' rows of it."""

    mass: Array
    stiffness: Array
    force: Array  # Fᵀ W, (p, N)


def basis_error(reduction: Reduction, up_to: float | None = None) -> BasisError:
    """The errors of modes; pinned frequencies up to rad/s, by default the first five."""
    truth = truth_of(reduction.body, reduction.held, reduction.basis.negligible, up_to)
    return error_of(reduction, truth, gram_of(reduction.body, reduction.vectors, truth.static))


def converged(reduction: Reduction, tolerance: float, up_to: float | None) -> Modes:
    """The smallest basis right to a tolerance: n free–free modes and attachment modes.

    Directions stiffer than the tolerance tells are negligible.
    """
    positive("tolerance", tolerance)
    body, held, _, basis = reduction
    places = (basis.points, basis.tool, basis.radius, min(tolerance, 0.5))
    truth = truth_of(body, held, places[-1], up_to)
    for count in COUNTS:
        squares, free = body.free_modes(min(count, body.unknowns // 4))
        every = gram_of(body, np.hstack([free, truth.static.flexed]), truth.static)
        best = smallest(reduction, truth, every, squares, tolerance, places)
        if best is not None:
            return best.modes(body)
    raise NotConverged(
        f"tolerance is {tolerance}, which {COUNTS[-1]} free–free modes with attachment modes do not meet; "
        f"give a larger one, or a lower up_to"
    )


def smallest(
    reduction: Reduction, truth: Truth, every: Gram, squares: Array, tolerance: float, places: Places
) -> Basis | None:
    """The smallest basis that the vectors (free–free ones, then deformations) offer, if one is good."""

    def good(columns: list[int]) -> bool:
        return error_of(reduction, truth, chosen(every, columns)).within(tolerance)

    for n in range(len(squares) + 1):
        tried: list[int] | None = None
        for part in PARTS:  # several directions that are left out, each negligible, may not be together
            negligible = part * places[-1]
            attached = attachments(every, squares, n, truth, negligible)
            if attached != tried and good([*range(n), *attached]):
                fewer = range(n, min(n + len(attached), len(squares) + 1))
                alone = next((m for m in fewer if good(list(range(m)))), None)
                held = (*places[:-1], negligible)
                return FreeFreeWithAttachment(n, *held) if alone is None else FreeFree(alone, *held)
            tried = attached
    return None


def with_mesh_error(modes: Modes, coarse: FreeBody) -> Modes:
    """The same modes, with the change of the free–free ones' frequencies from a coarser mesh.

    Raises InputError where their model is not at hand, or the coarser mesh cannot carry them.
    """
    if modes.reduction is None:
        raise InputError("modes have no model at hand; compute them with a basis of pf.fe")
    n = modes.reduction.basis.n
    error = np.full(len(modes.frequencies), np.nan)
    error[:n] = np.abs(np.sqrt(coarse.free_modes(n)[0][:n]) / modes.frequencies[:n] - 1.0)
    return replace(modes, frequency_error=error)


def attachments(every: Gram, squares: Array, n: int, truth: Truth, negligible: float) -> list[int]:
    """Which columns after the free–free ones a basis with n of those would add."""
    total = np.diagonal(truth.static.compliance)
    modal = np.sum(every.force[:, :n] ** 2 / squares[:n], axis=1)
    return [len(squares) + int(k) for k in np.flatnonzero(truth.static.soft(total - modal, negligible))]


def truth_of(body: FreeBody, held: tuple[Place, ...], negligible: float, up_to: float | None) -> Truth:
    """The full model's answers; kept with the body, since they cost most.

    Raises InputError where there are no joints.
    """
    if all(place.is_tool for place in held):
        raise InputError("points is empty; a basis can be judged at the joints of a body only")
    static = static_response(body, held)
    at_joints = np.repeat([not place.is_tool for place in held for _ in range(1 + place.is_tool)], 3)
    pins = at_joints & static.soft(np.diagonal(static.compliance), negligible)
    C = static.loads.columns[:, pins]
    key = (C.tobytes(), up_to)
    known: dict[object, Array] = body.__dict__.setdefault("_pinned", {})
    if key not in known:
        known[key] = body.kept(("pinned", C, up_to), lambda: [pinned_frequencies(body, C, up_to)])[0]
    return Truth(static, pins, known[key])


def pinned_frequencies(body: FreeBody, pins: Array, up_to: float | None) -> Array:
    """Of the full model with pinsᵀ u = 0, rad/s; as far as up_to, or the first five."""
    count = FIRST
    while True:
        found = pinned_values(body, pins, count)
        moving = found[found > MOVING * found[-1]]
        if up_to is None and (len(moving) >= FIRST or count >= 4 * FIRST):
            return moving[:FIRST]
        if up_to is not None and found[-1] > positive("up_to", up_to):
            return moving[moving <= up_to]
        count = min(2 * count, body.unknowns // 2)


def pinned_values(body: FreeBody, C: Array, count: int) -> Array:
    """The lowest frequencies of K, M with Cᵀ u = 0: (K + s M)⁻¹ on that space is B − B C (Cᵀ B C)⁺ Cᵀ B."""
    BC = body.factor(C)
    across = pinvh(C.T @ BC, rtol=1e-10)

    def pinned(load: Array) -> Array:
        u = body.factor(load)
        return u - BC @ (across @ (C.T @ u))

    n = body.unknowns
    inverse = LinearOperator((n, n), matvec=pinned, dtype=float)
    start = pinned(np.random.default_rng(0).standard_normal(n))
    with waiting(f"computing {count} modes of the pinned body"):
        values = eigsh(
            body.stiffness, count, body.mass, sigma=-body.shift, OPinv=inverse, v0=start,
            return_eigenvectors=False,
        )  # fmt: skip
    return np.sqrt(np.maximum(np.sort(values), 0.0))


def gram_of(body: FreeBody, vectors: Array, static: Static) -> Gram:
    """The small matrices of vectors (n, N)."""
    M, K, F = body.mass, body.stiffness, static.loads.columns
    return Gram(vectors.T @ (M @ vectors), vectors.T @ (K @ vectors), F.T @ vectors)


def chosen(every: Gram, columns: list[int]) -> Gram:
    """Of some of the vectors."""
    at = np.ix_(columns, columns)
    return Gram(every.mass[at], every.stiffness[at], every.force[:, columns])


def error_of(reduction: Reduction, truth: Truth, gram: Gram) -> BasisError:
    """Of the space that the vectors span."""
    modal = diagonal(gram)
    full = truth.static.compliance
    reduced = (modal.force / np.diagonal(modal.stiffness)) @ modal.force.T
    names = [place.name + word for place in reduction.held for word in ("", " moment")[: 1 + place.is_tool]]
    blocks = [np.ix_(range(at, at + 3), range(at, at + 3)) for at in range(0, len(full), 3)]
    compliance = [np.linalg.norm((reduced - full)[block]) / np.linalg.norm(full[block]) for block in blocks]
    kept = pinned_reduced(reduction.body, truth, modal)[: len(truth.pinned)]
    kept = np.append(kept, np.full(len(truth.pinned) - len(kept), np.inf))
    return BasisError(tuple(names), np.array(compliance), truth.pinned, kept)


def diagonal(gram: Gram) -> Gram:
    """The same space with unit mass and diagonal stiffness, dependent vectors left out."""
    scale = 1.0 / np.sqrt(np.diagonal(gram.mass))
    weight, turn = np.linalg.eigh(gram.mass * scale * scale[:, None])
    whiten = scale[:, None] * turn[:, weight > DEPENDENT] / np.sqrt(weight[weight > DEPENDENT])
    squares, modal = np.linalg.eigh(whiten.T @ gram.stiffness @ whiten)
    return Gram(np.eye(len(squares)), np.diag(squares), gram.force @ whiten @ modal)


def pinned_reduced(body: FreeBody, truth: Truth, modal: Gram) -> Array:
    """The frequencies of rigid and elastic coordinates with the joints pinned, rad/s."""
    R = body.rigid[:, body.can_move]
    rows = np.hstack([truth.static.loads.columns.T @ R, modal.force])[truth.pins]
    allowed = null_space(rows, rcond=1e-10)
    r = R.shape[1]
    mass, stiffness = np.eye(r + len(modal.mass)), np.zeros((r + len(modal.mass),) * 2)
    mass[:r, :r], stiffness[r:, r:] = body.rigid_inertia, modal.stiffness
    values = eigh(allowed.T @ stiffness @ allowed, allowed.T @ mass @ allowed, eigvals_only=True)
    found = np.sqrt(np.maximum(values, 0.0))
    return found[found > MOVING * np.max(found, initial=0.0)] if len(found) else found
