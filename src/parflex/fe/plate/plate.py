"""Modes of a thin plate: Kirchhoff theory with rotary inertia, Argyris triangles."""

import warnings
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse.linalg import splu

from parflex.base.array import Array
from parflex.base.check import integer
from parflex.base.errors import InputError
from parflex.fe.body.basis import Basis, ComputedModes, FreeFree, change
from parflex.fe.body.free_body import FreeBody
from parflex.fe.plate.argyris import NONE, argyris, node_rows
from parflex.fe.plate.mesh import unknowns
from parflex.fe.plate.points import in_space, on_plate, places_of
from parflex.fe.plate.polygon import centroid, convex_polygon
from parflex.fe.plate.proportions import check_proportions
from parflex.fe.plate.section import (
    Section,
    bending_form,
    inertia_form,
    plate_moments,
    plate_quadrature,
    plate_section,
    rigid_load,
    sampled,
)
from parflex.robot.attachments import attachment_nodes
from parflex.robot.material import Material
from parflex.robot.materials import chosen
from parflex.robot.moments import Moments, shifted

DEFAULT_REFINE = 2
MOST = 30_000  # unknowns
UNRESOLVED = 0.05  # change of a frequency from the coarser mesh that is worth a warning


def plate_modes(
    polygon: ArrayLike,
    thickness: float,
    young: float | None = None,
    poisson: float | None = None,
    density: float | None = None,
    n_modes: int | Basis | None = None,
    refine: int | None = None,
    *,
    material: Material | str | None = None,
    points: ArrayLike | None = None,
) -> ComputedModes:
    """Elastic modes of a plate of convex polygonal outline, free–free or in a basis of one's choice.

    polygon (n, 2) m, either sense of rotation; thickness m; young N/m², poisson and density kg/m³, or a
    material, such as "aluminium"; n_modes is how many free–free modes are kept (0: the rigid plate), or a
    basis. points (k, 2) or (k, 3) m are where legs hold the plate, anywhere on it, by default its corners;
    they become nodes, like the points and the tool of a basis. `refine` halves the triangles,
    fanned from the centroid, that many times; by default as often as the number of modes needs, at
    least twice. The error of a frequency is estimated by its change from the mesh once coarser;
    frequencies come from above.

    Node 0 is the centroid, nodes 1 … n are the corners. Signs and the orientation of degenerate
    pairs are canonical: positive at the first corner that moves; of a pair, the first has the
    largest deflection at the first corner and the second vanishes there.

    Raises InputError for a polygon that is not convex or crosses itself, for points off the plate, for a
    material that is not known or not given, and for values no plate has; warns where the number of modes
    cuts a degenerate pair in two, where a frequency changes by more than 5 % from the coarser mesh, and of
    values that are hardly meant.
    """
    if n_modes is None:
        raise InputError("n_modes is not given; say how many free-free modes are kept, or give a basis")
    basis = n_modes if isinstance(n_modes, Basis) else FreeFree(integer("n_modes", n_modes))
    if points is not None:
        basis = replace(basis, points=in_space(points))
    made_of = chosen(material, young, poisson, density)
    plate = described(polygon, thickness, made_of, places_of(basis.points), places_of(basis.tool))
    refine = fine_enough(len(plate.corners), basis.n, refine)
    modes = basis.modes(free_plate(plate, refine))
    if not len(modes.frequencies):
        return modes
    coarse = coarse_frequencies(free_plate(plate, refine - 1), basis)
    error = change(modes.frequencies, coarse)
    coarse_notes = coarse_mesh(error[: basis.n], refine)
    for note in (*(modes.notes if isinstance(basis, FreeFree) else ()), *coarse_notes):
        warnings.warn(note, stacklevel=2)
    return replace(modes, frequency_error=error, notes=(*modes.notes, *coarse_notes))


def fine_enough(corners: int, n: int, refine: int | None) -> int:
    """The refinement that n modes need, or the one asked for.

    Raises InputError where the one asked for has not so many unknowns.
    """
    if refine is None:
        carrying = (r for r in range(DEFAULT_REFINE, 9) if unknowns(corners, r) > 12 * n)
        refine = next(carrying, None)
        if refine is None or unknowns(corners, refine) > MOST:
            raise InputError(
                f"n_modes is {n}; a mode takes 12 unknowns to be right, and the finest mesh has {MOST}: give "
                f"{MOST // 48} or fewer, of which robots need some tens at most"
            )
    bearable(corners, refine)
    if n + 6 > unknowns(corners, integer("refine", refine, 1)):
        raise InputError(
            f"n_modes is {n}, more than {unknowns(corners, refine)} unknowns can carry; "
            f"raise refine above {refine}"
        )
    return refine


