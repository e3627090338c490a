"""Modes that another program computed, as they were read."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, outer
from parflex.base.errors import InputError
from parflex.fe.body.free_body import Sparse


class RigidBody(NamedTuple):
    """Mass kg, centre of mass (3,) m, inertia about it (3, 3) kg m²."""

    mass: float
    com: Array
    inertia: Array


@dataclass(frozen=True, eq=False)
class ImportedModes:
    """Nodes, masses and modes of a model, rigid modes and all; SI units, nothing normalised.

    ids (K,) are the program's node numbers, 0 where there is none; nodes (K, 3) m; mass (K, K) sparse,
    kg, of each direction; shapes (P, K, 3) m and rotations (P, K, 3) rad or None; squares (P,) s⁻² are
    ω²; modal_mass (P,) kg m² is what the program says ΦᵀMΦ is, None where it does not; `own` is the
    program's own account of the rigid body; `precision` what the file's numbers leave of ΦᵀMΦ.
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


def rigid_body(inertia: Array) -> RigidBody:
    """What a (6, 6) inertia about the origin says: m, com from m ĉ, inertia about com.

    Raises InputError where it is that of no body.
    """
    m = float(np.mean(np.diagonal(inertia)[:3]))
    if not (np.all(np.isfinite(inertia)) and m > 0):
        raise InputError(f"mass is {m:.4g} kg; a platform needs a positive mass")
    first = 0.5 * np.array(
        [
            inertia[1, 5] - inertia[2, 4],
            inertia[2, 3] - inertia[0, 5],
            inertia[0, 4] - inertia[1, 3],
        ]
    )
    com = first / m
    return RigidBody(m, com, inertia[3:, 3:] - m * (com @ com * np.eye(3) - outer(com, com)))


def rigid_fields(nodes: Array) -> Array:
    """Displacements (6, K, 3) of unit translations along and rotations about the axes."""
    axes = np.eye(3)
    along = np.broadcast_to(axes[:, None, :], (3, len(nodes), 3))
    return np.concatenate([along, np.cross(axes[:, None, :], nodes[None, :, :])])


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
