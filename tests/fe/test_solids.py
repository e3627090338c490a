"""Solids against closed forms, published values and brute force."""

import re

import numpy as np
import pytest
from scipy import sparse
from skfem import ElementTetP2
from skfem.quadrature import get_quadrature

import parflex as pf
from blocks import STEEL, box, two_blocks
from parflex.fe.solid.mesh import EDGES, with_middles

SOUND = np.sqrt(STEEL.lame[1] / STEEL.density)  # of shear waves, m/s


@pytest.fixture(scope="module")
def block() -> pf.fe.FreeBody:
    """Three different sides, away from the origin."""
    mesh = box((0.4, 0.3, 0.2), (4, 3, 2))
    return pf.fe.solid_body(pf.fe.solid_mesh(mesh.nodes + [0.1, -0.2, 0.3], mesh.elements), STEEL)


def test_lame_mode_of_a_cube():
    """u = (sin kx cos ky, −cos kx sin ky, 0), k = π/a, leaves all faces of a cube free: ω = √2 k c_s,
    thrice (Lamé 1852; Mindlin 1956)."""
    side = 0.3
    body = pf.fe.solid_body(box((side,) * 3, (6, 6, 6)), STEEL)
    exact = np.sqrt(2.0) * np.pi / side * SOUND
    found = np.sqrt(body.free_modes(20)[0])
    nearest = np.sort(np.abs(found / exact - 1.0))[:3]
    assert np.all(nearest <= 5e-3)
    k = np.pi / side
    x, y, _ = body.nodes.T
    shape = np.stack([np.sin(k * x) * np.cos(k * y), -np.cos(k * x) * np.sin(k * y), 0 * x], axis=1).ravel()
    quotient = np.sqrt((shape @ (body.stiffness @ shape)) / (shape @ (body.mass @ shape)))
    assert abs(quotient / exact - 1) <= 5e-3


def test_torsion_of_a_cylinder(tmp_path):
    """A circular cylinder twists freely at ω = n π c_s / L, whatever its radius (Love 1927, § 200); from a
    STEP file in millimetres, with curved elements."""
    occ = pytest.importorskip("netgen.occ")
    occ.Cylinder((0, 0, 0), occ.Z, r=80, h=500).WriteStep(str(tmp_path / "cylinder.step"))
    mesh = pf.fe.step_mesh(tmp_path / "cylinder.step", size=0.07)
    body = pf.fe.solid_body(mesh, STEEL)
    exact = np.pi * SOUND / 0.5
    squares, vectors = body.free_modes(8)
    error = np.sqrt(squares) / exact - 1
    best = int(np.argmin(np.abs(error)))
    assert abs(error[best]) <= 5e-3
    x, y, z = body.nodes.T
    u = vectors[:, best].reshape(-1, 3)
    twist = np.cos(np.pi * z / 0.5)
    expected = np.stack([-y * twist, x * twist, 0 * x], axis=1)
    assert abs(np.sum(u * expected)) >= 0.999 * np.linalg.norm(u) * np.linalg.norm(expected)


def test_directions_that_are_negligible_alone_may_not_be_so_together(tmp_path):
    """On a disc with a boss two of them, each below the tolerance, are beyond it together: one is kept."""
    occ = pytest.importorskip("netgen.occ")
    disc = occ.Cylinder((0, 0, 0), occ.Z, r=240, h=12) + occ.Cylinder((0, 0, 0), occ.Z, r=50, h=40)
    disc.WriteStep(str(tmp_path / "disc.step"))
    body = pf.fe.solid_body(pf.fe.step_mesh(tmp_path / "disc.step", size=0.04), STEEL)
    angles = np.radians([0, 120, 240])
    points = np.stack([0.2 * np.cos(angles), 0.2 * np.sin(angles), np.full(3, 0.012)], axis=-1)
    found = pf.fe.modes(body, points, tool=[0, 0, 0.04], radius=0.02)
    assert found.reduction.basis.negligible < 0.01
    assert found.error.within(0.01)
    loose = pf.fe.FreeFreeWithAttachment(found.reduction.basis.n, points, [0, 0, 0.04], 0.02, 0.01)
    assert not loose.modes(body).error.within(0.01)


