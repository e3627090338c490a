"""Free–free modes of a thin plate: Kirchhoff theory with rotary inertia, Argyris triangles.

(D [(1 − ν) ∇∇w:∇∇v + ν Δw Δv], a w v + b ∇w·∇v), a = ρh, b = ρh³/12, D = E h³ / 12 (1 − ν²)
"""

import warnings
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import skfem
from numpy.typing import ArrayLike
from scipy import sparse
from scipy.sparse.linalg import splu
from skfem.helpers import dd, ddot, dot, grad, trace

from parflex.base.array import Array
from parflex.base.check import integer, positive, scalar
from parflex.base.errors import InputError
from parflex.fe.body.basis import Basis, FreeFree
from parflex.fe.body.free_body import FreeBody
from parflex.fe.plate.polygon import centroid, convex_polygon
from parflex.robot.modes import Modes
from parflex.robot.moments import Moments, shifted

DEFAULT_REFINE = 2
UNRESOLVED = 0.05  # change of a frequency from the coarser mesh that is worth a warning


class Section(NamedTuple):
    """What a thickness and a material make of a plate, per area."""

    a: float  # mass, kg/m²
    b: float  # rotary inertia, kg
    D: float  # bending stiffness, N m
    poisson: float


def plate_modes(
    polygon: ArrayLike,
    thickness: float,
    young: float,
    poisson: float,
    density: float,
    n_modes: int | Basis,
    refine: int | None = None,
) -> Modes:
    """Elastic modes of a plate of convex polygonal outline, free–free or in a basis of one's choice.

    polygon (n, 2) m, either sense of rotation; thickness m; young N/m²; density kg/m³; n_modes is how
    many free–free modes are kept (0: the rigid plate), or a basis. `refine` halves the triangles,
    fanned from the centroid, that many times; by default as often as the number of modes needs, at
    least twice. The error of a frequency is estimated by its change from the mesh once coarser;
    frequencies come from above.

    Node 0 is the centroid, nodes 1 … n are the corners. Signs and the orientation of degenerate
    pairs are canonical: positive at the first corner that moves; of a pair, the first has the
    largest deflection at the first corner and the second vanishes there.

    Raises InputError for a polygon that is not convex or crosses itself and for values no plate
    has; warns where the number of modes cuts a degenerate pair in two, and where a frequency
    changes by more than 5 % from the coarser mesh.
    """
    corners = convex_polygon(polygon)
    section = plate_section(thickness, young, poisson, density)
    basis = n_modes if isinstance(n_modes, Basis) else FreeFree(integer("n_modes", n_modes))
    if refine is None:
        refine = next(r for r in range(DEFAULT_REFINE, 9) if unknowns(len(corners), r) > 12 * basis.n)
    else:
        integer("refine", refine, 1)
    if basis.n + 6 > unknowns(len(corners), refine):
        raise InputError(
            f"n_modes is {basis.n}, more than {unknowns(len(corners), refine)} unknowns can carry; "
            f"raise refine above {refine}"
        )
    modes = basis.modes(assembled(corners, section, refine))
    coarse = coarse_frequencies(assembled(corners, section, refine - 1), basis)
    error = np.full(len(modes.frequencies), np.nan)
    known = min(len(error), len(coarse))
    error[:known] = np.abs(coarse[:known] / modes.frequencies[:known] - 1.0)
    coarse_notes = coarse_mesh(error[: basis.n], refine)
    for note in (*(modes.notes if isinstance(basis, FreeFree) else ()), *coarse_notes):
        warnings.warn(note, stacklevel=2)
    return replace(modes, frequency_error=error, notes=(*modes.notes, *coarse_notes))


def plate_body(
    polygon: ArrayLike,
    thickness: float,
    young: float,
    poisson: float,
    density: float,
    refine: int = DEFAULT_REFINE,
) -> FreeBody:
    """A free plate of convex polygonal outline; as `plate_modes`, for bases of one's choice.

    Raises InputError for a polygon that is not convex or crosses itself and for values no plate has.
    """
    corners = convex_polygon(polygon)
    section = plate_section(thickness, young, poisson, density)
    return assembled(corners, section, integer("refine", refine))


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


