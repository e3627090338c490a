"""Free–free modes of a thin plate: Kirchhoff theory with rotary inertia, Argyris triangles.

(D [(1 − ν) ∇∇w:∇∇v + ν Δw Δv], a w v + b ∇w·∇v), a = ρh, b = ρh³/12, D = E h³ / 12 (1 − ν²)
"""

import warnings
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import skfem
from numpy.typing import ArrayLike
from scipy.sparse.linalg import eigsh
from skfem.helpers import dd, ddot, dot, grad, trace

from parflex.array import Array
from parflex.check import integer, positive, scalar
from parflex.errors import InputError
from parflex.fe.canonical import canonical, cut_pair
from parflex.fe.polygon import centroid, convex_polygon
from parflex.modes import Modes, Moments, shifted

DEFAULT_REFINE = 2
UNRESOLVED = 0.05  # change of a frequency from the coarser mesh that is worth a warning
SPARE = 3  # modes computed beyond those asked for, to see whether a degenerate pair is cut


class Section(NamedTuple):
    """What a thickness and a material make of a plate, per area."""

    a: float  # mass, kg/m²
    b: float  # rotary inertia, kg
    D: float  # bending stiffness, N m
    poisson: float


class PlateSolution(NamedTuple):
    """Elastic modes in the finite-element basis."""

    basis: skfem.Basis
    frequencies: Array  # (N,)
    coefficients: Array  # (unknowns, N)


def plate_modes(
    polygon: ArrayLike,
    thickness: float,
    young: float,
    poisson: float,
    density: float,
    n_modes: int,
    refine: int | None = None,
) -> Modes:
    """Free–free elastic modes of a plate of convex polygonal outline.

    polygon (n, 2) m, either sense of rotation; thickness m; young N/m²; density kg/m³; n_modes ≥ 0
    (0: the rigid plate). `refine` halves the triangles, fanned from the centroid, that many times;
    by default as often as the number of modes needs, at least twice. The error of a
    frequency is estimated by its change from the mesh once coarser; frequencies come from above.

    Node 0 is the centroid, nodes 1 … n are the corners. Signs and the orientation of degenerate
    pairs are canonical: positive at the first corner that moves; of a pair, the first has the
    largest deflection at the first corner and the second vanishes there.

    Raises InputError for a polygon that is not convex or crosses itself and for values no plate
    has; warns where the number of modes cuts a degenerate pair in two, and where a frequency
    changes by more than 5 % from the coarser mesh.
    """
    corners = convex_polygon(polygon)
    section = plate_section(thickness, young, poisson, density)
    integer("n_modes", n_modes)
    if refine is None:
        refine = next(r for r in range(DEFAULT_REFINE, 9) if unknowns(len(corners), r) > 12 * n_modes)
    else:
        integer("refine", refine, 1)
    if n_modes + 6 > unknowns(len(corners), refine):
        raise InputError(
            f"n_modes is {n_modes}, more than {unknowns(len(corners), refine)} unknowns can carry; "
            f"raise refine above {refine}"
        )
    fine = solve_plate(corners, section, n_modes, refine)
    coarse = solve_plate(corners, section, n_modes, refine - 1)
    kept = PlateSolution(fine.basis, fine.frequencies[:n_modes], fine.coefficients[:, :n_modes])
    known = min(n_modes, len(coarse.frequencies))
    error = np.full(n_modes, np.nan)
    error[:known] = np.abs(coarse.frequencies[:known] / kept.frequencies[:known] - 1.0)
    notes = (*cut_pair(fine.frequencies, n_modes), *coarse_mesh(error, refine))
    for note in notes:
        warnings.warn(note, stacklevel=2)
    modes = tabulate(kept, section, len(corners), refine)
    place = np.append(centroid(corners), 0.0)
    return replace(
        modes,
        nodes=modes.nodes + place,
        moments=shifted(modes.moments, -place),
        frequency_error=error,
        notes=notes,
    )


def coarse_mesh(error: Array, refine: int) -> tuple[str, ...]:
    """A note where the mesh does not resolve a mode."""
    worst = float(np.nanmax(error, initial=0.0))
    if worst <= UNRESOLVED:
        return ()
    return (
        f"the frequency of mode {int(np.nanargmax(error)) + 1} changes by {100 * worst:.1f} % from the mesh "
        f"once coarser: raise refine above {refine}, or avoid slender plates",
    )