def test_moment_tensors_against_brute_force(block):
    """All six integrals against a quadrature of order eight over the shapes as functions, 1e-10 of the
    largest a tensor could be."""
    modes = pf.fe.FreeFree(7).modes(block)
    X, weights = get_quadrature(ElementTetP2, 8)
    values, slopes = zip(*(ElementTetP2().lbasis(X, i) for i in range(10)), strict=True)
    cells = modes.solid.elements
    x = modes.nodes[cells]
    dm = STEEL.density * np.linalg.det(np.einsum("eia,ibq->eqab", x, np.array(slopes))) * weights
    r = np.einsum("iq,eia->eqa", np.array(values), x)
    phi = np.einsum("iq,neia->neqa", np.array(values), modes.shapes[:, cells])
    found, size = modes.moments, np.sqrt(np.trace(modes.moments.P0))
    m = np.sum(dm)
    for name, expected, scale in (
        ("m", m, m),
        ("MS0", np.einsum("eq,eqa->a", dm, r), np.sqrt(m) * size),
        ("P0", np.einsum("eq,eqa,eqb->ab", dm, r, r, optimize=True), size**2),
        ("S", np.einsum("eq,neqa->an", dm, phi, optimize=True), np.sqrt(m)),
        ("P1", np.einsum("eq,neqa,eqb->nab", dm, phi, r, optimize=True), size),
        ("P2", np.einsum("eq,neqa,jeqb->njab", dm, phi, phi, optimize=True), 1.0),
    ):
        assert np.max(np.abs(getattr(found, name) - expected)) <= 1e-10 * scale, name
    assert np.max(np.abs(found.P2)) > 0.1


def test_stiffness_of_known_fields(block):
    """The energy of a uniform strain is that of Hooke's law times the volume; that of rigid motions is
    nothing."""
    lam, mu = STEEL.lame
    strain = np.array([[1.0, 0.3, -0.2], [0.3, -0.5, 0.4], [-0.2, 0.4, 0.8]]) * 1e-3
    u = (block.nodes @ strain).ravel()
    density = 0.5 * lam * np.trace(strain) ** 2 + mu * np.sum(strain**2)
    assert abs(0.5 * u @ (block.stiffness @ u) / (density * 0.4 * 0.3 * 0.2) - 1) <= 1e-12
    rigid = block.stiffness @ block.rigid
    assert np.max(np.abs(rigid)) <= 1e-11 * np.max(np.abs(block.stiffness.data))


def test_mass_centre_and_inertia(block):
    """Of a block, by the textbook."""
    m = block.moments(np.zeros((block.unknowns, 0)))
    mass = STEEL.density * 0.4 * 0.3 * 0.2
    assert abs(m.m / mass - 1) <= 1e-12
    assert np.allclose(m.MS0 / m.m, [0.1, -0.2, 0.3], atol=1e-12)
    central = m.P0 / m.m - np.outer(m.MS0, m.MS0) / m.m**2
    assert np.allclose(central, np.diag([0.4**2, 0.3**2, 0.2**2]) / 12, atol=1e-12)


def test_rotations_of_nodes(block):
    """Exact for a field whose gradient is the same everywhere: half its curl."""
    gradient = np.array([[0.1, -0.7, 0.3], [0.5, 0.2, -0.4], [0.6, 0.9, -0.3]])
    turned = (block.rotation @ (block.nodes @ gradient.T).ravel()).reshape(-1, 3)
    rigid = 0.5 * (gradient - gradient.T)
    curl = np.array([rigid[2, 1], rigid[0, 2], rigid[1, 0]])
    twist = turned[np.argmin(np.linalg.norm(block.nodes - [0.1, -0.2, 0.3], axis=1))]
    assert np.allclose(block.rotation @ (block.nodes @ rigid.T).ravel(), np.tile(curl, len(block.nodes)))
    assert np.linalg.norm(twist - curl) <= 0.5 * np.linalg.norm(gradient)


def test_materials_of_parts():
    """A bar of two halves of other density and modulus: its mass, and a static stretch in series."""
    mesh = box((1.0, 0.1, 0.1), (8, 1, 1))
    parts = (mesh.nodes[mesh.elements].mean(axis=1)[:, 0] > 0).astype(int)
    soft = pf.fe.Material(7e10, 0.0, 2700.0)
    stiff = pf.fe.Material(2.1e11, 0.0, 7850.0)
    two = pf.fe.SolidMesh(mesh.nodes, mesh.elements, parts)
    body = pf.fe.solid_body(two, [soft, stiff])
    assert abs(body.mass.sum() / 3 - 0.005 * (2700 + 7850)) <= 1e-9
    x = mesh.nodes[:, 0]
    u = np.zeros_like(mesh.nodes)
    u[:, 0] = np.where(x < 0, x / 7e10, x / 2.1e11)  # unit stress throughout, ν = 0
    energy = 0.5 * u.ravel() @ (body.stiffness @ u.ravel())
    assert abs(energy / (0.5 * 0.01 * 0.5 * (1 / 7e10 + 1 / 2.1e11)) - 1) <= 1e-12


