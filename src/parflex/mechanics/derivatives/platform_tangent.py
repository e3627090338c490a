"""Derivatives of the equations of the platform by the state, at fixed accelerations and forces."""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, block, cross, join, merged, mv, skew, stack, transpose
from parflex.base.spatial import axial
from parflex.base.unroll import contract
from parflex.mechanics.platform import Platform, deformed
from parflex.robot.layout import Coordinates


class PlatformTangent(NamedTuple):
    """∂(M_p a + c_p) of Eq. 35 at fixed a, rows (linear 3, angular 3, elastic N)."""

    gravity: Array  # (…, 6 + N, 3), by g in Σp
    omega: Array  # (…, 6 + N, 3)
    elastic: Array  # (…, 6 + N, N)
    elastic_rate: Array  # (…, 6 + N, N)


def platform_tangent(platform: Platform, x: Coordinates, gravity: Array, a: Array) -> PlatformTangent:
    """All terms are integrals of ρ and Φ_k with the acceleration v̇ − g + Ω ρ + 2 ω × Φ q̇_e + Φ q̈_e.

    The function is long because all of them share the integrals at its head.

    x at one state, gravity (…, 3) in Σp, a (…, 6 + N).
    """
    t, omega, q_e, qd_e = platform.moments, x.twist[..., 3:], x.elastic, x.elastic_rate
    G = deformed(t, q_e).G
    rates, accelerations = contract(qd_e, t.P2), contract(a[..., 6:], t.P2)  # ∫ (Φ q̇) Φ_jᵀ, ∫ (Φ q̈) Φ_jᵀ
    w = skew(omega)
    Omega = skew(a[..., 3:6]) + w @ w
    second = t.P0 + np.sum(q_e[..., None, None] * (transpose(t.P1) + G), axis=-3)
    MS, drift = t.MS0 + mv(t.S, q_e), mv(t.S, qd_e)
    C = np.sum(qd_e[..., None, None] * G, axis=-3)

    free = a[..., :3] - gravity
    each_S = transpose(t.S)  # (N, 3)
    carried = free[..., None, :, None] * each_S[:, None, :]
    carried = (
        carried + Omega[..., None, :, :] @ transpose(G) + 2.0 * (w[..., None, :, :] @ rates) + accelerations
    )
    by_shape = transpose(axial(carried) + axial(Omega[..., None, :, :] @ G))
    modes = platform.modes
    table = transpose(t.P2.reshape(modes * modes, 9))

    def paired(X: Array) -> Array:
        """∫ Φ_kᵀ X Φ_j dm, (…, N, N)."""
        return (merged(X)[..., None, :] @ table).reshape(X.shape[:-2] + (modes, modes))

    columns = []
    for e in np.eye(3):
        turn = skew(e) @ w + w @ skew(e)
        linear = mv(turn, MS) + 2.0 * cross(e, drift)
        angular = axial(turn @ second + 2.0 * (skew(e) @ C))
        elastic = np.sum(turn[..., None, :, :] * G, axis=(-2, -1))
        elastic = elastic + 2.0 * np.sum(skew(e) * transpose(rates), axis=(-2, -1))
        columns.append(join([linear, angular, elastic]))
    return PlatformTangent(
        gravity=block([[-t.m * np.eye(3)], [-skew(MS)], [-each_S]]),
        omega=stack(columns),
        elastic=block([[Omega @ t.S], [by_shape], [paired(Omega) + np.diag(platform.stiffness)]]),
        elastic_rate=block(
            [
                [2.0 * (w @ t.S)],
                [transpose(axial(2.0 * (w[..., None, :, :] @ G)))],
                [paired(2.0 * w) + np.diag(platform.damping)],
            ]
        ),
    )
