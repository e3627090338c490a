"""Frequency responses, by the modes of the system."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import finite
from parflex.base.errors import InputError
from parflex.linear.matrices import Matrices

SAME = 1e-11  # of the largest response: how well modes must give what is solved for


def response(lin: Matrices, omega: ArrayLike, structural: float) -> Any:
    """The DataArray of `LinearModel.frf`."""
    import xarray as xr

    w = frequencies(omega)
    eta = finite("structural", structural, ())
    if eta < 0:
        raise InputError(f"structural is {structural}; a loss factor is not negative")
    found = responses(lin, w, float(eta))
    coords = {
        "output": list(lin.outputs),
        "input": list(lin.inputs),
        "omega": ("omega", w, {"units": "rad/s", "long_name": "circular frequency"}),
        "frequency": ("omega", w / (2 * np.pi), {"units": "Hz", "long_name": "frequency"}),
        "output_units": ("output", list(lin.output_units)),
        "input_units": ("input", list(lin.input_units)),
    }
    return xr.DataArray(found, coords, ("output", "input", "omega"), "frf")


def frequencies(omega: ArrayLike) -> Array:
    """(w,) rad/s; raises InputError where one is negative, or not finite."""
    w: Array = np.atleast_1d(finite("omega", omega))
    if w.ndim != 1 or np.any(w < 0):
        raise InputError("omega holds a negative frequency, or is no list; give frequencies (w,) rad/s")
    return w


def responses(lin: Matrices, w: Array, eta: float = 0.0) -> Array:
    """C (jω − A)⁻¹ B + D (o, r, w), with the structural part of the stiffness in A and C.

    It is the sum over the modes, unless that differs from the solution at the first, the middle or the last
    frequency, as it does where modes are nearly alike: motions that nothing holds.
    """
    A, C = with_loss(lin, eta)
    values, vectors = np.linalg.eig(A)
    try:
        left, right = C @ vectors, np.linalg.solve(vectors, lin.B.astype(complex))
    except np.linalg.LinAlgError:
        return solved(A, lin.B, C, lin.D, w)
    parts = 1.0 / (1j * w[:, None] - values)
    found: Array = np.moveaxis((left * parts[:, None, :]) @ right, 0, -1) + lin.D[..., None]
    some = sorted({0, len(w) // 2, len(w) - 1})
    wanted = solved(A, lin.B, C, lin.D, w[some])
    off = np.max(np.abs(found[..., some] - wanted), axis=(0, 1), initial=0.0)
    largest = np.max(np.abs(wanted), axis=(0, 1), initial=0.0)
    return found if np.all(off <= SAME * largest) else solved(A, lin.B, C, lin.D, w)


def solved(A: Array, B: Array, C: Array, D: Array, w: Array) -> Array:
    """C (jω − A)⁻¹ B + D (o, r, w), each frequency solved for itself."""
    one = np.eye(len(A))
    found = [C @ np.linalg.solve(1j * each * one - A, B.astype(complex)) + D for each in w]
    return np.stack(found, axis=-1)


def with_loss(lin: Matrices, eta: float) -> tuple[Array, Array]:
    """A and C whose stiffness K about the equilibrium is K (1 + i η); outputs that see accelerations see it,
    too."""
    if not eta:
        return lin.A, lin.C
    d = lin.point.T.shape[1]
    lost = 1j * eta * lin.point.K
    A, C = lin.A.astype(complex), lin.C.astype(complex)
    A[d : 2 * d, :d] += lost
    C[:, :d] += lin.by_acceleration @ lost
    return A, C
