"""The check report of computed modes."""

import numpy as np

from parflex.base.check import of_type
from parflex.fe.body.basis import ComputedModes
from parflex.fe.body.check_report import ReportRows, rigid_rows
from parflex.fe.body.free_body import FreeBody
from parflex.fe.body.integrals import rigid_momentum, rigid_part
from parflex.robot.modal import modal_mass
from parflex.robot.modes import Modes
from parflex.robot.moments import shifted


def check_rows(modes: Modes) -> ReportRows:
    """Each thing that was checked, and the finding, in words; of imported modes, the rows of their report."""
    of_type("modes", modes, Modes)
    computed = modes if isinstance(modes, ComputedModes) else None
    if computed is not None and computed.reduction is None and computed.report is not None:
        return computed.report.rows()
    rigid, elastic = rigid_rows(rigid_part(modes.moments)), elastic_rows(modes)
    if computed is None or computed.reduction is None:
        return [*rigid, *elastic]
    return [*rigid, *stiffness_rows(computed.reduction.body), *elastic, *basis_rows(computed)]


def elastic_rows(modes: Modes) -> ReportRows:
    """Orthonormality and momenta of the elastic modes; momenta against rigid motions of equal energy."""
    if not len(modes.frequencies):
        return []
    about = shifted(modes.moments, modes.moments.MS0 / modes.moments.m)
    modal, momentum = modal_mass(about), rigid_momentum(about)
    S = np.max(np.abs(momentum[:3])) / np.sqrt(about.m)
    beta = np.max(np.abs(momentum[3:])) / np.sqrt(np.trace(about.P0))
    return [
        ("ΦᵀMΦ − 1", f"{np.max(np.abs(modal - np.eye(len(modal)))):.0e}"),
        ("S, β", f"{S:.0e}, {beta:.0e} of those of rigid motions"),
    ]


def stiffness_rows(body: FreeBody) -> ReportRows:
    """The stiffness against rigid motions."""
    squares, first = body.rigid_squares, body.free_modes(1)[0][0]
    return [
        ("rigid modes", f"{len(squares)}, their stiffness {np.max(np.abs(squares)) / first:.0e} of the first")
    ]


def basis_rows(modes: ComputedModes) -> ReportRows:
    """The errors of the basis, where there are joints."""
    if not modes.corners:
        return []
    error = modes.error
    worst = int(np.argmax(error.compliance))
    pinned = [
        "none of the basis" if np.isinf(kept) else f"{omega:.5g} ({100 * (kept / omega - 1):+.2g} %)"
        for omega, kept in zip(error.pinned, error.kept, strict=True)
    ]
    right = f"right to {100 * error.compliance[worst]:.2g} % (worst: {error.places[worst]})"
    return [("static compliance", right), ("pinned at its joints", f"{', '.join(pinned)} rad/s")]