def test_outline_with_all_features():
    """Mass and centre of an L with a hole, a rib of another material and a thicker arm."""
    arm = [(0.3, 0), (0.6, 0), (0.6, 0.2), (0.3, 0.2)]
    rib = [(0.05, 0.3), (0.15, 0.3), (0.15, 0.4), (0.05, 0.4)]
    mesh = pf.fe.outline_mesh(
        [(0, 0), (0.6, 0), (0.6, 0.2), (0.2, 0.2), (0.2, 0.5), (0, 0.5)],
        0.02,
        holes=[[(0.05, 0.05), (0.15, 0.05), (0.15, 0.15), (0.05, 0.15)]],
        ribs=[pf.fe.Rib(rib, 0.03, part=1)],
        steps=[pf.fe.Step(arm, 0.03)],
        size=0.08,
    )
    body = pf.fe.solid_body(mesh, [pf.fe.Material(7e10, 0.33, 2700.0), STEEL])
    m = body.moments(np.zeros((body.unknowns, 0)))
    pieces = [  # mass, centre
        (2700 * 0.02 * 0.3 * 0.2, (0.15, 0.1, 0)),
        (2700 * 0.02 * 0.2 * 0.3, (0.1, 0.35, 0)),
        (-2700 * 0.02 * 0.1 * 0.1, (0.1, 0.1, 0)),
        (2700 * 0.03 * 0.3 * 0.2, (0.45, 0.1, 0)),
        (7850 * 0.03 * 0.1 * 0.1, (0.1, 0.35, 0.025)),
    ]
    assert abs(m.m / sum(mass for mass, _ in pieces) - 1) <= 1e-9
    assert np.allclose(m.MS0, sum(mass * np.array(centre) for mass, centre in pieces), atol=1e-9)


def test_hole_may_be_round():
    """Curved edges: the volume is right to 3e-5 with a coarse mesh (straight ones: 1e-2)."""
    mesh = pf.fe.outline_mesh([(0, 0), (0.4, 0), (0.4, 0.4), (0, 0.4)], 0.02, [(0.2, 0.2, 0.1)], size=0.05)
    body = pf.fe.solid_body(mesh, STEEL)
    assert abs(body.mass.sum() / 3 / (7850 * 0.02 * (0.16 - np.pi * 0.01)) - 1) <= 3e-5


def test_step_file_in_any_unit(tmp_path):
    """The unit that the file names is kept, and may be overruled."""
    occ = pytest.importorskip("netgen.occ")
    file = tmp_path / "block.step"
    occ.Box((0, 0, 0), (400, 300, 20)).WriteStep(str(file))  # Open Cascade writes millimetres
    text = file.read_text()
    for name, unit, size in (
        ("SI_UNIT(.MILLI.,.METRE.)", None, 0.4),
        ("SI_UNIT(.CENTI.,.METRE.)", None, 4.0),
        ("SI_UNIT(.CENTI.,.METRE.)", "mm", 0.4),
        ("SI_UNIT($,.METRE.)", "mm", 0.4),
    ):
        file.write_text(text.replace("SI_UNIT(.MILLI.,.METRE.)", name))
        mesh = pf.fe.step_mesh(file, size=size / 4, unit=unit)
        assert np.allclose(np.ptp(mesh.nodes, axis=0), [size, 0.75 * size, 0.05 * size])
    file.write_text(text.replace("SI_UNIT(.MILLI.,.METRE.)", "SI_UNIT($,.METRE.)"))
    with pytest.raises(pf.InputError, match="400 m across and weighs .* is its unit of length right"):
        pf.fe.solid_body(pf.fe.step_mesh(file, size=100.0), STEEL)


