"""Check reports: the numbers by which a reader judges whether to trust a platform."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from parflex.base.array import Array, without_roundoff
from parflex.fe.body.integrals import RigidBody

ReportRows = list[tuple[str, str]]


@dataclass(frozen=True, eq=False)
class Report(ABC):
    """A check report; `str` is its table."""

    source: str
    notes: tuple[str, ...]
    body: RigidBody

    @abstractmethod
    def rows(self) -> ReportRows:
        """Each thing that was checked, and the finding."""

    def __str__(self) -> str:
        wide = max(len(checked) for checked, _ in self.rows())
        lines = [self.source, *(f"  {checked:<{wide}}  {found}" for checked, found in self.rows())]
        return "\n".join([*lines, *(f"  note: {note}" for note in self.notes)])


@dataclass(frozen=True, eq=False)
class CheckReport(Report):
    """The check report of imported modes.

    `body` is the rigid body of the masses that were read, `own` the one that the program used, None
    where it does not say. `orthonormality` is |ΦᵀMΦ − 1| as read, `S` and `beta` the momenta of the
    elastic modes as read, as shares of those of rigid motions of the same energy; `…_after` are those
    of the platform. `residual_stiffness` is ω² of the rigid modes against the first elastic one.
    """

    own: RigidBody | None
    mass_kind: str
    normalised: str
    rigid_modes: int
    residual_stiffness: float
    orthonormality: float
    S: float
    beta: float
    orthonormality_after: float
    momentum_after: float
    frequencies_read: Array
    frequencies: Array
    rotations: bool

    def rows(self) -> ReportRows:
        changed = np.max(np.abs(self.frequencies / self.frequencies_read - 1), initial=0.0)
        kept = "as in the file" if changed == 0 else f"up to {100 * changed:.2g} % from those in the file"
        removed = "found and removed" if self.rigid_modes else "in the file; the others have no momentum"
        mass, com, inertia = self._beside_own()
        omega = self.frequencies
        between = f"{omega[0]:.6g} … {omega[-1]:.6g}" if len(omega) else "none"
        turns = "of nodes, too" if self.rotations else "none: moments act on patches of nodes only"
        return [
            *rigid_rows(self.body, (f" ({self.mass_kind}){mass}", com, inertia)),
            ("normalised by", self.normalised),
            ("rigid modes", f"{self.rigid_modes} {removed}"),
            ("their stiffness", f"{self.residual_stiffness:.1e} of the first elastic mode's"),
            ("ΦᵀMΦ − 1", f"{self.orthonormality:.1e} as read, {self.orthonormality_after:.0e} now"),
            ("S, β", f"{self.S:.1e}, {self.beta:.1e} as read, {self.momentum_after:.0e} now"),
            ("frequencies", f"{len(omega)} elastic, {between} rad/s, {kept}"),
            ("rotations", turns),
        ]

    def _beside_own(self) -> tuple[str, str, str]:
        """The differences of mass, centre of mass and inertia from the program's own, in words."""
        if self.own is None:
            return ", the program does not say its own", "", ""
        inertia = np.max(np.abs(self.body.inertia - self.own.inertia)) / np.max(np.abs(self.own.inertia))
        return (
            f", {self.body.mass / self.own.mass - 1:+.1e} from the program's own",
            f", {np.linalg.norm(self.body.com - self.own.com):.1e} m from its own",
            f", within {inertia:.1e} of its own",
        )


@dataclass(frozen=True, eq=False)
class MatrixReport(Report):
    """The check report of imported matrices; `first` bounds the first elastic frequency from above."""

    unknowns: int
    residual_stiffness: float
    first: float

    def rows(self) -> ReportRows:
        return [
            ("unknowns", f"{self.unknowns}"),
            *rigid_rows(self.body),
            ("rigid motions", f"free; their stiffness is {self.residual_stiffness:.1e} of the first mode's"),
            ("first elastic mode", f"below {self.first:.4g} rad/s"),
        ]


def rigid_rows(body: RigidBody, beside: tuple[str, str, str] = ("", "", "")) -> ReportRows:
    """Mass, centre of mass and inertia, each with what is to be said beside it."""
    com, inertia = without_roundoff(body.com, 1.0, 1e-9), without_roundoff(np.linalg.eigvalsh(body.inertia))
    return [
        ("mass", f"{body.mass:.6g} kg{beside[0]}"),
        ("centre of mass", f"{vector_text(com)} m{beside[1]}"),
        ("inertia about it", f"{vector_text(inertia)} kg m² (principal){beside[2]}"),
    ]


def vector_text(values: Array) -> str:
    """The text (x, y, z)."""
    return "(" + ", ".join(f"{value:.6g}" for value in values) + ")"
