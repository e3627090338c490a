"""A discretised free body: its matrices, and what its unknowns mean.

K u + M ü = f over n unknowns. Whoever assembled it (the plate, the solid, another FE program), the
bases of `basis.py` make modes of it.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from hashlib import sha256
from typing import Any

import numpy as np
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from parflex.base.array import Array
from parflex.base.cache import key_of
from parflex.base.errors import InputError, NotConverged
from parflex.base.progress import waiting
from parflex.fe.body.check_report import Report
from parflex.fe.body.integrals import Sparse
from parflex.fe.body.keep import Memory, kept
from parflex.fe.body.solid import Solid
from parflex.robot.material import Material
from parflex.robot.moments import Moments

SMALL = 3000  # unknowns below which computing is quicker than reading from the cache folder
RIGID = 1e-4  # ω² of a rigid motion against the first elastic one, at most
ENOUGH = 1e-9  # change at which a refinement has converged by far: each is a small part of the last
ROUNDS = 40  # of it, at most
SPARE = 3  # modes computed beyond those asked for, to see whether a degenerate pair is cut


@dataclass(frozen=True, eq=False)
class FreeBody:
    """K, M and node table of a body that nothing holds; SI units.

    `nodes` (K, 3) m; `stiffness` and `mass` sparse (n, n); `displacement` sparse (3K, n) maps
    unknowns to displacement components, node after node, `rotation` (3K, n) to the rotations there.
    `patches` says that a joint must be a patch of nodes, as on solids, where the deflection under a
    point force is infinite. `rigid` (n, 6) are the unknowns of unit translations along the axes and rotations
    about them through the centre of mass, zero columns for motions the body cannot make. `moments`
    gives the inertia integrals of columns of unknowns (n, N), consistent with `mass`. `shift` s⁻²,
    well below the lowest elastic ω² if it can, makes K + shift M definite. `triangles` (T, 3) are
    a surface; `corners` are the nodes held by default. `materials` are what it is made of, where that is
    known; `solid`, its elements and materials, is kept for stresses; `report` is the check report of
    imported matrices, `ids` (K,) the node numbers of their program.
    """

    nodes: Array
    stiffness: Sparse
    mass: Sparse
    displacement: Sparse
    rotation: Sparse
    patches: bool
    rigid: Array
    moments: Callable[[Array], Moments]
    shift: float
    triangles: Array
    corners: tuple[int, ...] = ()
    source: str = ""
    notes: tuple[str, ...] = ()
    materials: tuple[Material, ...] = ()
    solid: Solid | None = None
    report: Report | None = None
    ids: tuple[int, ...] = ()
    memory: Memory = field(default_factory=Memory, init=False, repr=False)

    @property
    def unknowns(self) -> int:
        """The number n of unknowns."""
        return int(self.stiffness.shape[0])

    @cached_property
    def can_move(self) -> Array:
        """The rigid motions, of six, that the unknowns can express, (6,) bool."""
        return np.any(self.rigid != 0.0, axis=0)

    @cached_property
    def rigid_inertia(self) -> Array:
        """Rᵀ M R over the motions that the body can make."""
        R = self.rigid[:, self.can_move]
        return np.asarray(R.T @ (self.mass @ R))

    @cached_property
    def rigid_squares(self) -> Array:
        """The ω² of the motions that the body can make, which are zero but for round-off."""
        R = self.rigid[:, self.can_move]
        return np.asarray(np.sum(R * (self.stiffness @ R), axis=0) / np.sum(R * (self.mass @ R), axis=0))

    @cached_property
    def factor(self) -> Callable[[Array], Array]:
        """The function that applies (K + shift M)⁻¹ to columns."""
        options = {"SymmetricMode": True}
        matrix = (self.stiffness + self.shift * self.mass).tocsc()
        with waiting(f"factorising {self.unknowns} unknowns"):
            lu = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
        return lu.solve

    def relieved(self, load: Array) -> Array:
        """A load (n, p) less the inertia forces of the rigid motion it causes (inertia relief)."""
        R = self.rigid[:, self.can_move]
        return load - self.mass @ (R @ np.linalg.solve(self.rigid_inertia, R.T @ load))

    def without_rigid(self, vectors: Array) -> Array:
        """Columns (n, p) made M-orthogonal to the rigid motions."""
        R = self.rigid[:, self.can_move]
        return vectors - R @ np.linalg.solve(self.rigid_inertia, R.T @ (self.mass @ vectors))

    def flexed(self, load: Array) -> Array:
        """K⁺ f: the elastic deformation (n, p) under loads and their inertia relief.

        Raises NotConverged where the refinement, by which the shift is undone, does not end.
        """
        given = np.asarray(load, dtype=float)
        return self.once(("static", given), lambda: [self._flexed(self.relieved(given))])[0]

    def once(self, parts: tuple[object, ...], compute: Callable[[], list[Array]]) -> list[Array]:
        """Arrays that the body and some parts determine, computed when they are first asked for."""
        return self.memory.recall(key_of(*parts), lambda: self.kept(parts, compute))

    def kept(self, parts: tuple[object, ...], compute: Callable[[], list[Array]]) -> list[Array]:
        """The same from the cache folder where computing takes long."""
        return kept((self.digest, *parts), compute) if self.unknowns > SMALL else compute()

    @cached_property
    def digest(self) -> tuple[Array, ...]:
        """The checksums that tell K and M from others."""
        matrices = [matrix.tocsr() for matrix in (self.stiffness, self.mass)]
        held = [getattr(matrix, name) for matrix in matrices for name in ("data", "indices", "indptr")]
        return tuple(np.frombuffer(sha256(array.tobytes()).digest(), dtype=np.uint8) for array in held)

    def _flexed(self, load: Array) -> Array:
        u = np.zeros_like(load)
        for _ in range(ROUNDS):
            more = self.without_rigid(self.factor(self.relieved(load - self.stiffness @ u)))
            u = u + more
            if np.all(np.linalg.norm(more, axis=0) <= ENOUGH * np.linalg.norm(u, axis=0)):
                return u
        raise NotConverged(
            "the static response has not converged: the body is nearly in two parts, or a mechanism"
        )

    def free_modes(self, count: int) -> tuple[Array, Array]:
        """ω² (≥ count,) and M-normalised columns of the lowest elastic modes, some to spare.

        Raises InputError where the mesh cannot carry so many, and where the body has not the rigid
        motions of a free body.
        """
        motions = int(np.sum(self.can_move))
        wanted = min(count + SPARE + motions, self.unknowns - 1)
        if count + motions > wanted:
            raise InputError(
                f"n is {count}, more modes than the {self.unknowns} unknowns of this mesh can carry; "
                f"ask for fewer, or refine the mesh"
            )
        values, vectors = self._lowest(wanted)
        if np.any(np.abs(values[:motions]) > RIGID * values[motions]) or values[motions] <= 0:
            found = ", ".join(f"{value:.3g}" for value in values[: motions + 2])
            raise InputError(
                f"the body is not free and in one piece: {motions} rigid modes were expected, then elastic "
                f"ones; found ω² = {found}. Remove "
                f"constraints, join parts that do not touch, and mend elements that are too slender"
            )
        return values[motions:], vectors[:, motions:]

    def _lowest(self, count: int) -> tuple[Array, Array]:
        """The lowest eigenpairs, rigid ones included; the largest set computed is kept."""
        values, vectors = self.memory.recall(
            "modes",
            lambda: self.kept(("modes", count), lambda: self._eigenpairs(count)),
            enough=lambda pairs: len(pairs[0]) >= count,
        )
        return values[:count], vectors[:, :count]

    def _eigenpairs(self, count: int) -> list[Array]:
        start = np.random.default_rng(0).standard_normal(self.unknowns)
        with waiting(f"computing {count} modes of {self.unknowns} unknowns"):
            values, vectors = self.lowest(count, self.factor, start, tol=1e-14)
        order = np.argsort(values)
        return [values[order], vectors[:, order]]

    def lowest(self, count: int, inverse: Callable[[Array], Array], start: Array, **options: Any) -> Any:
        """The lowest eigenpairs of K, M, of which `inverse` applies (K + shift M)⁻¹; as SciPy's `eigsh`."""
        applied = LinearOperator((len(start), len(start)), matvec=inverse, dtype=float)
        return eigsh(self.stiffness, count, self.mass, sigma=-self.shift, OPinv=applied, v0=start, **options)
