"""Modal data of a free platform, whatever computed it, and its inertia integrals."""

from dataclasses import dataclass

from parflex.base.array import Array
from parflex.robot.moments import Moments
from parflex.robot.words import counted, modal


@dataclass(frozen=True, eq=False)
class Modes:
    """Elastic modes of a free body, rigid modes removed, normalised to unit modal mass.

    nodes (K, 3) m; triangles (T, 3) of the surface; shapes Φ_d (N, K, 3) kg^-½ and rotations Φ_r
    (N, K, 3) rad m⁻¹ kg^-½; frequencies (N,) rad/s and their estimated relative error (N,);
    corners are the node numbers held by default, `tool` is one more where there is one; `source` names
    the program that computed them, `notes` are what a reader of results must know; ids (K,) are the node
    numbers of another program. Where it is known, `band` rad/s is the highest free–free mode, and missed (K,)
    the share of the static compliance at each node that the modes lack, NaN of nodes where it is not known.
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
    tool: int | None = None
    band: float | None = None
    missed: Array | None = None

    def __repr__(self) -> str:
        size = f"{counted(len(self.nodes), 'node')}, {counted(len(self.corners), 'corner')}"
        return f"Modes: {modal(self.frequencies)}, {size}, of {self.source}"
