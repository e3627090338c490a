"""Modes that another program computed, as they were read."""

from dataclasses import dataclass

import numpy as np

from parflex.base.array import Array
from parflex.fe.body.integrals import RigidBody, Sparse, rigid_body


@dataclass(frozen=True, eq=False)
class ImportedModes:
    """Nodes, masses and modes of a model, rigid modes and all; SI units, nothing normalised.

    ids (K,) are the program's node numbers, 0 where there is none; nodes (K, 3) m; mass (K, K) sparse,
    kg, of each direction; shapes (P, K, 3) m and rotations (P, K, 3) rad or None; squares (P,) s⁻² are
    ω²; modal_mass (P,) kg m² is ΦᵀMΦ as the program says it, None where it does not; `own` is the
    program's own account of the rigid body; `precision` is the error that the file's numbers leave in ΦᵀMΦ.
    """

    ids: Array
    nodes: Array
    mass: Sparse
    shapes: Array
    rotations: Array | None
    squares: Array
    modal_mass: Array | None
    triangles: Array
    mass_kind: str
    normalised: str
    source: str
    precision: float
    own: RigidBody | None = None
    notes: tuple[str, ...] = ()


def rigid_body_of(inertia: Array) -> RigidBody:
    """The rigid body of a (6, 6) inertia about the origin, of blocks m 1, m ĉ and the moments of inertia.

    Raises InputError where it is that of no body.
    """
    B = inertia[:3, 3:]
    MS0 = 0.5 * np.array([B[1, 2] - B[2, 1], B[2, 0] - B[0, 2], B[0, 1] - B[1, 0]])
    return rigid_body(float(np.mean(np.diagonal(inertia)[:3])), MS0, inertia[3:, 3:])


def inner(mass: Sparse, left: Array, right: Array) -> Array:
    """∫ u · v dm of fields (A, K, 3) and (B, K, 3): (A, B)."""
    a, b = (np.moveaxis(field, 1, 0) for field in (left, right))  # (K, A, 3)
    heavy = (mass @ b.reshape(len(b), -1)).reshape(b.shape)
    return np.einsum("kai,kbi->ab", a, heavy, optimize=True)


def cosines(mass: Sparse, shapes: Array) -> float:
    """The largest |cos| between two modes in the mass's scalar product, but for the worst mode, which may
    be damaged; infinite where one moves no mass."""
    gram = inner(mass, shapes, shapes)
    own = np.diagonal(gram)
    if not np.all(own > 0):
        return np.inf
    apart = np.abs(gram / np.sqrt(np.outer(own, own)) - np.eye(len(gram)))
    rest = (np.delete(np.delete(apart, k, axis=0), k, axis=1) for k in range(len(apart)))
    return min(float(np.max(part, initial=0.0)) for part in rest)
