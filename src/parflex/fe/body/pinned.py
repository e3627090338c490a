"""The full model's own answers, by which a basis is judged: static response and pinned frequencies."""

from typing import NamedTuple

import numpy as np
from scipy.linalg import pinvh
from scipy.sparse.linalg import LinearOperator, eigsh

from parflex.base.array import Array
from parflex.base.check import positive
from parflex.base.errors import InputError
from parflex.base.progress import waiting
from parflex.fe.body.free_body import FreeBody
from parflex.fe.body.joints import Place
from parflex.fe.body.response import Static, static_response

FIRST = 5  # pinned frequencies that are looked at where nothing else is said
MOVING = 1e-3  # a pinned frequency that is none, of the highest


class Truth(NamedTuple):
    """The static response, the loads (p,) bool whose directions pin the joints, and the frequencies (m,)
    rad/s with them held."""

    static: Static
    pins: Array
    pinned: Array


def truth_of(body: FreeBody, held: tuple[Place, ...], negligible: float, up_to: float | None) -> Truth:
    """The full model's answers.

    Raises InputError where there are no joints.
    """
    if all(place.is_tool for place in held):
        raise InputError("points is empty; a basis can be judged at the joints of a body only")
    static = static_response(body, held)
    at_joints = np.repeat([not place.is_tool for place in held for _ in range(1 + place.is_tool)], 3)
    pins = at_joints & static.soft(np.diagonal(static.compliance), negligible)
    C = static.loads.columns[:, pins]
    pinned = body.once(("pinned", C, up_to), lambda: [pinned_frequencies(body, C, up_to)])[0]
    return Truth(static, pins, pinned)


def pinned_frequencies(body: FreeBody, pins: Array, up_to: float | None) -> Array:
    """The frequencies rad/s of the full model with pinsᵀ u = 0, as far as up_to, or the first five."""
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
