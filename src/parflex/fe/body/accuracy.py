"""The errors of a basis, measured against the model it was made of.

They are those of the static compliance at the places under inertia relief, Fᵀ K⁺ F, and of the
frequencies of the body pinned at its joints, in all directions that are not negligibly stiff.
"""

from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh, null_space, pinvh

from parflex.base.array import Array
from parflex.base.check import positive
from parflex.base.errors import InputError
from parflex.base.progress import waiting
from parflex.fe.body.free_body import FreeBody
from parflex.fe.body.joints import Holding
from parflex.fe.body.response import Static, static_response

FIRST = 5  # pinned frequencies that are looked at where nothing else is said
MOVING = 1e-3  # a lower pinned frequency, as a part of the highest, is a rigid motion
DEPENDENT = 1e-8  # modal mass that is left of a vector beside the others


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
        """True where all errors are at most the tolerance."""
        return bool(np.all(np.abs([*self.compliance, *self.pinned_error]) <= tolerance))


class Truth(NamedTuple):
    """The static response, the loads (p,) bool whose directions pin the joints, and the frequencies (m,)
    rad/s with them held."""

    static: Static
    pins: Array
    pinned: Array


def truth_of(body: FreeBody, held: tuple[Holding, ...], negligible: float, up_to: float | None) -> Truth:
    """The full model's answers.

    Raises InputError where there are no joints, and for a frequency that is not positive.
    """
    if up_to is not None:
        positive("up_to", up_to)
    if all(place.is_tool for place in held):
        raise InputError("points is empty; a basis can be judged at the joints of a body only")
    static = static_response(body, held)
    at_joints = np.repeat([not place.is_tool for place in held for _ in range(1 + place.is_tool)], 3)
    pins = at_joints & static.soft(np.diagonal(static.compliance), negligible)
    C = static.columns[:, pins]
    return Truth(static, pins, *body.once(("pinned", C, up_to), lambda: [pinned_frequencies(body, C, up_to)]))


def pinned_frequencies(body: FreeBody, pins: Array, up_to: float | None) -> Array:
    """The frequencies rad/s of the full model with pinsᵀ u = 0, as far as up_to, or the first five."""
    count = FIRST
    while True:
        found = pinned_values(body, pins, count)
        moving = found[found > MOVING * found[-1]]
        if up_to is None and (len(moving) >= FIRST or count >= 4 * FIRST):
            return moving[:FIRST]
        if up_to is not None and found[-1] > up_to:
            return moving[moving <= up_to]
        count = min(2 * count, body.unknowns // 2)


def pinned_values(body: FreeBody, C: Array, count: int) -> Array:
    """The lowest frequencies of K, M with Cᵀ u = 0: (K + s M)⁻¹ on that space is B − B C (Cᵀ B C)⁺ Cᵀ B."""
    BC = body.factor(C)
    across = pinvh(C.T @ BC, rtol=1e-10)

    def pinned(load: Array) -> Array:
        u = body.factor(load)
        return u - BC @ (across @ (C.T @ u))

    start = pinned(np.random.default_rng(0).standard_normal(body.unknowns))
    with waiting(f"computing {count} modes of the pinned body"):
        values = body.lowest(count, pinned, start, return_eigenvectors=False)
    return np.sqrt(np.maximum(np.sort(values), 0.0))


class Gram(NamedTuple):
    """A set of vectors as the small matrices see it: Wᵀ M W, Wᵀ K W, and the places' rows of it."""

    mass: Array
    stiffness: Array
    force: Array  # Fᵀ W, (p, N)

    def only(self, columns: list[int]) -> "Gram":
        """Some of the vectors."""
        at = np.ix_(columns, columns)
        return Gram(self.mass[at], self.stiffness[at], self.force[:, columns])


def gram_of(body: FreeBody, vectors: Array, static: Static) -> Gram:
    """The small matrices of vectors (n, N)."""
    M, K, F = body.mass, body.stiffness, static.columns
    return Gram(vectors.T @ (M @ vectors), vectors.T @ (K @ vectors), F.T @ vectors)


def error_of(body: FreeBody, held: tuple[Holding, ...], truth: Truth, gram: Gram) -> BasisError:
    """The errors of the space that the vectors span."""
    modal = modal_gram(gram)
    full = truth.static.compliance
    reduced = (modal.force / np.diagonal(modal.stiffness)) @ modal.force.T
    names = [place.name + word for place in held for word in ("", " moment")[: 1 + place.is_tool]]
    blocks = [np.ix_(range(at, at + 3), range(at, at + 3)) for at in range(0, len(full), 3)]
    compliance = [np.linalg.norm((reduced - full)[block]) / np.linalg.norm(full[block]) for block in blocks]
    kept = pinned_reduced(body, truth, modal)[: len(truth.pinned)]
    kept = np.append(kept, np.full(len(truth.pinned) - len(kept), np.inf))
    return BasisError(tuple(names), np.array(compliance), truth.pinned, kept)


def modal_gram(gram: Gram) -> Gram:
    """The same space with unit mass and diagonal stiffness, dependent vectors left out."""
    scale = 1.0 / np.sqrt(np.diagonal(gram.mass))
    weight, turn = np.linalg.eigh(gram.mass * scale * scale[:, None])
    whiten = scale[:, None] * turn[:, weight > DEPENDENT] / np.sqrt(weight[weight > DEPENDENT])
    squares, modal = np.linalg.eigh(whiten.T @ gram.stiffness @ whiten)
    return Gram(np.eye(len(squares)), np.diag(squares), gram.force @ whiten @ modal)


def pinned_reduced(body: FreeBody, truth: Truth, modal: Gram) -> Array:
    """The frequencies of rigid and elastic coordinates with the joints pinned, rad/s."""
    R = body.rigid[:, body.can_move]
    rows = np.hstack([truth.static.columns.T @ R, modal.force])[truth.pins]
    allowed = null_space(rows, rcond=1e-10)
    r = R.shape[1]
    mass, stiffness = np.eye(r + len(modal.mass)), np.zeros((r + len(modal.mass),) * 2)
    mass[:r, :r], stiffness[r:, r:] = body.rigid_inertia, modal.stiffness
    values = eigh(allowed.T @ stiffness @ allowed, allowed.T @ mass @ allowed, eigvals_only=True)
    found = np.sqrt(np.maximum(values, 0.0))
    return found[found > MOVING * np.max(found, initial=0.0)] if len(found) else found
