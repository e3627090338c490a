"""The vectors that span a basis: chosen, made orthonormal, freed from momentum."""

import numpy as np

from parflex.base.array import Array
from parflex.fe.body.accuracy import DEPENDENT
from parflex.fe.body.canonical import canonical
from parflex.fe.body.free_body import FreeBody
from parflex.fe.body.integrals import rigid_momentum
from parflex.fe.body.joints import Holding
from parflex.robot.modal import modal_mass
from parflex.robot.moments import shifted


def left_out(names: tuple[str, ...], kept: Array) -> tuple[str, ...]:
    """A note that names the loads (place, direction) without an attachment mode."""
    by_direction: dict[str, list[str]] = {}
    for name, keep in zip(names, kept, strict=True):
        place, _, direction = name.partition(" along ")
        if not keep:
            by_direction.setdefault(direction, []).append(place)
    words = [f"{', '.join(places)} along {direction}" for direction, places in by_direction.items()]
    return (f"no attachment modes, since too stiff: {'; '.join(words)}",) if words else ()


def independent_columns(body: FreeBody, vectors: Array, kept: Array) -> Array:
    """The ones (p,) bool of the vectors kept that add something to those before them."""
    basis = np.zeros((body.unknowns, 0))
    out = kept.copy()
    for column in np.flatnonzero(kept):
        v = vectors[:, column] / np.sqrt(vectors[:, column] @ (body.mass @ vectors[:, column]))
        for _ in range(2):
            v = v - basis @ (basis.T @ (body.mass @ v))
        left = float(v @ (body.mass @ v))
        if left < DEPENDENT:
            out[column] = False
        else:
            basis = np.column_stack([basis, v / np.sqrt(left)])
    return out


def orthonormal(body: FreeBody, vectors: Array, held: tuple[Holding, ...]) -> Array:
    """The same space, with m_ee = 1, K diagonal and ascending, S = β = 0, and canonical signs."""
    vectors = vectors / np.sqrt(np.sum(vectors * (body.mass @ vectors), axis=0))
    for _ in range(2):
        vectors = without_momentum(body, vectors)
        vectors = vectors @ np.linalg.inv(np.linalg.cholesky(modal_mass(body.moments(vectors)))).T
    squares, turn = np.linalg.eigh(vectors.T @ (body.stiffness @ vectors))
    vectors = vectors @ turn
    deflection = np.vstack([*(place.displacement @ vectors for place in held), body.displacement @ vectors])
    return canonical(vectors, np.sqrt(squares), deflection, 3 * len(held))


def without_momentum(body: FreeBody, vectors: Array) -> Array:
    """Columns less the rigid motion that carries their momentum, measured by the body's integrals."""
    at = body.can_move
    found = body.moments(vectors)
    momentum = rigid_momentum(shifted(found, found.MS0 / found.m))[at]
    return vectors - body.rigid[:, at] @ np.linalg.solve(body.rigid_inertia, momentum)
