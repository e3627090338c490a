"""Free vibrations of round bodies without a mesh: Ritz in cylindrical coordinates, Bessel functions."""

from itertools import pairwise

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import eigh
from scipy.optimize import brentq
from scipy.special import iv, ivp, jv, jvp

RADIAL, ACROSS = 9, 3  # degrees of the polynomials along r and z


def frequencies(radius, bore, thickness, material, count):
    """The lowest elastic frequencies (count,) rad/s of a free disc or ring, three-dimensional elasticity.

    u = (U cos nθ, V sin nθ, W cos nθ), polynomials in r and z; in a full disc U + V, U − V and W begin with
    r^(n+1), r^(n−1) and r^n, so that the strains are regular in its middle.
    """
    found = []
    for n in range(7):
        omega = harmonic(n, radius, bore / 2, thickness, material)
        found += list(np.repeat(omega, 1 if n == 0 else 2))
    return np.sort(found)[:count]


def harmonic(n, outer, inner, h, material):
    """The elastic frequencies of one harmonic in θ."""
    (r, w_r), (z, w_z) = gauss(inner, outer, 2 * RADIAL + n + 4), gauss(-h / 2, h / 2, ACROSS + 3)
    Z = legendre.legvander(2 * z / h, ACROSS)
    dZ = (
        np.stack([legendre.legval(2 * z / h, legendre.legder(row)) for row in np.eye(ACROSS + 1)], -1) * 2 / h
    )
    weight = (w_r * r)[:, None] * w_z
    half = {"U": 0.5, "V": 0.5}
    kinds = [(abs(n - 1), {"U": 0.5, "V": -0.5}), (n + 1, half)] if n else [(1, {"U": 1.0})]
    columns = [field(r, Z, dZ, radial(r, inner, outer, m), parts) for m, parts in (*kinds, (n, {"W": 1.0}))]
    u = {name: np.concatenate([c[name] for c in columns]) for name in columns[0]}
    about = 1 / r[:, None]
    strains = [u["U_r"], (u["U"] + n * u["V"]) * about, u["W_z"], u["U_z"] + u["W_r"]]
    strains += [u["V_r"] - (u["V"] + n * u["U"]) * about, u["V_z"] - n * u["W"] * about]
    lam, mu = material.lame
    dot = lambda a, b: np.einsum("irz,jrz,rz->ij", a, b, weight, optimize=True)  # noqa: E731
    volume = sum(strains[:3])
    K = lam * dot(volume, volume) + sum((2 if i < 3 else 1) * mu * dot(e, e) for i, e in enumerate(strains))
    M = material.density * sum(dot(u[name], u[name]) for name in "UVW")
    scale = 1 / np.sqrt(np.diag(M))
    size, turn = np.linalg.eigh(M * scale * scale[:, None])
    kept = scale[:, None] * turn[:, size > 1e-12] / np.sqrt(size[size > 1e-12])
    squares = eigh(kept.T @ K @ kept, eigvals_only=True)
    return np.sqrt(squares[{0: 1, 1: 2}.get(n, 0) :][:8])


def gauss(low, high, count):
    """Points and weights between two bounds."""
    x, w = legendre.leggauss(count)
    return low + (high - low) * (x + 1) / 2, w * (high - low) / 2


def radial(r, inner, outer, power):
    """Functions (n, R) of r and their slopes: polynomials of a ring, r^power times even ones of a disc."""
    if inner:
        s, slope = 2 * (r - inner) / (outer - inner) - 1, 2 / (outer - inner)
        rows = np.eye(RADIAL + 3)
        return (
            np.array([legendre.legval(s, row) for row in rows]),
            slope * np.array([legendre.legval(s, legendre.legder(row)) for row in rows]),
        )
    s, rows = 2 * (r / outer) ** 2 - 1, np.eye(RADIAL)
    even = np.array([legendre.legval(s, row) for row in rows])
    change = np.array([legendre.legval(s, legendre.legder(row)) for row in rows]) * 4 * r / outer**2
    x = (r / outer) ** power
    return x * even, x * change + power * x / r * even


def field(r, Z, dZ, functions, parts):
    """U, V, W and their derivatives (n, R, Z) of functions of r and z that some components have."""
    f, df = functions
    value, along_r, along_z = (
        np.einsum("ir,zk->ikrz", a, b).reshape(-1, len(r), len(Z)) for a, b in ((f, Z), (df, Z), (f, dZ))
    )
    return {
        name + mark: parts.get(name, 0.0) * array
        for name in "UVW"
        for mark, array in (("", value), ("_r", along_r), ("_z", along_z))
    }


def plate_roots(n, poisson, below=10.0):
    """λ² = ω R² √(ρh/D) of a free thin circular plate with n nodal diameters (Leissa 1969, Eq. 2.16)."""
    nu = poisson

    def determinant(x):
        J, dJ, I, dI = jv(n, x), jvp(n, x), iv(n, x), ivp(n, x)  # noqa: E741
        moment = (x**2 * J + (1 - nu) * (x * dJ - n**2 * J), x**2 * I - (1 - nu) * (x * dI - n**2 * I))
        shear = (x**3 * dJ + (1 - nu) * n**2 * (x * dJ - J), x**3 * dI - (1 - nu) * n**2 * (x * dI - I))
        return (moment[0] * shear[1] - moment[1] * shear[0]) * np.exp(-x)

    grid = np.linspace(0.5, below, 400)
    return [brentq(determinant, a, b) ** 2 for a, b in pairwise(grid) if determinant(a) * determinant(b) < 0]
