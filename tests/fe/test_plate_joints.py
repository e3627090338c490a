"""Joints anywhere on a thin plate: they are nodes of its mesh, and change it by no more than its error."""

import numpy as np
import pytest
import skfem
from scipy.spatial import ConvexHull

import parflex as pf
from paper_robot import PLATE, corners
from parflex.fe.plate.argyris import Argyris, argyris
from parflex.fe.plate.mesh import fan_mesh, plate_mesh
from parflex.fe.plate.polygon import convex_polygon, feet

APOTHEM = 0.5 * np.cos(np.pi / 6)  # m, of the hexagon: two edges are level
NONE = np.zeros((0, 2))

# By Ritz frequencies lie above the exact ones, by less than their estimate: two meshes differ by no more.
PLACES = {
    "inside": [(0.1, 0.05), (-0.2, 0.1), (0.03, -0.3)],
    "a pair 1 mm apart": [(0.1, 0.05), (0.101, 0.05)],
    "on edges": [(0.1, APOTHEM), (-0.2, -APOTHEM), (0.4, 0.1 * np.sqrt(3))],
    "1 mm from a corner and an edge": [(0.499, 0.0), (0.0, APOTHEM - 1e-3)],
    "0.1 mm from an edge": [(0.0, APOTHEM - 1e-4)],
    "beside the centre": [(0.002, 0.001), (0.0, 0.0)],
    "at nodes, corners and inside": [(0.0, APOTHEM), (0.5, 0.0), (0.13, 0.07)],
}


@pytest.fixture(scope="module")
def plain():
    return pf.fe.plate_modes(corners(), n_modes=9, **PLATE)


@pytest.mark.parametrize("places", PLACES.values(), ids=PLACES)
def test_frequencies_do_not_depend_on_where_nodes_are(plain, places):
    found = pf.fe.plate_modes(corners(), n_modes=9, points=places, **PLATE)
    assert np.max(np.abs(found.frequencies / plain.frequencies - 1)) <= np.max(plain.frequency_error)
    assert np.max(np.abs(found.nodes[list(found.corners), :2] - places)) <= 1e-6
    assert np.isclose(found.moments.m, plain.moments.m, rtol=1e-12)
    assert np.allclose(found.moments.P0, plain.moments.P0, rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("places", PLACES.values(), ids=PLACES)
def test_meshes_with_joints_are_meshes(places):
    """They tile the plate: positive areas that sum to its own, and every inner edge between two triangles."""
    mesh = plate_mesh(corners(), 2, np.array(places))
    x, y = mesh.p[:, mesh.t]
    areas = 0.5 * np.abs((x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]))
    assert np.isclose(np.sum(areas), 1.5 * np.sqrt(3) * 0.25, rtol=1e-12)
    assert np.min(areas) > 1e-9
    outer = mesh.p[:, mesh.facets[:, mesh.boundary_facets()]].mean(axis=1).T
    angles = np.radians(np.arange(30, 390, 60))
    reach = np.max(outer @ np.stack([np.cos(angles), np.sin(angles)]), axis=1)
    assert np.allclose(reach, APOTHEM, atol=1e-9)  # edges of one triangle alone are on the outline


def test_shapes_at_a_joint_are_those_of_a_mesh_without_it():
    """The deflection at the node is that inside the fan's own elements, of symmetric modes with simple
    frequencies: modes 3, 4 and 5."""
    place, section = np.array([[0.13, 0.07]]), {"n_modes": 5, **PLATE}
    with_node, without = (pf.fe.plate_modes(corners(), points=p, **section) for p in (place, None))
    inside = argyris(corners(), 2).probes(place.T) @ without.reduction.vectors
    at_node = with_node.shapes[:, with_node.corners[0], 2]
    assert np.allclose(np.abs(at_node[2:5]), np.abs(inside[0, 2:5]), rtol=2e-4)


def test_compliance_at_a_joint_is_that_of_a_fine_mesh():
    """Static compliance of the free plate at an inner point, against the fan refined until it is a node."""
    place = [(0.1875, 0.0)]  # a node of the fan halved three times, none of that halved twice
    nearest = [np.min(np.linalg.norm(fan_mesh(corners(), n).p.T - place, axis=1)) for n in (2, 3)]
    assert nearest[0] > 0.05
    assert nearest[1] < 1e-9
    found = []
    for body in (
        pf.fe.plate_body(corners(), points=place, **PLATE),
        pf.fe.plate_body(corners(), refine=3, **PLATE),
    ):
        point = np.pad(place, ((0, 0), (0, 1)))
        row = body.displacement.tocsr()[[3 * int(np.argmin(np.linalg.norm(body.nodes - point, axis=1))) + 2]]
        load = row.T.toarray()
        found.append((load.T @ body.flexed(load)).item())
    assert np.isclose(*found, rtol=2e-3)  # the load's own elements leave an error of their size squared


def test_small_elements_lose_no_digits():
    """In one of a hundredth of a millimetre, w = x² + y comes back from its unknowns: Vandermonde's matrix
    about the plate's centre is singular there."""
    mesh = skfem.MeshTri(np.array([[0.4, 0.40001, 0.4], [0.3, 0.3, 0.30001]]), np.array([[0], [1], [2]]))
    basis = skfem.Basis(mesh, Argyris(), intorder=10)
    (x, y), u, edges = mesh.p, np.zeros(basis.N), mesh.p[:, mesh.facets]
    for unknown, value in enumerate((x**2 + y, 2 * x, 1.0, 2.0, 0.0, 0.0)):
        u[basis.dofs.nodal_dofs[unknown]] = value
    middle, along = edges.mean(axis=1), edges[:, 1] - edges[:, 0]
    normal = np.stack([along[1], -along[0]]) / np.linalg.norm(along, axis=0)
    normal *= np.sign(np.sum(normal * (middle - mesh.p.mean(axis=1)[:, None]), axis=0))
    u[basis.dofs.facet_dofs[0]] = 2 * middle[0] * normal[0] + normal[1]
    X, Y = basis.global_coordinates()
    assert np.max(np.abs(np.asarray(basis.interpolate(u)) - (X**2 + Y))) < 1e-12


