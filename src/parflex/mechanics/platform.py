"""The generalised Newton–Euler model of the flexible platform (Sec. 4.4, Eqs. 34 and 35)."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from parflex.base.array import (
    Array,
    block,
    cross,
    dot,
    join,
    mtv,
    mv,
    skew,
    trace,
    transpose,
    without_roundoff,
)
from parflex.base.spatial import axial
from parflex.base.unroll import contract
from parflex.robot.body import FlexibleBody
from parflex.robot.moments import Moments


@dataclass(frozen=True, eq=False)
class Platform:
    """The tables of a flexible body as the mechanics reads them, numbers or symbols.

    `modal_solve` takes modal forces (…, N, c) to m_ee⁻¹ times them. Places and shapes are those of `body`.
    """

    body: FlexibleBody
    moments: Moments
    stiffness: Array  # (N,)
    damping: Array  # (N,)
    m_ee: Array  # (N, N)
    m_ee_inverse: Array  # (N, N)
    modal_solve: Callable[[Array], Array]

    @property
    def modes(self) -> int:
        """N, the number of modes."""
        return len(self.stiffness)


def platform_of(body: FlexibleBody) -> Platform:
    """The tables of a body, round-off stored as exact zeros.

    An integral is round-off against its Cauchy–Schwarz bound. P2 always meets a small q_e, and
    FE modes that symmetry keeps apart mix by some 1e-10: it is cleaned to 1e-9, which halves
    the cost of the model at forty modes. m_ee is not touched by it, nor is any conservation
    law, which hold for whatever tensors the body has.
    """
    m = body.moments
    size, root = np.sqrt(np.trace(m.P0)), np.sqrt(m.m)
    shape = np.sqrt(np.max(np.abs(body.m_ee), initial=0.0))
    moments = Moments(
        m=m.m,
        MS0=without_roundoff(m.MS0, root * size),
        P0=without_roundoff(m.P0, size**2),
        S=without_roundoff(m.S, root * shape),
        P1=without_roundoff(m.P1, shape * size),
        P2=without_roundoff(m.P2, shape**2, tolerance=1e-9),
    )
    inverse = without_roundoff(np.linalg.inv(body.m_ee))
    return Platform(
        body, moments, body.stiffness, body.damping, body.m_ee, inverse, partial(np.matmul, inverse)
    )


class Contractions(NamedTuple):
    """The tensors that meet the coordinates at O(N²) cost, linear in q_e and q̇_e."""

    G: Array  # (…, N, 3, 3), ∫ Φ_k ρᵀ dm
    T_axial: Array  # (…, N, 3), (T_k,23 − T_k,32, …) with T_k = ∫ (Σ Φ_j q̇_j) Φ_kᵀ dm


class PlatformTerms(NamedTuple):
    """M_p = [A_rr, A_re; A_reᵀ, m_ee] and c_p = (c_r, c_e) of Eq. 35, in Σp."""

    A_rr: Array  # (…, 6, 6)
    A_re: Array  # (…, 6, N)
    c_r: Array  # (…, 6)
    c_e: Array  # (…, N)


def contractions(platform: Platform, q_e: Array, qd_e: Array) -> Contractions:
    """G_k = P1_k + Σ_j q_j P2_kj, and the axial part of the same sum of rates."""
    by_second = np.swapaxes(platform.moments.P2, 0, 1)
    return Contractions(platform.moments.P1 + contract(q_e, by_second), contract(qd_e, axial(by_second)))


def platform_terms(
    platform: Platform, omega: Array, q_e: Array, qd_e: Array, gravity: Array
) -> PlatformTerms:
    """The generalised Newton–Euler model of the platform; ω, gravity (…, 3) in Σp."""
    t, (G, T_axial) = platform.moments, contractions(platform, q_e, qd_e)
    symmetric = np.sum(q_e[..., None, None] * (transpose(t.P1) + G), axis=-3)
    second = t.P0 + symmetric
    inertia = trace(second)[..., None, None] * np.eye(3) - second
    MS = t.MS0 + mv(t.S, q_e)  # Eq. 34
    MS_re = transpose(axial(G))  # Eq. 34
    C = np.sum(qd_e[..., None, None] * G, axis=-3)

    f_c = cross(omega, cross(omega, MS)) + 2.0 * cross(omega, mv(t.S, qd_e))
    n_c = cross(omega, mv(inertia, omega)) + 2.0 * (trace(C)[..., None] * omega - mv(C, omega))
    omega_k = omega[..., None, :]
    Q_c = dot(omega_k, mv(G, omega_k)) - dot(omega_k, omega_k) * trace(G)
    Q_c = Q_c + 2.0 * dot(omega_k, T_axial)
    Q_e = platform.stiffness * q_e + platform.damping * qd_e - mtv(t.S, gravity)

    MS_hat = skew(MS)
    A_rr = block([[t.m * np.eye(3), -MS_hat], [MS_hat, inertia]])
    A_re = block([[t.S], [MS_re]])
    c_r = join([f_c - t.m * gravity, n_c - cross(MS, gravity)])
    return PlatformTerms(A_rr, A_re, c_r, Q_c + Q_e)  # Eq. 35


def body_energies(platform: Platform, twist: Array, q_e: Array, qd_e: Array) -> tuple[Array, Array]:
    """Kinetic and strain energy (…,) J."""
    terms = platform_terms(platform, twist[..., 3:], q_e, qd_e, np.zeros(3))
    kinetic = 0.5 * dot(twist, mv(terms.A_rr, twist) + 2.0 * mv(terms.A_re, qd_e))
    kinetic = kinetic + 0.5 * dot(qd_e, mv(platform.m_ee, qd_e))
    return kinetic, 0.5 * dot(q_e, platform.stiffness * q_e)
