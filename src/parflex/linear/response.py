"""Frequency responses, by the modes of the system."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import finite
from parflex.base.errors import InputError
from parflex.linear.matrices import Matrices
from parflex.linear.resolved import check_meant

SAME = 1e-11  # of the largest response: how well modes must give what is solved for


def response(lin: Matrices, omega: ArrayLike, structural: float) -> Any:
    """The DataArray of `LinearModel.frf`."""
    w, eta = frequencies(omega), loss(structural)
    check_meant(lin, w)
    if eta and any(name.startswith("contact[") for name in lin.outputs):
        raise InputError("structural damping is not known of contact forces; observe StrutForce, or take 0")
    names = (lin.outputs, lin.inputs, lin.output_units, lin.input_units)
    return labelled(responses(lin, w, eta), w, "frf", *names)


def labelled(
    values: Array,
    w: Array,
    name: str,
    outputs: Sequence[str],
    inputs: Sequence[str],
    output_units: Sequence[str],
    input_units: Sequence[str],
) -> Any:
    """Responses (o, r, w) as a DataArray (output, input, omega)."""
    import xarray as xr

    coords = {
        "output": list(outputs),
        "input": list(inputs),
        "omega": ("omega", w, {"units": "rad/s", "long_name": "circular frequency"}),
        "frequency": ("omega", w / (2 * np.pi), {"units": "Hz", "long_name": "frequency"}),
        "output_units": ("output", list(output_units)),
        "input_units": ("input", list(input_units)),
    }
    return xr.DataArray(values, coords, ("output", "input", "omega"), name)


def loss(structural: float) -> float:
    """A loss factor; raises InputError where it is negative."""
    eta = float(finite("structural", structural, ()))
    if eta < 0:
        raise InputError(f"structural is {structural}; a loss factor is not negative")
    return eta


def frequencies(omega: ArrayLike) -> Array:
    """(w,) rad/s; raises InputError where one is negative, or not finite."""
    w: Array = np.atleast_1d(finite("omega", omega))
    if w.ndim != 1 or np.any(w < 0):
        raise InputError("omega holds a negative frequency, or is no list; give frequencies (w,) rad/s")
    return w


def responses(lin: Matrices, w: Array, eta: float = 0.0) -> Array:
    """C (jω − A)⁻¹ B + D (o, r, w), with the structural part of the stiffness in A and C.

    Raises InputError at ω = 0 where turns of the base are states: they grow for ever.
    """
    by_value, by_turn, turns = parted(lin, w, eta)
    if not lin.base_states:
        return by_value
    if np.any(w == 0):
        raise InputError(
            "omega holds 0, where an acceleration of the base leans gravity for ever; begin above it"
        )
    found: Array = by_value + np.einsum("obw,br->orw", by_turn, turns) / (1j * w) ** 2
    return found


def parted(lin: Matrices, w: Array, eta: float = 0.0) -> tuple[Array, Array, Array]:
    """The responses (o, r, w) without the states of the base, those (o, b, w) to its turns, and which inputs
    turn it, (b, r)."""
    A, C = with_loss(lin, eta)
    n, b = len(A) - lin.base_states, lin.base_states // 2
    own, seen = A[:n, :n], C[:, :n]
    by_value = transfer(own, lin.B[:n], seen, lin.D, w)
    by_turn = transfer(own, A[:n, n : n + b], seen, C[:, n : n + b], w)
    return by_value, by_turn, lin.B[n + b :]


def transfer(A: Array, B: Array, C: Array, D: Array, w: Array) -> Array:
    """C (jω − A)⁻¹ B + D (o, r, w).

    It is the sum over the modes, unless that differs from the solution at the first, the middle or the last
    frequency, as it does where modes are nearly alike: motions that nothing holds.
    """
    values, vectors = np.linalg.eig(A)
    try:
        left, right = C @ vectors, np.linalg.solve(vectors, B.astype(complex))
    except np.linalg.LinAlgError:
        return solved(A, B, C, D, w)
    parts = 1.0 / (1j * w[:, None] - values)
    found: Array = np.moveaxis((left * parts[:, None, :]) @ right, 0, -1) + D[..., None]
    some = sorted({0, len(w) // 2, len(w) - 1})
    wanted = solved(A, B, C, D, w[some])
    off = np.max(np.abs(found[..., some] - wanted), axis=(0, 1), initial=0.0)
    largest = np.max(np.abs(wanted), axis=(0, 1), initial=0.0)
    return found if np.all(off <= SAME * largest) else solved(A, B, C, D, w)


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