def test_nothing_new_is_the_fan_itself():
    """Where all joints are nodes already the mesh is the same to the bit."""
    held = np.array([(0.0, APOTHEM), (0.25, 0.25 * np.sqrt(3)), (0.0, 0.0)])
    assert np.array_equal(plate_mesh(corners(), 2, held).p, fan_mesh(corners(), 2).p)
    assert np.array_equal(plate_mesh(corners(), 2, NONE).t, fan_mesh(corners(), 2).t)


def test_bases_bring_their_joints_and_tool():
    """The points of a basis are nodes of the plate that its modes are computed from, without a word more."""
    basis = pf.fe.FreeFreeWithAttachment(
        3, [(0.1, 0.05, 0.0), (-0.2, 0.1, 0.0), (0.0, -0.3, 0.0)], (0.02, 0.0, 0.0)
    )
    found = pf.fe.plate_modes(corners(), n_modes=basis, **PLATE)
    assert np.allclose(found.nodes[list(found.corners)], basis.points)
    assert np.allclose(found.nodes[found.tool], basis.tool)
    body = pf.fe.plate_body(corners(), points=np.array(basis.points)[:, :2], tool=basis.tool, **PLATE)
    assert np.allclose(pf.fe.modes(body, tool=basis.tool, n=3).frequencies, found.frequencies, rtol=1e-9)


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ([(0.1, 0.0), (0.0, 0.5)], "joint 2 at (0, 0.5, 0) is off the plate, 0.06699 m from its edge"),
        ([(0.6, 0.0)], "joint 1 at (0.6, 0, 0) is off the plate, 0.1 m from its edge"),
        ([(0.1, 0.0, 0.01)], "joint 1 at (0.1, 0, 0.01) is off the plate, 0.01 m from its middle plane"),
        ([(0.1, 0.0), (0.1, 0.0)], "joint 1 and joint 2 both hold node"),
        ([0.1, 0.2, 0.3, 0.4], "points has shape (4,)"),
        ([(0.1, np.nan)], "points"),
    ],
)
def test_joints_off_the_plate_are_told_with_their_distance(points, words):
    with pytest.raises(pf.InputError) as told:
        pf.fe.plate_modes(corners(), n_modes=3, points=points, **PLATE)
    assert words in str(told.value)


def test_a_tool_off_the_plate_is_told():
    with pytest.raises(pf.InputError, match=r"tool at \(0, -1, 0\) is off the plate, 0.567 m"):
        pf.fe.plate_body(corners(), tool=(0.0, -1.0), **PLATE)


@pytest.mark.parametrize(
    ("thickness", "words"),
    [
        (15.0, 'thickness is 15 m on a plate of 1 m; did you mean "15 mm"?'),
        (15e-6, 'thickness is 1.5e-05 m on a plate of 1 m; did you mean "15 mm"?'),
        (0.6, "thickness is 0.6 m on a plate of 1 m; is its unit right?"),
    ],
)
def test_absurd_thickness_is_doubted(thickness, words):
    with pytest.warns(pf.ImplausibleValue) as told:
        pf.fe.plate_body(corners(), **PLATE | {"thickness": thickness})
    assert str(told[0].message) == words


def test_an_outline_in_millimetres_is_doubted():
    """It alone: of what is 20 mm thick nothing else is hardly meant."""
    for thickness in (15.0, 0.02):
        with pytest.warns(pf.ImplausibleValue) as told:
            pf.fe.plate_body(1e3 * corners(), thickness, material="steel")
        [words] = [str(each.message) for each in told]
        assert words.startswith("polygon is 1000 m, more than 50 m; if it is in mm, give 1 m")


@pytest.mark.parametrize("seed", range(12))
def test_any_joints_of_any_plate(seed):
    """Random convex outlines and points, on edges and close together too: the mesh tiles the plate, has every
    point, and its outline is the plate's."""
    rng = np.random.default_rng(seed)
    cloud = rng.standard_normal((rng.integers(4, 12), 2)) * (1.0, 10 ** rng.uniform(-1.5, 0))
    outline = convex_polygon(cloud[ConvexHull(cloud).vertices])
    n, size = len(outline), np.max(np.ptp(outline, axis=0))
    inside = rng.dirichlet(np.ones(n), 5) @ outline
    edge = outline[0] + rng.random((2, 1)) * (outline[1] - outline[0])
    close = inside[:1] + (outline[2] - inside[:1]) * 10 ** rng.uniform(-4, -2)
    points = np.concatenate([inside, edge, close])
    mesh = plate_mesh(outline, int(rng.integers(0, 4)), points)
    x, y = mesh.p[:, mesh.t]
    areas = 0.5 * np.abs((x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]))
    X, Y = outline.T
    assert np.isclose(np.sum(areas), 0.5 * np.sum(X * np.roll(Y, -1) - Y * np.roll(X, -1)), rtol=1e-9)
    assert np.max(np.min(np.linalg.norm(mesh.p.T[:, None] - points, axis=-1), axis=0)) < 1e-6 * size
    middles = mesh.p[:, mesh.facets[:, mesh.boundary_facets()]].mean(axis=1).T
    assert np.max(np.min(feet(outline, middles)[1], axis=1)) < 1e-9 * size
    assert np.allclose(mesh.p.T[1 : n + 1], outline)
