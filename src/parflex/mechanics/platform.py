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


class Deformed(NamedTuple):
    """The inertia integrals of a deformed body, of a platform or of L links."""

    MS: Array  # (…, 3), ∫ ρ dm
    inertia: Array  # (…, 3, 3) about the frame's origin
    S: Array  # (3, N), ∫ Φ dm
    MS_re: Array  # (…, 3, N), ∫ ρ × Φ_k dm
    G: Array  # (…, N, 3, 3), ∫ Φ_k ρᵀ dm


class PlatformTerms(NamedTuple):
    """M_p = [A_rr, A_re; A_reᵀ, m_ee] and c_p = (c_r, c_e) of Eq. 35, in Σp."""

    A_rr: Array  # (…, 6, 6)
    A_re: Array  # (…, 6, N)
    c_r: Array  # (…, 6)
    c_e: Array  # (…, N)


def deformed(t: Moments, q_e: Array) -> Deformed:
    """The integrals at elastic coordinates (…, N), with G_k = P1_k + Σ_j q_j P2_kj.

    The moments may have leading axes (L,) then, as the coordinates (…, L, N) have."""
    by_second = np.swapaxes(t.P2, -4, -3)
    G = t.P1 + contract(q_e, by_second, np.ndim(t.m))
    second = t.P0 + np.sum(q_e[..., None, None] * (transpose(t.P1) + G), axis=-3)
    inertia = trace(second)[..., None, None] * np.eye(3) - second
    return Deformed(t.MS0 + mv(t.S, q_e), inertia, t.S, transpose(axial(G)), G)  # Eq. 34


def velocity_forces(t: Moments, at: Deformed, omega: Array, qd_e: Array) -> tuple[Array, Array, Array]:
    """The force, the moment about the frame's origin and the modal forces (…, N) of the rates alone."""
    rates = contract(qd_e, axial(np.swapaxes(t.P2, -4, -3)), np.ndim(t.m))  # (…, N, 3)
    C = np.sum(qd_e[..., None, None] * at.G, axis=-3)
    f_c = cross(omega, cross(omega, at.MS)) + 2.0 * cross(omega, mv(t.S, qd_e))
    n_c = cross(omega, mv(at.inertia, omega)) + 2.0 * (trace(C)[..., None] * omega - mv(C, omega))
    omega_k = omega[..., None, :]
    Q_c = dot(omega_k, mv(at.G, omega_k)) - dot(omega_k, omega_k) * trace(at.G)
    return f_c, n_c, Q_c + 2.0 * dot(omega_k, rates)


def platform_terms(
    platform: Platform, omega: Array, q_e: Array, qd_e: Array, gravity: Array
) -> PlatformTerms:
    """The generalised Newton–Euler model of the platform; ω, gravity (…, 3) in Σp."""
    t = platform.moments
    at = deformed(t, q_e)
    f_c, n_c, Q_c = velocity_forces(t, at, omega, qd_e)
    Q_e = platform.stiffness * q_e + platform.damping * qd_e - mtv(t.S, gravity)

    MS_hat = skew(at.MS)
    A_rr = block([[t.m * np.eye(3), -MS_hat], [MS_hat, at.inertia]])
    A_re = block([[t.S], [at.MS_re]])
    c_r = join([f_c - t.m * gravity, n_c - cross(at.MS, gravity)])
    return PlatformTerms(A_rr, A_re, c_r, Q_c + Q_e)  # Eq. 35


def body_energies(platform: Platform, twist: Array, q_e: Array, qd_e: Array) -> tuple[Array, Array]:
    """Kinetic and strain energy (…,) J."""
    terms = platform_terms(platform, twist[..., 3:], q_e, qd_e, np.zeros(3))
    kinetic = 0.5 * dot(twist, mv(terms.A_rr, twist) + 2.0 * mv(terms.A_re, qd_e))
    kinetic = kinetic + 0.5 * dot(qd_e, mv(platform.m_ee, qd_e))
    return kinetic, 0.5 * dot(q_e, platform.stiffness * q_e)