def assembled(corners: Array, section: Section, refine: int) -> FreeBody:
    """Matrices and meaning of the Argyris unknowns."""
    place = np.append(centroid(corners), 0.0)
    basis = argyris(corners, refine)
    mass = inertia_form(section).assemble(basis)
    size = np.linalg.norm(np.ptp(corners, axis=0))

    def moments(vectors: Array) -> Moments:
        return shifted(plate_moments(sampled(basis, vectors), section, *quadrature(basis)), -place)

    return FreeBody(
        nodes=np.vstack([basis.mesh.p, np.zeros(basis.mesh.nvertices)]).T + place,
        stiffness=bending_form(section).assemble(basis),
        mass=mass,
        displacement=node_rows(basis, {2: (0, 1.0)}),
        rotation=node_rows(basis, {0: (2, 1.0), 1: (1, -1.0)}),
        patches=False,
        rigid=rigid_motions(basis, section, mass),
        moments=moments,
        shift=float(section.D / (section.a * size**4)),
        triangles=basis.mesh.t.T.copy(),
        corners=tuple(range(1, len(corners) + 1)),
        source=f"Kirchhoff plate, Argyris triangles, {basis.N} unknowns (refine={refine})",
    )


def argyris(corners: Array, refine: int) -> skfem.Basis:
    """The elements, about the centroid: their polynomials are ill-conditioned far from their origin."""
    mesh = fan_mesh(corners - centroid(corners), refine)
    return skfem.Basis(mesh, skfem.ElementTriArgyris(), intorder=10)


def coarse_frequencies(body: FreeBody, basis: Basis) -> Array:
    """Those of the coarser mesh, as far as it carries them."""
    try:
        return basis.modes(body).frequencies
    except InputError:
        count = max(body.unknowns - 8, 0)
        return np.sqrt(body.free_modes(min(basis.n, count))[0])


def node_rows(basis: skfem.Basis, components: dict[int, tuple[int, float]]) -> sparse.csr_array:
    """(3V, n): components at the vertices as signed nodal unknowns (w, w_x, w_y, …)."""
    vertices = np.arange(basis.mesh.nvertices)
    rows = np.concatenate([3 * vertices + component for component in components])
    columns = np.concatenate([basis.dofs.nodal_dofs[kind] for kind, _ in components.values()])
    signs = np.repeat([sign for _, sign in components.values()], len(vertices))
    return sparse.csr_array((signs, (rows, columns)), shape=(3 * len(vertices), basis.N))


def rigid_motions(basis: skfem.Basis, section: Section, mass: Any) -> Array:
    """(n, 6): w = 1, y, −x for translation along z and rotations about x and y, zero for the others.

    What the edges' normal slopes are follows from the vertices' unknowns by projection.
    """
    x, y = basis.mesh.p
    vertices, edges = basis.dofs.nodal_dofs, basis.dofs.facet_dofs[0]
    inner = splu(mass[edges][:, edges].tocsc())
    rigid = np.zeros((basis.N, 6))
    for column, (c, c_x, c_y) in {2: (1, 0, 0), 3: (0, 0, 1), 4: (0, -1, 0)}.items():
        for unknown, value in enumerate((c + c_x * x + c_y * y, c_x, c_y)):
            rigid[vertices[unknown], column] = value
        load = rigid_load(section, c, c_x, c_y).assemble(basis) - mass @ rigid[:, column]
        rigid[edges, column] = inner.solve(load[edges])
    return rigid


def rigid_load(section: Section, c: float, c_x: float, c_y: float) -> skfem.LinearForm:
    """a w v + b ∇w·∇v of w = c + c_x x + c_y y."""

    @skfem.LinearForm
    def load(v: Any, at: Any) -> Any:
        w = c + c_x * at.x[0] + c_y * at.x[1]
        return section.a * w * v + section.b * (c_x * grad(v)[0] + c_y * grad(v)[1])

    return load


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


def quadrature(basis: skfem.Basis) -> tuple[Array, Array]:
    """Points (2, Q) and weights (Q,) that integrate products of the shapes exactly."""
    return np.asarray(basis.global_coordinates()).reshape(2, -1), basis.dx.reshape(-1)


def sampled(basis: skfem.Basis, vectors: Array) -> PlateFields:
    """The modes at the quadrature points."""
    modes = vectors.shape[1]
    interpolated = [basis.interpolate(column) for column in vectors.T]
    return PlateFields(
        np.array([np.asarray(f) for f in interpolated]).reshape(modes, basis.dx.size),
        np.array([f.grad for f in interpolated]).reshape(modes, 2, basis.dx.size),
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