def test_marks_and_line_ends_of_editors_change_nothing(tmp_path):
    """STEP files and meshes in UTF-8 with a byte order mark, and lines that end with CR LF."""
    occ, meshio = pytest.importorskip("netgen.occ"), pytest.importorskip("meshio")
    step, mesh = tmp_path / "block.step", tmp_path / "block.inp"
    occ.Box((0, 0, 0), (400, 300, 20)).WriteStep(str(step))
    made = pf.fe.step_mesh(step, size=0.1)
    meshio.Mesh(made.nodes, {"tetra10": made.elements}).write(mesh)
    for file in (step, mesh):
        data = file.read_bytes().replace(b"\r\n", b"\n").replace(b"\n", b"\r\n")
        file.write_bytes(b"\xef\xbb\xbf" + data)
        found = pf.fe.mesh_from(file, "mm" if file is step else "m", 0.1 if file is step else None)
        assert np.allclose(found.nodes, made.nodes)
        assert np.array_equal(found.elements, made.elements)


INCH = """#{0} = ( CONVERSION_BASED_UNIT('INCH',#9000) LENGTH_UNIT() NAMED_UNIT(#9001) );
#9000 = LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#9002);
#9001 = DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);
#9002 = ( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) );"""


def test_step_file_in_inches(tmp_path):
    """As CAD programs write them; and overruled."""
    occ = pytest.importorskip("netgen.occ")
    file = tmp_path / "block.step"
    occ.Box((0, 0, 0), (16, 12, 0.8)).WriteStep(str(file))
    pattern = r"#(\d+) = \( LENGTH_UNIT\(\) NAMED_UNIT\(\*\) SI_UNIT\(\.MILLI\.,\.METRE\.\) \);"
    file.write_text(re.sub(pattern, lambda found: INCH.format(found[1]), file.read_text()))
    for unit, metres in ((None, 0.0254), ("mm", 1e-3)):
        mesh = pf.fe.step_mesh(file, size=4 * metres, unit=unit)
        assert np.allclose(np.ptp(mesh.nodes, axis=0), metres * np.array([16, 12, 0.8]))


def test_step_file_of_several_solids(tmp_path):
    """Solids that touch are parts of one body, each with its material; those that do not are refused."""
    occ = pytest.importorskip("netgen.occ")
    file = tmp_path / "two.step"
    for gap, words in ((0.0, None), (10.0, "2 parts that do not touch")):
        two = [occ.Box((0, 0, 0), (200, 100, 50)), occ.Box((200 + gap, 0, 0), (400 + gap, 100, 50))]
        occ.Compound(two).WriteStep(str(file))
        if words is not None:
            with pytest.raises(pf.InputError, match=words):
                pf.fe.step_mesh(file, size=0.08)
            continue
        mesh = pf.fe.step_mesh(file, size=0.08)
        body = pf.fe.solid_body(mesh, [STEEL, pf.fe.Material(7e10, 0.33, 2700.0)])
        assert np.isclose(body.mass.sum() / 3, 1e-3 * (7850 + 2700))


def test_mesh_files_of_both_orders(tmp_path):
    """Written by meshio in millimetres, first and second order: the same body."""
    meshio = pytest.importorskip("meshio")
    mesh = box((0.2, 0.1, 0.1), (2, 1, 1))
    file = tmp_path / "block.vtu"
    for kind, cells in (("tetra", mesh.elements[:, :4]), ("tetra10", mesh.elements)):
        meshio.Mesh(1e3 * mesh.nodes, {kind: cells}).write(file)
        found = pf.fe.read_mesh(file, "mm")
        assert np.isclose(pf.fe.solid_body(found, STEEL).mass.sum(), 3 * 7850 * 0.002)
        middles = 0.5 * (
            found.nodes[found.elements[:, EDGES[:, 0]]] + found.nodes[found.elements[:, EDGES[:, 1]]]
        )
        assert np.allclose(found.nodes[found.elements[:, 4:]], middles)


def test_matrices_in_any_order_are_the_same_body(block):
    """Rows shuffled, as other programs write them."""
    order = np.random.default_rng(3).permutation(block.unknowns)
    table = np.stack(np.divmod(np.arange(block.unknowns), 3), axis=1)[order]
    K, M = (X.tocsr()[order][:, order] for X in (block.stiffness, block.mass))
    again = pf.fe.body_of_matrices(block.nodes, K, M, table)
    assert np.allclose(again.free_modes(4)[0], block.free_modes(4)[0], rtol=1e-9)


