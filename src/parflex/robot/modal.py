"""Modal masses, stiffnesses and dampings of a flexible body."""

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import exactly, finite
from parflex.base.errors import InputError
from parflex.robot.moments import Moments


def modal_diagonals(moments: Moments, omega: Array, damping_ratio: ArrayLike) -> tuple[Array, Array]:
    """Diagonals of K_ee = ω² m_kk and D_ee = 2 ζ ω m_kk."""
    zeta = finite("damping_ratio", damping_ratio)
    if zeta.shape not in ((), omega.shape) or np.any(zeta < 0):
        raise InputError(
            f"damping_ratio is {damping_ratio!r}; expected one value ≥ 0 or {len(omega)} of them"
        )
    return diagonals(modal_masses(moments), omega, zeta)


def modal_mass(moments: Moments) -> Array:
    """m_ee (N, N), the traces of P2."""
    return np.trace(moments.P2, axis1=-2, axis2=-1)


def modal_masses(moments: Moments) -> Array:
    """m_kk (N,), the diagonal of m_ee."""
    return np.diagonal(modal_mass(moments))


def diagonals(m_kk: Array, omega: Array, zeta: Array) -> tuple[Array, Array]:
    """ω² m_kk and 2 ζ ω m_kk."""
    return omega * omega * m_kk, 2.0 * zeta * omega * m_kk  # Eq. 34


def natural_frequencies(name: str, value: ArrayLike, modes: int) -> Array:
    """(N,) rad/s, none negative."""
    omega = exactly(name, value, (modes,))
    if np.any(omega < 0):
        worst = int(np.argmin(omega))
        raise InputError(f"{name}[{worst}] is {omega[worst]}; frequencies in rad/s cannot be negative")
    return omega
