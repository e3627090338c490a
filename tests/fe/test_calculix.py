"""Modes and matrices of CalculiX, which the tests run where it is installed."""

import numpy as np
import pytest
from scipy import io, sparse

import parflex as pf
from ccx import deck, needs_ccx, plate_mesh, run
from paper_robot import PLATE, corners
from parflex.fe.body.elements import ELEMENTS
from parflex.fe.body.joints import places
from parflex.fe.imports.calculix.calculix import FULL, REDUCED
from parflex.fe.imports.calculix.deck import ABAQUS_ORDER, read_deck
from parflex.fe.imports.calculix.storage import degrees, triangle

pytestmark = needs_ccx

TYPES = {  # with which rules CalculiX integrates their masses
    "C3D4": ("tet4", FULL),
    "C3D10": ("tet10", FULL),
    "C3D6": ("wedge6", FULL),
    "C3D15": ("wedge15", FULL),
    "C3D8": ("hex8", FULL),
    "C3D20": ("hex20", FULL),
    "C3D20R": ("hex20", REDUCED),
}


@pytest.fixture(scope="module")
def plate(tmp_path_factory):
    """The paper's plate on 2,451 nodes, solved for modes and written as matrices; (frd, deck, job)."""
    folder = tmp_path_factory.mktemp("plate")
    mesh = plate_mesh(3)
    modes = run(folder, "modes", deck(*mesh, "*FREQUENCY\n22"))
    stored = run(folder, "stored", deck(*mesh, "*FREQUENCY, SOLVER=MATRIXSTORAGE\n22"))
    return modes.with_suffix(".frd"), modes, stored.with_suffix(".sti")


@pytest.fixture(scope="module")
def imported(plate) -> pf.Modes:
    return pf.fe.read_calculix(plate[0], plate[1], "SI")


@pytest.fixture(scope="module")
def stored(plate) -> pf.fe.FreeBody:
    return pf.fe.calculix_body(plate[2], plate[1], "SI")


@pytest.mark.parametrize("kind", TYPES)
def test_mass_matrices_are_calculixs_own(tmp_path, kind):
    """One skew element of each type: the order of its nodes and the points of its integration."""
    shape, rule = TYPES[kind]
    element = ELEMENTS[shape]
    nodes = element.points @ (np.eye(3) + 0.2 * np.random.default_rng(1).normal(size=(3, 3)))
    order = ABAQUS_ORDER.get(shape, range(len(nodes)))
    job = run(tmp_path, "one", deck(nodes, [np.argsort(order)], "*FREQUENCY, SOLVER=MATRIXSTORAGE\n1", kind))
    unknowns = degrees(job.with_suffix(".dof"))
    along = np.flatnonzero(unknowns[:, 1] == 1)
    own = triangle(job.with_suffix(".mas"), len(unknowns)).toarray()[np.ix_(along, along)]
    read = read_deck(job)
    at = read.elements[shape][0]
    own = own[np.ix_(*[[list(unknowns[along, 0]).index(node) for node in at]] * 2)]
    found = element.masses(read.nodes[at - 1][None], np.array([PLATE["density"]]), rule[shape])[0]
    assert np.max(np.abs(found - own)) <= 1e-11 * np.max(own)  # the file has 14 digits


def test_modes_belong_to_the_masses(imported):
    """To the six digits of the file; mass and inertia of the plate by formula and by the rigid modes."""
    report = imported.report
    assert report.rigid_modes == 6
    assert max(report.orthonormality, report.S, report.beta) <= 2e-6
    assert max(report.orthonormality_after, report.momentum_after) <= 1e-13
    mass = PLATE["density"] * PLATE["thickness"] * 1.5 * np.sqrt(3) * 0.5**2
    assert report.body.mass == pytest.approx(mass, rel=1e-9)
    assert report.own.mass == pytest.approx(mass, rel=1e-5)
    # a regular hexagon of side a: I_z = 5/12 m a²
    assert report.body.inertia[2, 2] == pytest.approx(5 / 12 * mass * 0.5**2, rel=1e-9)


def test_eigenvalues_of_its_matrices_are_its_modes(imported, stored):
    """K and M read from text against the modes that CalculiX computed with them."""
    modes = pf.fe.FreeFree(9, points=()).modes(stored)
    assert np.max(np.abs(modes.frequencies / imported.frequencies[:9] - 1)) <= 1e-5


