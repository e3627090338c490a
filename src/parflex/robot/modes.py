"""Modal data of a free platform, whatever computed it, and its inertia integrals."""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.robot.moments import Moments
from parflex.robot.words import counted, modal

if TYPE_CHECKING:
    from parflex.fe.body.accuracy import BasisError
    from parflex.fe.body.basis import Reduction
    from parflex.fe.body.material import Material
    from parflex.fe.imports.check_report import CheckReport


class Solid(NamedTuple):
    """What stresses are computed of: elements (E, 10) of nodes, the part (E,) of each, a material for all
    or for each part."""

    elements: Array
    parts: Array
    materials: "tuple[Material, ...]"


@dataclass(frozen=True, eq=False)
class Modes:
    """Elastic modes of a free body, rigid modes removed, normalised to unit modal mass.

    nodes (K, 3) m; triangles (T, 3) of the surface; shapes Φ_d (N, K, 3) kg^-½ and rotations Φ_r
    (N, K, 3) rad m⁻¹ kg^-½; frequencies (N,) rad/s and their estimated relative error (N,);
    corners are the node numbers held by default, `tool` is one more where there is one; `source` says
    what computed them, `notes` what a reader of results must know; `solid` are the elements of a solid,
    `reduction` is the model that the modes were computed of, where it is at hand. Of imported modes, ids
    (K,) are the other program's node numbers and `report` is the check report.
    """

    nodes: Array
    triangles: Array
    shapes: Array
    rotations: Array | None
    frequencies: Array
    frequency_error: Array
    moments: Moments
    corners: tuple[int, ...]
    source: str
    notes: tuple[str, ...] = ()
    ids: tuple[int, ...] = ()
    report: "CheckReport | None" = None
    tool: int | None = None
    solid: Solid | None = None
    reduction: "Reduction | None" = None

    def __repr__(self) -> str:
        size = f"{counted(len(self.nodes), 'node')}, {counted(len(self.corners), 'corner')}"
        return f"Modes: {modal(self.frequencies)}, {size}, of {self.source}"

    @cached_property
    def error(self) -> "BasisError":
        """What the basis leaves out: static compliance at joints and tool, and frequencies of the body
        pinned at its joints, against the full model.

        Raises InputError where the model is not at hand.
        """
        from parflex.fe.body.accuracy import basis_error

        return basis_error(self._reduction())

    def converged(self, tolerance: float = 0.01, up_to: float | None = None) -> "Modes":
        """The smallest basis of free–free and attachment modes that is right to a relative tolerance.

        So much may the frequencies of the body pinned at its joints lie above those of the full model,
        as far as `up_to` rad/s, by default the first five, and its static compliance at joints and tool
        differ. Raises InputError where the model is not at hand, and NotConverged where no basis of
        reasonable size is that good.
        """
        from parflex.fe.body.accuracy import converged

        return converged(self._reduction(), tolerance, up_to)

    def _reduction(self) -> "Reduction":
        if self.reduction is None:
            raise InputError(
                "the model of these modes is not at hand: they were read from a file, or imported; compute "
                "them with a basis of pf.fe from the body itself"
            )
        return self.reduction