def test_mesh_repairs_are_told():
    """Inverted elements, doubled and idle nodes: mended, and named; the body is the same."""
    good = box((0.2, 0.1, 0.1), (2, 1, 1))
    corners_only = good.elements[:, :4]
    r = good.nodes[: 1 + corners_only.max()]
    left = r[corners_only].mean(axis=1)[:, 0] < 0
    doubled = np.vstack([r, r, [[9.0, 9.0, 9.0]]])
    cells = np.where(left[:, None], corners_only, corners_only + len(r))
    cells[0] = cells[0][[1, 0, 2, 3]]
    mesh = pf.fe.solid_mesh(doubled, cells)
    assert any("coincident nodes were joined" in note for note in mesh.notes)
    assert any("on no element" in note for note in mesh.notes)
    assert any("1 inverted elements were turned" in note for note in mesh.notes)
    assert len(mesh.nodes) == len(good.nodes)
    assert np.isclose(pf.fe.solid_body(mesh, STEEL).mass.sum(), 3 * 7850 * 0.002)


def test_parts_that_touch_are_one():
    mesh = pf.fe.solid_mesh(*two_blocks(0.0))
    assert any("coincident" in note for note in mesh.notes)


def flat_element():
    return pf.fe.solid_mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0.0)], [(0, 1, 2, 3)])


def folded_element():
    r, cells = with_middles(np.vstack([np.zeros(3), np.eye(3)]), np.array([[0, 1, 2, 3]]))
    r[cells[0, 4]] = (2.0, 0.0, 0.0)
    return pf.fe.solid_mesh(r, cells)


def heavy_plate():
    """A plate of 73 kg drawn ten times too large: 73 tonnes."""
    mesh = box((10.0, 6.5, 0.15), (4, 3, 1))
    return pf.fe.solid_body(mesh, pf.fe.Material(2e10, 0.3, 7500.0))


WRONG = {
    "no volume": (flat_element, "element 0 has no volume"),
    "folded": (folded_element, "element 0 is folded"),
    "apart": (lambda: pf.fe.solid_mesh(*two_blocks(0.02)), r"2 parts that do not touch, 0\.02 m apart"),
    "heavy": (heavy_plate, r"10 m across and weighs 7\.\d+e\+04 kg: is its unit of length right"),
    "node that is not": (lambda: pf.fe.solid_mesh(np.eye(4, 3), [(0, 1, 2, 7)]), "names node 7"),
    "crossing": (
        lambda: pf.fe.outline_mesh([(0, 0), (1, 1), (1, 0), (0, 1)], 0.01),
        "outline crosses itself: the edges from corners 0 and 2 meet",
    ),
    "unknown unit": (lambda: pf.fe.read_mesh("a.msh", "parsec"), "unit is 'parsec'; choose one of m, mm"),
    "no mesh file": (lambda: pf.fe.read_mesh("none.msh", "mm"), "there is no such file"),
    "no step file": (lambda: pf.fe.step_mesh("none.step"), "none.step cannot be read"),
    "poisson": (lambda: pf.fe.Material(1e9, 0.5, 1.0), "Material.poisson is 0.5"),
    "materials": (
        lambda: pf.fe.solid_body(box((0.1,) * 3, (1,) * 3), [STEEL] * 3),
        "material has 3 entries, the mesh 1 parts",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_refused_in_one_sentence(case):
    make, words = WRONG[case]
    with pytest.raises(pf.InputError, match=words):
        make()


def test_damaged_files_are_refused(tmp_path):
    pytest.importorskip("netgen.occ")
    (tmp_path / "words.step").write_text("hello")
    (tmp_path / "words.msh").write_text("hello")
    with pytest.raises(pf.InputError, match="names no unit of length"):
        pf.fe.step_mesh(tmp_path / "words.step")
    with pytest.raises(pf.InputError, match="damaged or in no format of meshio"):
        pf.fe.read_mesh(tmp_path / "words.msh", "mm")


def test_matrices_of_other_models_are_refused(block):
    K, M, r = block.stiffness, block.mass, block.nodes
    ground = sparse.diags_array(np.where(np.arange(block.unknowns) < 30, 1e9, 0.0))
    table = np.stack(np.divmod(np.arange(block.unknowns), 3), axis=1)
    for words, given in (
        ("stiffness resists rigid motions", (r, K + ground, M)),
        ("not the same in the three directions", (r, K, K)),
        ("stiffness has shape", (r[1:], K, M)),
        ("not symmetric", (r, sparse.triu(K), M)),
        ("unknowns has rotations", (r, K, M, table + [0, 2])),
        ("node 0 has no component 0", (r, K, M, table[1:])),
    ):
        with pytest.raises(pf.InputError, match=words):
            pf.fe.body_of_matrices(*given)