def bearable(corners: int, refine: int) -> int:
    """The refinement; raises InputError where its matrices take hours, or more memory than there is."""
    if integer("refine", refine) > 8 or unknowns(corners, refine) > MOST:
        best = next(r for r in range(7, -1, -1) if r == 0 or unknowns(corners, r) <= MOST)
        raise InputError(
            f"refine is {refine}, which makes more than {MOST} unknowns: hours of work, for errors far below "
            f"those of thin-plate theory; give {best} or less"
        )
    return refine


def plate_body(
    polygon: ArrayLike,
    thickness: float,
    young: float | None = None,
    poisson: float | None = None,
    density: float | None = None,
    refine: int = DEFAULT_REFINE,
    *,
    material: Material | str | None = None,
    points: ArrayLike | None = None,
    tool: ArrayLike | None = None,
) -> FreeBody:
    """A free plate of convex polygonal outline; as `plate_modes`, for bases of one's choice, with a node at
    the tool (2,) or (3,) m too.

    Raises InputError as that does.
    """
    plate = described(polygon, thickness, chosen(material, young, poisson, density), points, tool)
    return free_plate(plate, bearable(len(plate.corners), refine))


class Plate(NamedTuple):
    """A plate: its outline (n, 2) m, where legs hold it (k, 2), None for its corners, its tool (0 or 1, 2),
    its material and its section."""

    corners: Array
    held: Array | None
    tool: Array
    material: Material
    section: Section


def described(
    polygon: ArrayLike,
    thickness: float,
    material: Material,
    points: ArrayLike | None,
    tool: ArrayLike | None,
) -> Plate:
    """The plate, with joints and tool on it. Raises InputError as `plate_modes` does."""
    corners, section = convex_polygon(polygon), plate_section(thickness, material)
    check_proportions("polygon", corners, thickness)
    held = None if points is None else on_plate(corners, in_space(points), "joint {}")
    acted = NONE if tool is None else on_plate(corners, in_space([tool], "tool"), "tool")
    return Plate(corners, held, acted, material, section)


def coarse_mesh(error: Array, refine: int) -> tuple[str, ...]:
    """A note where the mesh does not resolve a mode."""
    worst = float(np.nanmax(error, initial=0.0))
    if worst <= UNRESOLVED:
        return ()
    return (
        f"the frequency of mode {int(np.nanargmax(error)) + 1} changes by {100 * worst:.1f} % from the mesh "
        f"once coarser: raise refine above {refine}, or avoid slender plates",
    )


def free_plate(plate: Plate, refine: int) -> FreeBody:
    """The free plate: matrices and meaning of its Argyris unknowns."""
    corners, section = plate.corners, plate.section
    place = np.append(centroid(corners), 0.0)
    held = NONE if plate.held is None else plate.held
    basis = argyris(corners, refine, np.concatenate([held, plate.tool]))
    mass = inertia_form(section).assemble(basis)
    size = np.linalg.norm(np.ptp(corners, axis=0))

    def moments(vectors: Array) -> Moments:
        return shifted(plate_moments(sampled(basis, vectors), section, *plate_quadrature(basis)), -place)

    nodes = np.vstack([basis.mesh.p, np.zeros(basis.mesh.nvertices)]).T + place
    return FreeBody(
        nodes=nodes,
        stiffness=bending_form(section).assemble(basis),
        mass=mass,
        displacement=node_rows(basis, {2: (0, 1.0)}),
        rotation=node_rows(basis, {0: (2, 1.0), 1: (1, -1.0)}),
        patches=False,
        rigid=rigid_unknowns(basis, section, mass),
        moments=moments,
        shift=float(section.D / (section.a * size**4)),
        triangles=basis.mesh.t.T.copy(),
        corners=tuple(range(1, len(corners) + 1))
        if plate.held is None
        else attachment_nodes(nodes, in_space(held)),
        source=f"Kirchhoff plate, Argyris triangles, {basis.N} unknowns (refine={refine})",
        materials=(plate.material,),
    )


def coarse_frequencies(body: FreeBody, basis: Basis) -> Array:
    """The frequencies of the coarser mesh, as far as it carries them."""
    try:
        return basis.modes(body).frequencies
    except InputError:
        return np.sqrt(body.free_modes(min(basis.n, max(body.unknowns - 8, 0)))[0])


def rigid_unknowns(basis: Any, section: Section, mass: Any) -> Array:
    """The unknowns (n, 6) of rigid motions.

    w = 1, y, −x for translation along z and rotations about x and y; zero columns for the others. The
    edges' normal slopes follow from the vertices' unknowns by projection.
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