def plate_section(thickness: float, young: float, poisson: float, density: float) -> Section:
    """Checked properties per area."""
    h, E = positive("thickness", thickness), positive("young", young)
    rho, nu = positive("density", density), scalar("poisson", poisson)
    if not -1 < nu < 0.5:
        raise InputError(f"poisson is {nu}; it must lie between -1 and 0.5")
    return Section(rho * h, rho * h**3 / 12, E * h**3 / (12 * (1 - nu**2)), nu)


def unknowns(corners: int, refine: int) -> int:
    """Argyris unknowns of the fan: 6 per node and 1 per edge."""
    triangles = corners * 4**refine
    boundary = corners * 2**refine
    edges = (3 * triangles + boundary) // 2
    return 6 * (1 + edges - triangles) + edges


def fan_mesh(corners: Array, refine: int) -> skfem.MeshTri:
    """Triangles from the centroid (node 0) to the edges, each refined into four `refine` times."""
    n = len(corners)
    points = np.vstack([centroid(corners), corners]).T
    i = np.arange(n)
    return skfem.MeshTri(points, np.stack([0 * i, 1 + i, 1 + (i + 1) % n])).refined(refine)


def solve_plate(corners: Array, section: Section, n_modes: int, refine: int) -> PlateSolution:
    """Elastic modes and some to spare; the three rigid ones are recognised and left out.

    The mesh lies about the centroid: the element's polynomials are ill-conditioned far from their
    origin.
    """
    basis = skfem.Basis(fan_mesh(corners - centroid(corners), refine), skfem.ElementTriArgyris(), intorder=10)
    mass = inertia_form(section).assemble(basis)
    stiffness = bending_form(section).assemble(basis)
    count = min(n_modes + SPARE + 3, basis.N - 1)
    size = np.linalg.norm(np.ptp(corners, axis=0))
    shift = -section.D / (section.a * size**4)  # below zero, so that K − σM is definite
    start = np.random.default_rng(0).standard_normal(basis.N)
    values, vectors = eigsh(stiffness, count, mass, sigma=shift, v0=start, tol=1e-14)
    order = np.argsort(values)
    values, vectors = values[order], vectors[:, order]
    if np.any(np.abs(values[:3]) > 1e-4 * values[3]):
        raise InputError(
            f"polygon: no three rigid modes were found (ω² = {values[:4]}); its triangles are too "
            f"slender for this mesh"
        )
    elastic = vectors[:, 3:]
    quotient = np.sum(elastic * (stiffness @ elastic), axis=0)
    frequencies = np.sqrt(quotient / np.sum(elastic * (mass @ elastic), axis=0))
    deflection = elastic[basis.dofs.nodal_dofs[0]]
    return PlateSolution(basis, frequencies, canonical(elastic, frequencies, deflection, len(corners)))


def bending_form(section: Section) -> skfem.BilinearForm:
    """D [(1 − ν) ∇∇w:∇∇v + ν Δw Δv]."""

    @skfem.BilinearForm
    def bending(u: Any, v: Any, _: Any) -> Any:
        nu = section.poisson
        return section.D * ((1 - nu) * ddot(dd(u), dd(v)) + nu * trace(dd(u)) * trace(dd(v)))

    return bending


def inertia_form(section: Section) -> skfem.BilinearForm:
    """a w v + b ∇w·∇v."""

    @skfem.BilinearForm
    def inertia(u: Any, v: Any, _: Any) -> Any:
        return section.a * u * v + section.b * dot(grad(u), grad(v))

    return inertia


class PlateFields(NamedTuple):
    """Deflection and slope of the modes at points (2, P)."""

    w: Array  # (N, P)
    slope: Array  # (N, 2, P)

    def plus_rigid(self, motion: Array, x: Array) -> "PlateFields":
        """With a rigid motion (N, 3) in 1, x, y added."""
        ones = np.ones_like(x[:1])
        return PlateFields(
            self.w + motion @ np.concatenate([ones, x]),
            self.slope + motion[:, 1:, None] * ones,
        )

    def mixed(self, matrix: Array) -> "PlateFields":
        """Linear combinations of the modes."""
        return PlateFields(matrix @ self.w, np.einsum("ij,jap->iap", matrix, self.slope))


