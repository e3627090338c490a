"""The check report of computed modes: the numbers by which a reader judges whether to trust them."""

import numpy as np

from parflex.base.array import Array
from parflex.fe.body.integrals import rigid_momentum
from parflex.robot.modes import Modes
from parflex.robot.moments import shifted

Rows = list[tuple[str, str]]


def check_rows(modes: Modes) -> Rows:
    """What was checked, and what was found, in words."""
    about = shifted(modes.moments, modes.moments.MS0 / modes.moments.m)
    inertia = np.trace(about.P0) * np.eye(3) - about.P0
    return [
        ("mass", f"{about.m:.6g} kg"),
        ("centre of mass", f"{vector(modes.moments.MS0 / about.m)} m"),
        ("inertia about it", f"{vector(np.linalg.eigvalsh(inertia))} kg m² (principal)"),
        *stiffness_rows(modes),
        *elastic_rows(modes),
        *basis_rows(modes),
    ]


def elastic_rows(modes: Modes) -> Rows:
    """Orthonormality and momenta of the elastic modes; momenta against rigid motions of equal energy."""
    if not len(modes.frequencies):
        return []
    about = shifted(modes.moments, modes.moments.MS0 / modes.moments.m)
    modal = np.trace(about.P2, axis1=-2, axis2=-1)
    momentum = rigid_momentum(about)
    S = np.max(np.abs(momentum[:3])) / np.sqrt(about.m)
    beta = np.max(np.abs(momentum[3:])) / np.sqrt(np.trace(about.P0))
    return [
        ("ΦᵀMΦ − 1", f"{np.max(np.abs(modal - np.eye(len(modal)))):.0e}"),
        ("S, β", f"{S:.0e}, {beta:.0e} of those of rigid motions"),
    ]


def stiffness_rows(modes: Modes) -> Rows:
    """Against rigid motions, where the model is at hand."""
    if modes.reduction is None:
        return []
    body = modes.reduction.body
    R = body.rigid[:, body.can_move]
    squares = np.sum(R * (body.stiffness @ R), axis=0) / np.sum(R * (body.mass @ R), axis=0)
    first = body.free_modes(1)[0][0]
    return [
        ("rigid modes", f"{R.shape[1]}, their stiffness {np.max(np.abs(squares)) / first:.0e} of the first")
    ]


def basis_rows(modes: Modes) -> Rows:
    """What the basis leaves out, where the model and joints are at hand."""
    if modes.reduction is None or not modes.corners:
        return []
    error = modes.error
    worst = int(np.argmax(error.compliance))
    pinned = [
        "none of the basis" if np.isinf(kept) else f"{omega:.5g} ({100 * (kept / omega - 1):+.2g} %)"
        for omega, kept in zip(error.pinned, error.kept, strict=True)
    ]
    return [
        (
            "static compliance",
            f"right to {100 * error.compliance[worst]:.2g} % (worst: {error.places[worst]})",
        ),
        ("pinned at its joints", f"{', '.join(pinned)} rad/s"),
    ]


def vector(values: Array) -> str:
    """(x, y, z), without round-off."""
    return "(" + ", ".join(f"{round(float(value), 9) + 0.0:.6g}" for value in values) + ")"