def test_matrices_make_the_same_body_by_matrix_market_and_npz(tmp_path, stored):
    """Written with the nodes in another order, and each unknown named."""
    count = len(stored.nodes)
    shuffled = np.random.default_rng(2).permutation(3 * count)
    K, M = (matrix.tocsr()[shuffled][:, shuffled] for matrix in (stored.stiffness, stored.mass))
    io.mmwrite(tmp_path / "k.mtx", sparse.coo_matrix(K), precision=17)
    sparse.save_npz(tmp_path / "m.npz", sparse.csr_matrix(M))
    np.savetxt(tmp_path / "nodes.txt", np.column_stack([np.arange(count) + 7, stored.nodes]), "%.17g")
    np.savetxt(tmp_path / "rows.txt", np.column_stack([shuffled // 3 + 7, shuffled % 3 + 1]), "%d")
    files = [tmp_path / name for name in ("k.mtx", "m.npz", "nodes.txt")]
    found = pf.fe.read_matrices(*files, "SI", tmp_path / "rows.txt")
    assert abs(found.stiffness - stored.stiffness).max() <= 1e-12 * abs(stored.stiffness).max()
    assert abs(found.mass - stored.mass).max() <= 1e-12 * abs(stored.mass).max()


def test_patches_hold_where_the_points_are(imported):
    """A patch moves as its nodes do in the mean; at the corners that is what the corners do, nearly."""
    points = np.column_stack([corners(), np.zeros(6)])
    held = pf.fe.attached(imported, points=points, radius=0.03)
    body = pf.FlexibleBody.from_modes(held)
    assert np.allclose(body.attachment_points, points, rtol=0, atol=1e-12)
    near = np.linalg.norm(imported.nodes - points[0], axis=1) <= 0.03
    centre = imported.nodes[near].mean(axis=0)
    motion = body.shapes_at(body.attachments[0], centre - points[0])[0].T
    assert np.allclose(motion, imported.shapes[:, near].mean(axis=1), rtol=0, atol=1e-12)


def test_attachments_by_id_are_nodes_of_the_deck(imported, plate):
    ids = [2, 3, 4, 5, 6, 7]  # the corners of the lower face, in the order of the deck
    body = pf.FlexibleBody.from_modes(pf.fe.attached(imported, ids=ids))
    expected = read_deck(plate[1]).nodes[1:7]
    assert np.allclose(body.attachment_points, expected, rtol=0, atol=1e-9)


def held_plate(tmp_path) -> pf.Modes:
    job = run(
        tmp_path, "held", deck(*plate_mesh(1), "*FREQUENCY\n12", extra="*BOUNDARY\n2,1,3\n3,1,3\n5,1,3")
    )
    return pf.fe.read_calculix(job.with_suffix(".frd"), job, "SI")


def test_a_held_model_is_refused(tmp_path):
    with pytest.raises(pf.InputError, match="held, not free: .* nodes 2, 3, 5 move in no mode"):
        held_plate(tmp_path)


def test_held_matrices_are_refused(tmp_path):
    text = deck(*plate_mesh(1), "*FREQUENCY, SOLVER=MATRIXSTORAGE\n1", extra="*BOUNDARY\n2,1,3\n3,1,3")
    job = run(tmp_path, "held", text)
    with pytest.raises(pf.InputError, match="node 2|remove constraints|does not fit"):
        pf.fe.calculix_body(job, job, "SI")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda text: text.replace("*DENSITY\n7500\n", ""), r"no \*DENSITY of the material PLATE"),
        (lambda text: text.replace("*DENSITY\n7500", "*DENSITY\n7600"), "computed with 73.071 kg"),
        (lambda text: text.replace("*DENSITY\n7500", "*DENSITY\n7.5e-9"), "nothing has"),
        (lambda text: text.replace("\n5,", "\n5,1", 1), "give the files of one model"),
        (lambda text: "*STEP\n*FREQUENCY\n", "has no nodes"),
    ],
)  # fmt: skip
def test_decks_of_other_models(tmp_path, plate, change, words):
    (tmp_path / "other.inp").write_text(change(plate[1].read_text()))
    with pytest.raises(pf.InputError, match=words):
        pf.fe.read_calculix(plate[0], tmp_path / "other.inp", "SI")


@pytest.mark.parametrize("units", ["mm-tonne-s", "in-lbf", "mm-kg-ms"])
def test_wrong_units(plate, units):
    with pytest.raises(pf.InputError, match='did you mean "SI"'):
        pf.fe.read_calculix(plate[0], plate[1], units)
    with pytest.raises(pf.InputError, match='did you mean "SI"'):
        pf.fe.calculix_body(plate[2], plate[1], units)


