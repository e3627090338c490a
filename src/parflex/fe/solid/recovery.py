"""Displacements, strains and stresses of a solid from its elastic coordinates, anywhere on the body.

u = Σ q_k Φ_k, ε = ½ (∇u + ∇uᵀ) in each element, σ = λ tr ε 1 + 2 μ ε.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from parflex.base.array import Array
from parflex.base.check import exactly, finite, of_type
from parflex.base.errors import InputError
from parflex.fe.body.basis import ComputedModes
from parflex.fe.body.elements import TET10, gradients
from parflex.fe.body.solid import Solid
from parflex.fe.solid.mesh import SolidMesh
from parflex.robot.modes import Modes

INSIDE = 1e-6  # how far outside an element, in its own coordinates, a point is taken to be in it
NEAREST = 40  # elements looked at for a point


class Fields(NamedTuple):
    """At points (…, P): displacement (…, P, 3) m, strain and stress (…, P, 3, 3), Pa, von Mises stress."""

    displacement: Array
    strain: Array
    stress: Array
    mises: Array


def recover(modes: Modes, elastic: ArrayLike, points: ArrayLike | None = None) -> Fields:
    """The fields of a solid that its elastic coordinates bend, in its own axes.

    elastic (…, N) kg^½ m, such as `result.dataset["elastic"]`; points (P, 3) m in the coordinates of the
    modes, by default the nodes of the mesh, where strains are means over the elements that meet there,
    and stresses likewise.

    Raises InputError for modes without elements (a plate's, imported ones), for a wrong number of
    coordinates, and for points off the body.
    """
    of_type("modes", modes, Modes)
    solid = solid_of(modes)
    q = finite("elastic", elastic, (len(modes.frequencies),))
    if points is None:
        shapes = [nodal_fields(modes.nodes, solid, shape) for shape in modes.shapes]
    else:
        where = elements_at(modes.nodes, solid, exactly("points", points, (None, 3)))
        shapes = [fields_at(modes.nodes, solid, shape, *where) for shape in modes.shapes]
    count = len(modes.nodes) if points is None else len(np.asarray(points))
    empty = [np.zeros((0, count, *tail)) for tail in ((3,), (3, 3), (3, 3))]
    parts = [np.stack(part) for part in zip(*shapes, strict=True)] if shapes else empty
    u, strain, stress = (np.tensordot(q, part, axes=(-1, 0)) for part in parts)
    return Fields(u, strain, stress, von_mises(stress))


def solid_of(modes: Modes) -> Solid:
    """Elements and materials. Raises InputError where there are none."""
    solid = modes.solid if isinstance(modes, ComputedModes) else None
    if solid is None:
        raise InputError(
            f"modes ({modes.source}) have no elements, so that there are no stresses; make the platform of a "
            f"solid mesh (pf.fe.solid_body)"
        )
    return solid


def von_mises(stress: Array) -> Array:
    """√(3/2 s:s) of stresses (…, 3, 3), s their deviator."""
    deviator = stress - np.trace(stress, axis1=-2, axis2=-1)[..., None, None] * np.eye(3) / 3.0
    return np.asarray(np.sqrt(1.5 * np.sum(deviator**2, axis=(-2, -1))))


def moduli(solid: Solid) -> tuple[Array, Array]:
    """λ and μ of each element, (E,)."""
    lam, mu = solid.by_element(np.array([material.lame for material in solid.materials])).T
    return lam, mu


def hooke(strain: Array, lam: Array, mu: Array) -> Array:
    """σ (…, 3, 3), moduli (…,)."""
    volume = np.trace(strain, axis1=-2, axis2=-1)
    return lam[..., None, None] * volume[..., None, None] * np.eye(3) + 2.0 * mu[..., None, None] * strain


def symmetric(gradient: Array) -> Array:
    """½ (∇u + ∇uᵀ)."""
    return 0.5 * (gradient + np.swapaxes(gradient, -1, -2))


def nodal_fields(nodes: Array, solid: Solid, u: Array) -> tuple[Array, Array, Array]:
    """Displacement, strain and stress of one displacement field (K, 3), at its nodes."""
    strain = element_strains(nodes, solid, u)
    lam, mu = moduli(solid)
    stress = hooke(strain, lam[:, None], mu[:, None])
    return u, averaged(solid.elements, strain, len(nodes)), averaged(solid.elements, stress, len(nodes))


def element_strains(nodes: Array, solid: Solid, u: Array) -> Array:
    """The strains (E, 10, 3, 3) at the ten nodes of each element."""
    G, _ = gradients(nodes[solid.elements], TET10.at(TET10.points.T)[1])
    return symmetric(np.einsum("eia,eqib->eqab", u[solid.elements], G, optimize=True))


def averaged(elements: Array, values: Array, count: int) -> Array:
    """Means over the elements that meet at a node (count, 3, 3); zero where none does."""
    flat, rows = values.reshape(-1, 9), elements.ravel()
    sums = np.stack([np.bincount(rows, column, count) for column in flat.T], axis=-1)
    near = np.maximum(np.bincount(rows, minlength=count), 1)
    return (sums / near[:, None]).reshape(count, 3, 3)


def elements_at(nodes: Array, solid: Solid, points: Array) -> tuple[Array, Array]:
    """The element (P,) and the reference coordinates (P, 3) of points.

    Raises InputError for a point in no element.
    """
    corners = nodes[solid.elements[:, :4]]
    nearest = cKDTree(np.mean(corners, axis=1)).query(points, min(NEAREST, len(corners)))[1]
    near = nearest.reshape(len(points), -1)
    edges = np.swapaxes(corners[near][:, :, 1:] - corners[near][:, :, :1], -1, -2)
    X = np.linalg.solve(edges, (points[:, None] - corners[near][:, :, 0])[..., None])[..., 0]
    rows, best = np.arange(len(points)), np.argmin(outside(X), axis=1)
    element = near[rows, best]
    X = newton(nodes[solid.elements[element]], points, X[rows, best])
    if np.any(outside(X) > INSIDE):
        worst = int(np.argmax(outside(X)))
        raise InputError(f"points[{worst}] = {points[worst]} is off the body; give points in it or on it")
    return element, X


def outside(X: Array) -> Array:
    """The distance by which reference coordinates (…, 3) lie outside their element; negative inside."""
    return np.maximum(np.max(-X, axis=-1), np.sum(X, axis=-1) - 1.0)


def newton(x: Array, points: Array, X: Array) -> Array:
    """Reference coordinates in curved elements; at once where they are straight."""
    for _ in range(6):
        N, slopes = TET10.at(X.T)
        gap = points - np.einsum("ip,pia->pa", N, x)
        J = np.einsum("pia,ibp->pab", x, slopes)
        X = X + np.linalg.solve(J, gap[..., None])[..., 0]
    return X


def fields_at(nodes: Array, solid: Solid, u: Array, element: Array, X: Array) -> tuple[Array, Array, Array]:
    """Displacement, strain and stress of one displacement field at points of elements."""
    (N, slopes), cells = TET10.at(X.T), solid.elements[element]
    inverse = np.linalg.inv(np.einsum("pia,ibp->pab", nodes[cells], slopes))
    gradient = np.einsum("pia,ibp,pbc->pac", u[cells], slopes, inverse, optimize=True)
    lam, mu = (values[element] for values in moduli(solid))
    strain = symmetric(gradient)
    return np.einsum("ip,pia->pa", N, u[cells]), strain, hooke(strain, lam, mu)


def mesh_of(modes: Modes) -> SolidMesh:
    """The mesh that the modes are of, without the nodes of patches."""
    solid = solid_of(modes)
    return SolidMesh(modes.nodes[: 1 + int(np.max(solid.elements))], solid.elements, solid.parts)
