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
from parflex.fe.solid.mesh import SolidMesh
from parflex.fe.solid.tetrahedron import at, gradients, vertices_and_middles
from parflex.robot.modes import Modes, Solid

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
        where = located(modes.nodes, solid, exactly("points", points, (None, 3)))
        shapes = [fields_at(modes.nodes, solid, shape, *where) for shape in modes.shapes]
    count = len(modes.nodes) if points is None else len(np.asarray(points))
    empty = [np.zeros((0, count, *tail)) for tail in ((3,), (3, 3), (3, 3))]
    parts = [np.stack(part) for part in zip(*shapes, strict=True)] if shapes else empty
    u, strain, stress = (np.tensordot(q, part, axes=(-1, 0)) for part in parts)
    return Fields(u, strain, stress, von_mises(stress))


def solid_of(modes: Modes) -> Solid:
    """Elements and materials. Raises InputError where there are none."""
    if modes.solid is None:
        raise InputError(
            f"modes ({modes.source}) have no elements, so that there are no stresses; make the platform of a "
            f"solid mesh (pf.fe.solid_body)"
        )
    return modes.solid


def von_mises(stress: Array) -> Array:
    """√(3/2 s:s) of stresses (…, 3, 3), s their deviator."""
    deviator = stress - np.trace(stress, axis1=-2, axis2=-1)[..., None, None] * np.eye(3) / 3.0
    return np.asarray(np.sqrt(1.5 * np.sum(deviator**2, axis=(-2, -1))))


def moduli(solid: Solid) -> tuple[Array, Array]:
    """λ and μ of each element, (E,)."""
    table = np.array([material.lame for material in solid.materials])
    lam, mu = table[np.minimum(solid.parts, len(table) - 1)].T
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
    stress = hooke(
        strain,
        np.broadcast_to(lam[:, None], strain.shape[:2]),
        np.broadcast_to(mu[:, None], strain.shape[:2]),
    )
    return u, averaged(solid.elements, strain, len(nodes)), averaged(solid.elements, stress, len(nodes))


def element_strains(nodes: Array, solid: Solid, u: Array) -> Array:
    """At the ten nodes of each element, (E, 10, 3, 3)."""
    G, _ = gradients(nodes[solid.elements], vertices_and_middles())
    return symmetric(np.einsum("eia,eqib->eqab", u[solid.elements], G, optimize=True))


def averaged(elements: Array, values: Array, count: int) -> Array:
    """Means over the elements that meet at a node (count, 3, 3); zero where none does."""
    flat, rows = values.reshape(-1, 9), elements.ravel()
    sums = np.stack([np.bincount(rows, column, count) for column in flat.T], axis=-1)
    near = np.maximum(np.bincount(rows, minlength=count), 1)
    return (sums / near[:, None]).reshape(count, 3, 3)


def located(nodes: Array, solid: Solid, points: Array) -> tuple[Array, Array]:
    """The element (P,) and the reference coordinates (P, 3) of points.

    Raises InputError for a point in no element.
    """
    corners = nodes[solid.elements[:, :4]]
    near = (
        cKDTree(np.mean(corners, axis=1))
        .query(points, min(NEAREST, len(corners)))[1]
        .reshape(len(points), -1)
    )
    edges = np.swapaxes(corners[near][:, :, 1:] - corners[near][:, :, :1], -1, -2)
    X = np.linalg.solve(edges, (points[:, None] - corners[near][:, :, 0])[..., None])[..., 0]
    outside = np.maximum(np.max(-X, axis=-1), np.sum(X, axis=-1) - 1.0)
    best = np.argmin(outside, axis=1)
    rows = np.arange(len(points))
    element, X, outside = near[rows, best], X[rows, best], outside[rows, best]
    X = newton(nodes[solid.elements[element]], points, X)
    outside = np.maximum(np.max(-X, axis=-1), np.sum(X, axis=-1) - 1.0)
    if np.any(outside > INSIDE):
        worst = int(np.argmax(outside))
        raise InputError(f"points[{worst}] = {points[worst]} is off the body; give points in it or on it")
    return element, X


def newton(x: Array, points: Array, X: Array) -> Array:
    """Reference coordinates in curved elements; at once where they are straight."""
    for _ in range(6):
        shape = at(X.T)
        gap = points - np.einsum("pi,pia->pa", shape.values, x)
        J = np.einsum("pia,pib->pab", x, shape.slopes)
        X = X + np.linalg.solve(J, gap[..., None])[..., 0]
    return X


def fields_at(nodes: Array, solid: Solid, u: Array, element: Array, X: Array) -> tuple[Array, Array, Array]:
    """Displacement, strain and stress of one displacement field at points of elements."""
    shape, cells = at(X.T), solid.elements[element]
    inverse = np.linalg.inv(np.einsum("pia,pib->pab", nodes[cells], shape.slopes))
    gradient = np.einsum("pia,pib,pbc->pac", u[cells], shape.slopes, inverse, optimize=True)
    lam, mu = (values[element] for values in moduli(solid))
    strain = symmetric(gradient)
    return np.einsum("pi,pia->pa", shape.values, u[cells]), strain, hooke(strain, lam, mu)


def mesh_of(modes: Modes) -> SolidMesh:
    """The mesh that the modes are of, without the nodes of patches."""
    solid = solid_of(modes)
    return SolidMesh(modes.nodes[: 1 + int(np.max(solid.elements))], solid.elements, solid.parts)