def test_truncated_and_binary_results(tmp_path, plate):
    whole = plate[0].read_bytes()
    (tmp_path / "half.frd").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(pf.InputError, match="cut short|damaged"):
        pf.fe.read_calculix(tmp_path / "half.frd", plate[1], "SI")
    job = run(tmp_path, "binary", deck(*plate_mesh(1), "*FREQUENCY\n9").replace("*NODE FILE", "*NODE OUTPUT"))
    with pytest.raises(pf.InputError, match="binary"):
        pf.fe.read_calculix(job.with_suffix(".frd"), job, "SI")


@pytest.fixture(scope="module")
def own():
    """Our solid on the same mesh, whose masses are integrated exactly."""
    material = pf.fe.Material(PLATE["young"], PLATE["poisson"], PLATE["density"])
    return pf.fe.solid_body(pf.fe.solid_mesh(*plate_mesh(3)), material)


def test_modes_against_our_solid_on_the_same_mesh(imported, own):
    """≤ 0.01 %, growing with the mode: CalculiX takes four points for masses that are of fourth degree."""
    ours = pf.fe.FreeFree(14, points=()).modes(own).frequencies
    difference = np.abs(imported.frequencies[:14] / ours - 1)
    assert np.max(difference) <= 1e-4
    assert np.max(difference[:2]) <= 3e-6


def test_attachment_modes_of_its_matrices_against_ours(stored, own):
    """Flexibility at the corners under inertia relief: of the basis, and of the whole model, ≤ 1e-6."""
    points = np.column_stack([corners(), np.zeros(6)])
    assert np.allclose(stored.nodes, own.nodes, rtol=0, atol=1e-12)
    assert abs(stored.stiffness - own.stiffness).max() <= 1e-11 * abs(own.stiffness).max()
    flexibility = []
    for body in (stored, own):
        modes = pf.fe.FreeFreeWithAttachment(9, points, radius=0.05).modes(body)
        w = pf.FlexibleBody.from_modes(modes).attachment_shapes[:, 2]
        forces = sparse.vstack([place.displacement[2:3] for place in places(body, points, None, 0.05)]).T
        full = forces.T @ body.flexed(forces.toarray())
        flexibility += [w / modes.frequencies**2 @ w.T, full]
    largest = np.max(np.abs(flexibility[-1]))
    for other in flexibility[:-1]:
        assert np.max(np.abs(other - flexibility[-1])) <= 1e-6 * largest


def rectangle(kind: str) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and elements, in Abaqus' order, of a plate 0.6 × 0.5 m of 6 × 5 elements; bricks 20 mm thick."""
    points = ELEMENTS[kind].points
    size = np.array([0.1, 0.1, 0.02])[: points.shape[1]]
    cells = np.array([(i, j, 0) for i in range(6) for j in range(5)])[:, None, : points.shape[1]]
    every = np.round(2 * (cells + points)).astype(int)
    unique, number = np.unique(every.reshape(-1, points.shape[1]), axis=0, return_inverse=True)
    nodes = np.pad(unique / 2 * size, ((0, 0), (0, 3 - points.shape[1])))
    order = ABAQUS_ORDER.get(kind, range(len(points)))
    return nodes, number.reshape(len(cells), -1)[:, np.argsort(order)]


@pytest.mark.parametrize(("kind", "shape"), [("C3D20R", "hex20"), ("C3D8", "hex8"), ("S8R", "quad8")])
def test_other_elements(tmp_path, kind, shape):
    """Bricks, and shells that CalculiX makes bricks of: the modes belong to the masses, of ρ V."""
    text = deck(*rectangle(shape), "*FREQUENCY\n12", kind)
    if kind == "S8R":
        text = text.replace("*SOLID SECTION", "*SHELL SECTION").replace(
            "MATERIAL=Plate\n", "MATERIAL=Plate\n0.02\n"
        )
        text = text.replace("*NODE FILE", "*NODE FILE, OUTPUT=3D")
    job = run(tmp_path, "plate", text)
    report = pf.fe.read_calculix(job.with_suffix(".frd"), job, "SI").report
    assert report.body.mass == pytest.approx(PLATE["density"] * 0.6 * 0.5 * 0.02, rel=1e-5)
    assert max(report.orthonormality, report.S, report.beta) <= 5e-6
