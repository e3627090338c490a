"""A body with some of its nodes fixed: its static response, and its modes.

K_ff u = f over the unknowns that are free; what is fixed moves with the frame of the link, as one rigid
piece.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.base.progress import waiting
from parflex.fe.body.free_body import FreeBody
from parflex.fe.body.integrals import Sparse


@dataclass(frozen=True, eq=False)
class Clamped:
    """A body whose unknowns are the displacements of its nodes, held at the nodes `fixed`."""

    body: FreeBody
    fixed: Array

    @cached_property
    def free(self) -> Array:
        """The unknowns that are free."""
        return np.setdiff1d(np.arange(self.body.unknowns), (3 * self.fixed[:, None] + np.arange(3)).ravel())

    @cached_property
    def inverse(self) -> Callable[[Array], Array]:
        """The function that applies K_ff⁻¹. Raises InputError where K_ff is not positive."""
        with waiting(f"factorising {len(self.free)} unknowns"):
            return positive_inverse(
                "stiffness is not positive definite with the frame held", self._part(self.body.stiffness)
            )

    def static(self, loads: Array) -> Array:
        """K_ff⁻¹ f: displacements (n, p) under loads (n, p)."""
        found = self.body.once(
            ("held", self.fixed, loads), lambda: [self._whole(self.inverse(loads[self.free]))]
        )
        return found[0]

    def modes(self, count: int) -> Array:
        """The lowest modes (n, count). Raises InputError for more than the mesh can carry."""
        if count > len(self.free) // 4:
            raise InputError(
                f"n_modes is {count}, more than the {len(self.free)} free unknowns of this mesh can carry; "
                f"ask for fewer, or refine the mesh"
            )
        if count == 0:
            return np.zeros((self.body.unknowns, 0))
        return self.body.once(("clamped", self.fixed, count), lambda: [self._lowest(count)])[0]

    def _lowest(self, count: int) -> Array:
        K, M = (self._part(matrix) for matrix in (self.body.stiffness, self.body.mass))
        applied = LinearOperator(K.shape, matvec=self.inverse, dtype=float)
        start = np.random.default_rng(0).standard_normal(len(self.free))
        with waiting(f"computing {count} modes of {len(self.free)} unknowns"):
            values, vectors = eigsh(K, count, M, sigma=0.0, OPinv=applied, v0=start, tol=1e-14)
        return self._whole(vectors[:, np.argsort(values)])

    def _part(self, matrix: Sparse) -> Sparse:
        return matrix.tocsr()[self.free][:, self.free]

    def _whole(self, rows: Array) -> Array:
        out = np.zeros((self.body.unknowns, rows.shape[1]))
        out[self.free] = rows
        return out


def positive_inverse(complaint: str, matrix: Sparse) -> Callable[[Array], Array]:
    """The function that applies the inverse of a symmetric matrix, by L D Lᵀ without pivots, whose signs are
    those of its eigenvalues.

    Raises InputError, which begins with the complaint, where one is not positive.
    """
    try:
        lu = splu(
            matrix.tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        pivots = lu.U.diagonal()
    except RuntimeError:  # exactly singular
        pivots = np.zeros(1)
    wrong = int(np.sum(~(pivots > 0)))
    if wrong:
        raise InputError(
            f"{complaint}: {wrong} of its pivots are not positive; the matrix is damaged, or a part of the "
            f"body hangs on nothing"
        )
    return lu.solve
