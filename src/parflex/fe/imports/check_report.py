"""What an import found: the numbers by which a reader judges whether to trust a platform."""

from dataclasses import dataclass

import numpy as np

from parflex.base.array import Array
from parflex.fe.imports.imported import RigidBody


@dataclass(frozen=True, eq=False)
class CheckReport:
    """The check report of imported modes; `str` is the table that is printed.

    `body` is the rigid body of the masses that were read, `own` the one that the program used, None
    where it does not say. `orthonormality` is |ΦᵀMΦ − 1| as read, `S` and `beta` the momenta of the
    elastic modes as read, as shares of those of rigid motions of the same energy; `…_after` are those
    of the platform. `residual_stiffness` is ω² of the rigid modes against the first elastic one.
    """

    source: str
    body: RigidBody
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
    notes: tuple[str, ...] = ()

    def rows(self) -> list[tuple[str, str]]:
        """What was checked, and what was found."""
        changed = np.max(np.abs(self.frequencies / self.frequencies_read - 1), initial=0.0)
        kept = "as in the file" if changed == 0 else f"up to {100 * changed:.2g} % from those in the file"
        removed = "found and removed" if self.rigid_modes else "in the file; the others have no momentum"
        return [
            ("mass", f"{self.body.mass:.6g} kg ({self.mass_kind}){self._beside_mass()}"),
            ("centre of mass", f"{vector(self.body.com)} m{self._beside_com()}"),
            ("inertia about it", f"{principal(self.body)} kg m² (principal){self._beside_inertia()}"),
            ("normalised by", self.normalised),
            ("rigid modes", f"{self.rigid_modes} {removed}"),
            ("their stiffness", f"{self.residual_stiffness:.1e} of the first elastic mode's"),
            ("ΦᵀMΦ − 1", f"{self.orthonormality:.1e} as read, {self.orthonormality_after:.0e} now"),
            ("S, β", f"{self.S:.1e}, {self.beta:.1e} as read, {self.momentum_after:.0e} now"),
            ("frequencies", f"{len(self.frequencies)} elastic, {span(self.frequencies)} rad/s, {kept}"),
            (
                "rotations",
                "of nodes, too" if self.rotations else "none: moments act on patches of nodes only",
            ),
        ]

    def _beside_mass(self) -> str:
        if self.own is None:
            return ", the program does not say its own"
        return f", {self.body.mass / self.own.mass - 1:+.1e} from the program's own"

    def _beside_com(self) -> str:
        return (
            "" if self.own is None else f", {np.linalg.norm(self.body.com - self.own.com):.1e} m from its own"
        )

    def _beside_inertia(self) -> str:
        if self.own is None:
            return ""
        apart = np.max(np.abs(self.body.inertia - self.own.inertia)) / np.max(np.abs(self.own.inertia))
        return f", within {apart:.1e} of its own"

    def __str__(self) -> str:
        return table(self.source, self.rows(), self.notes)


@dataclass(frozen=True, eq=False)
class BodyReport:
    """The check report of imported matrices; `first` bounds the first elastic frequency from above."""

    source: str
    body: RigidBody
    unknowns: int
    residual_stiffness: float
    first: float

    def rows(self) -> list[tuple[str, str]]:
        """What was checked, and what was found."""
        return [
            ("unknowns", f"{self.unknowns}"),
            ("mass", f"{self.body.mass:.6g} kg"),
            ("centre of mass", f"{vector(self.body.com)} m"),
            ("inertia about it", f"{principal(self.body)} kg m² (principal)"),
            ("rigid motions", f"free; their stiffness is {self.residual_stiffness:.1e} of the first mode's"),
            ("first elastic mode", f"below {self.first:.4g} rad/s"),
        ]

    def __str__(self) -> str:
        return table(self.source, self.rows(), ())


def table(source: str, rows: list[tuple[str, str]], notes: tuple[str, ...]) -> str:
    """Rows under the source, in columns, and the notes."""
    wide = max(len(what) for what, _ in rows)
    lines = [source, *(f"  {what:<{wide}}  {found}" for what, found in rows)]
    return "\n".join([*lines, *(f"  note: {note}" for note in notes)])


def vector(values: Array) -> str:
    """(x, y, z)."""
    return "(" + ", ".join(f"{value:.6g}" for value in values) + ")"


def principal(body: RigidBody) -> str:
    """Principal moments of inertia."""
    return vector(np.linalg.eigvalsh(body.inertia))


def span(frequencies: Array) -> str:
    """The first and the last."""
    return f"{frequencies[0]:.6g} … {frequencies[-1]:.6g}" if len(frequencies) else "none"