def quadrature(basis: skfem.Basis) -> tuple[Array, Array]:
    """Points (2, Q) and weights (Q,) that integrate products of the shapes exactly."""
    return np.asarray(basis.global_coordinates()).reshape(2, -1), basis.dx.reshape(-1)


def sampled(solution: PlateSolution, section: Section) -> tuple[PlateFields, PlateFields]:
    """The modes at the quadrature points and at the nodes.

    They are made orthogonal to the rigid motions, and orthonormal, as functions: the element's
    own basis represents 1, x and y to some 1e-11 only.
    """
    basis, coefficients = solution.basis, solution.coefficients
    modes = coefficients.shape[1]
    x, dx = quadrature(basis)
    interpolated = [basis.interpolate(column) for column in coefficients.T]
    inside = PlateFields(
        np.array([np.asarray(f) for f in interpolated]).reshape(modes, dx.size),
        np.array([f.grad for f in interpolated]).reshape(modes, 2, dx.size),
    )
    u, u_x, u_y = (coefficients[dofs].T for dofs in basis.dofs.nodal_dofs[:3])
    at_nodes = PlateFields(u, np.stack([u_x, u_y], axis=1))
    rigid = PlateFields(np.zeros((3, dx.size)), np.zeros((3, 2, dx.size))).plus_rigid(np.eye(3), x)
    motion = -np.linalg.solve(modal_mass(rigid, rigid, section, dx), modal_mass(rigid, inside, section, dx)).T
    inside, at_nodes = inside.plus_rigid(motion, x), at_nodes.plus_rigid(motion, basis.mesh.p)
    whiten = np.linalg.inv(np.linalg.cholesky(modal_mass(inside, inside, section, dx)))
    return inside.mixed(whiten), at_nodes.mixed(whiten)


def modal_mass(left: PlateFields, right: PlateFields, section: Section, dx: Array) -> Array:
    """∫ a w v + b ∇w·∇v, (N_left, N_right)."""
    rotary = np.einsum("iap,jap->ij", left.slope * dx, right.slope, optimize=True)
    return section.a * (left.w * dx) @ right.w.T + section.b * rotary


def tabulate(solution: PlateSolution, section: Section, corners: int, refine: int) -> Modes:
    """Shapes at the nodes and the moment tensors of a plate that moves as (−z ∇w, w)."""
    basis = solution.basis
    inside, at_nodes = sampled(solution, section)
    w, (w_x, w_y) = at_nodes.w, np.moveaxis(at_nodes.slope, 1, 0)
    still = np.zeros_like(w)
    return Modes(
        nodes=np.vstack([basis.mesh.p, np.zeros(basis.mesh.nvertices)]).T,
        triangles=basis.mesh.t.T.copy(),
        shapes=np.stack([still, still, w], axis=-1),
        rotations=np.stack([w_y, -w_x, still], axis=-1),
        frequencies=solution.frequencies,
        frequency_error=np.full(len(w), np.nan),
        moments=plate_moments(inside, section, *quadrature(basis)),
        corners=tuple(range(1, corners + 1)),
        source=f"Kirchhoff plate, Argyris triangles, {basis.N} unknowns (refine={refine})",
    )


def plate_moments(fields: PlateFields, section: Section, x: Array, dx: Array) -> Moments:
    """The inertia integrals, with a = ρh and b = ρh³/12."""
    a, b, (w, slope) = section.a, section.b, fields
    area, N = float(np.sum(dx)), len(w)
    r = np.concatenate([x, np.zeros_like(x[:1])])
    P0 = a * (r * dx) @ r.T
    P0[2, 2] += b * area
    S, P1, P2 = np.zeros((3, N)), np.zeros((N, 3, 3)), np.zeros((N, N, 3, 3))
    S[2] = a * w @ dx
    P1[:, 2, :] = a * (w * dx) @ r.T
    P1[:, :2, 2] = -b * slope @ dx
    P2[:, :, 2, 2] = a * (w * dx) @ w.T
    P2[:, :, :2, :2] = b * np.einsum("iap,jbp->ijab", slope * dx, slope, optimize=True)
    return Moments(a * area, a * r @ dx, P0, S, P1, P2)
