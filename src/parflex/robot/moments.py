"""The inertia integrals of a flexible body."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, outer, skew, transpose
from parflex.robot.words import counted


class Moments(NamedTuple):
    """Inertia integrals of the undeformed body about the origin of its coordinates; SI units.

    With Φ_k the displacement shapes: m, MS0 = ∫ r dm, P0 = ∫ r rᵀ dm, S = ∫ Φ dm,
    P1_k = ∫ Φ_k rᵀ dm, P2_kj = ∫ Φ_k Φ_jᵀ dm.
    """

    m: float
    MS0: Array  # (3,)
    P0: Array  # (3, 3)
    S: Array  # (3, N)
    P1: Array  # (N, 3, 3)
    P2: Array  # (N, N, 3, 3)

    def __repr__(self) -> str:
        return f"Moments: {self.m:.4g} kg, {counted(len(self.P1), 'mode')}"


def lumped_moments(r: Array, dm: Array, Phi: Array) -> Moments:
    """The integrals of lumped masses dm (K,) at r (K, 3) with shapes Φ (N, K, 3)."""
    weighted = Phi * dm[:, None]
    return Moments(
        m=float(np.sum(dm)),
        MS0=dm @ r,
        P0=np.einsum("k,ka,kb->ab", dm, r, r),
        S=np.sum(weighted, axis=1).T,
        P1=np.einsum("nka,kb->nab", weighted, r),
        P2=np.einsum("nka,jkb->njab", weighted, Phi, optimize=True),
    )


def shifted(old: Moments, o: Array) -> Moments:
    """The integrals about the point o: r becomes r − o."""
    cross_term = np.outer(old.MS0, o)
    return Moments(
        m=old.m,
        MS0=old.MS0 - old.m * o,
        P0=old.P0 - cross_term - cross_term.T + old.m * np.outer(o, o),
        S=old.S,
        P1=old.P1 - old.S.T[:, :, None] * o,
        P2=old.P2,
    )


def turned(old: Moments, R: Array) -> Moments:
    """The integrals in other axes, the columns of R (3, 3) in those of old."""
    return Moments(old.m, old.MS0 @ R, R.T @ old.P0 @ R, R.T @ old.S, R.T @ old.P1 @ R, R.T @ old.P2 @ R)


def combined(old: Moments, V: Array) -> Moments:
    """The integrals of the combinations Σ_k Φ_k V_kn of the shapes."""
    return old._replace(
        S=old.S @ V,
        P1=np.einsum("kn,kab->nab", V, old.P1),
        P2=np.einsum("kn,jm,kjab->nmab", V, V, old.P2, optimize=True),
    )


def with_point(old: Moments, m: float, r: Array, Phi: Array) -> Moments:
    """The integrals with a point mass m at r (3,), displaced by Φ (N, 3): they grow by m Φ Φᵀ."""
    return Moments(
        m=old.m + m,
        MS0=old.MS0 + m * r,
        P0=old.P0 + m * outer(r, r),
        S=old.S + m * Phi.T,
        P1=old.P1 + m * outer(Phi, r),
        P2=old.P2 + m * Phi[:, None, :, None] * Phi[None, :, None, :],
    )


def with_shapes(old: Moments, kept: Sequence[int]) -> Moments:
    """The integrals of some of the shapes."""
    return old._replace(S=old.S[:, kept], P1=old.P1[kept], P2=old.P2[np.ix_(kept, kept)])


def with_body(old: Moments, m: float, c: Array, second: Array, Phi: Array, turn: Array) -> Moments:
    """The integrals with a rigid body m whose centre of mass c (3,) is displaced by Φ (N, 3), and which is
    turned by Θ (N, 3): with s = r − c and its `second` moment ∫ s sᵀ dm (3, 3), Φ_k(r) = Φ_k + Θ_k × s."""
    point, turns = with_point(old, m, c, Phi), skew(turn)
    turned = turns @ second  # ∫ (Θ_k × s) sᵀ dm
    return point._replace(
        P0=point.P0 + second,
        P1=point.P1 + turned,
        P2=point.P2 + turned[:, None] @ transpose(turns)[None],
    )
