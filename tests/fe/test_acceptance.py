"""What makes a platform of imported modes: repaired, held, or refused."""

import numpy as np
import pytest
from scipy.linalg import null_space

import parflex as pf
from imports import DATA
from parflex.fe.body.attach import first
from parflex.fe.body.integrals import rigid_fields
from parflex.fe.imports.imported import inner
from parflex.fe.imports.nastran.bulk_data import read_bulk
from parflex.fe.imports.nastran.op2 import read_op2
from parflex.fe.imports.unit_systems import SYSTEMS, check_material, units_named

pytest.importorskip("pyyeti", reason="the modes are MYSTRAN's")

KEPT = 15  # modes, six rigid ones among them


@pytest.fixture(scope="module")
def plate():
    """Nodes, both mass matrices, shapes, rotations and ω² of MYSTRAN's plate."""
    modes, bulk = read_op2(DATA / "hexQ8.OP2"), read_bulk(DATA / "hexQ8.bdf", SYSTEMS["SI"])
    return bulk.nodes, bulk.masses, modes.shapes[:KEPT], modes.rotations[:KEPT], modes.squares[:KEPT]


@pytest.fixture
def read(tmp_path, plate):
    """Import the plate's arrays, some of them replaced."""
    nodes, masses, shapes, rotations, squares = plate
    plain = {
        "nodes": nodes,
        "masses": masses["lumped"].diagonal(),
        "shapes": shapes,
        "rotations": rotations,
        "omega": np.sign(squares) * np.sqrt(np.abs(squares)),
    }

    def make(**changes) -> pf.Modes:
        given = {name: value for name, value in (plain | changes).items() if value is not None}
        np.savez(tmp_path / "modes.npz", **given)
        return pf.fe.read_arrays(tmp_path / "modes.npz", "SI")

    return make


def test_modes_of_a_consistent_mass_with_lumped_masses(read, plate):
    """Ritz modes in the consistent mass, of the span of the lumped one's: the repair gives those back.

    The stiffness that the modes stand for is the same, so that Ritz modes in the lumped mass are the
    ones that the file had, frequencies and all.
    """
    nodes, masses, shapes, _, squares = plate
    heavy = masses["consistent"]
    rigid = rigid_fields(nodes)
    rigid = np.einsum("ij,jka->ika", np.linalg.inv(np.linalg.cholesky(inner(heavy, rigid, rigid))), rigid)
    elastic = shapes[6:]
    elastic = elastic - np.einsum("ij,jka->ika", inner(heavy, elastic, rigid), rigid)
    gram = inner(heavy, elastic, elastic)
    white = np.linalg.inv(np.linalg.cholesky(gram))
    values, turn = np.linalg.eigh(white @ np.diag(squares[6:]) @ white.T)
    consistent = np.einsum("ij,jka->ika", turn.T @ white, elastic)
    omega = np.concatenate([np.zeros(6), np.sqrt(values)])
    found = read(shapes=np.concatenate([rigid, consistent]), rotations=None, omega=omega)
    assert 0.02 < found.report.orthonormality < 0.2
    assert any("another mass matrix (consistent?)" in note for note in found.notes)
    assert np.max(np.abs(found.frequencies / np.sqrt(squares[6:]) - 1)) <= 1e-6
    assert max(found.report.orthonormality_after, found.report.momentum_after) <= 1e-12
    assert np.all(found.report.frequencies_read[:2] > 1.01 * found.frequencies[:2])


def test_without_the_rigid_modes(read, plate):
    """A file of elastic modes alone makes the same platform: they have no momentum."""
    whole = read()
    found = read(**{name: value[6:] for name, value in named(plate).items()})
    assert found.report.rigid_modes == 0
    assert np.allclose(found.shapes, whole.shapes, rtol=0, atol=1e-9 * np.max(np.abs(whole.shapes)))


def named(plate) -> dict[str, np.ndarray]:
    _, _, shapes, rotations, squares = plate
    return {
        "shapes": shapes,
        "rotations": rotations,
        "omega": np.sign(squares) * np.sqrt(np.abs(squares)),
    }


def test_frequencies_in_hertz(read, plate):
    omega = named(plate)["omega"]
    found = read(omega=None, hertz=omega / (2 * np.pi))
    assert np.max(np.abs(found.frequencies / omega[6:] - 1)) <= 1e-12


@pytest.mark.parametrize("factor", [1e40, -1.0, 1.001])
def test_one_wrong_number_in_one_mode(read, plate, factor):
    """Of 217 nodes × 15 modes: a displacement that is huge, of wrong sign, 0.1 % off."""
    shapes = plate[2].copy()
    shapes[9, np.argmax(np.abs(shapes[9, :, 2])), 2] *= factor
    with pytest.raises(pf.InputError, match="mode 10 "):
        read(shapes=shapes)


@pytest.mark.parametrize(
    ("name", "change", "words"),
    [
        ("shapes", lambda v: 1.1 * v, "computed with"),
        ("masses", lambda v: 1.02 * v, "computed with"),
        ("nodes", lambda v: v + 0.05 * (v[:, :1] > 0.4), "leaves the rigid body|kg at"),
        ("omega", lambda v: np.where(np.arange(len(v)) < 6, 5.0, v), "not free of stiffness"),
        ("omega", lambda v: np.where(np.arange(len(v)) == 8, 0.0, v), "not free of stiffness"),
        ("rotations", lambda v: v * (1 + 50 * (np.arange(217) == 5))[:, None], "node 6 (turns by|does not)"),
        ("shapes", lambda v: v[:, ::-1], "leaves the rigid body|orthonormal|held"),
        ("shapes", lambda v: v[:6], "ask for elastic modes"),
    ],
)  # fmt: skip
def test_arrays_of_other_models(read, plate, name, change, words):
    plain = named(plate) | {"nodes": plate[0], "masses": plate[1]["lumped"].diagonal()}
    changes = {name: change(plain[name])}
    if len(changes[name]) == 6:
        changes = {key: plain[key][:6] for key in ("shapes", "rotations", "omega")}
    with pytest.raises(pf.InputError, match=words):
        read(**changes)


def test_a_pinned_plate_is_held(read, plate):
    """Ritz modes of motions in which node 1 stays where it is: three of them turn about it."""
    shapes, squares = plate[2], plate[4]
    free = null_space(shapes[:, 0].T)
    values, turn = np.linalg.eigh(free.T @ np.diag(squares) @ free)
    pinned = np.einsum("ij,ika->jka", free @ turn, shapes)
    with pytest.raises(pf.InputError, match="held, not free: mode .* node 1 moves in no mode"):
        read(shapes=pinned, rotations=None, omega=np.sqrt(np.abs(values)))


def test_missing_rotations_are_said(read):
    found = read(rotations=None)
    assert found.rotations is None
    assert "none: moments act on patches" in str(found.report)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"omega": None}, "lacks hertz or omega"),
        ({"hertz": np.ones(KEPT)}, "hertz or omega, one of them"),
        ({"masses": None}, "lacks masses"),
        ({"masses": -np.ones(217)}, "cannot be negative"),
        ({"masses": np.ones(3)}, "masses has shape"),
        ({"triangles": np.array([[0, 1, 999]])}, "triangle"),
        ({"modal_mass": np.zeros(KEPT)}, "modal_mass"),
    ],
)  # fmt: skip
def test_arrays_that_do_not_fit(read, changes, words):
    with pytest.raises(pf.InputError, match=words):
        read(**changes)


def test_fewer_modes_are_the_first_ones(read):
    whole = read()
    kept = first(whole, 3)
    assert np.array_equal(kept.shapes, whole.shapes[:3])
    assert np.array_equal(kept.moments.P2, whole.moments.P2[:3, :3])
    assert not any("degenerate" in note for note in kept.notes)
    assert any("cut a degenerate pair" in note for note in first(whole, 1).notes)
    with pytest.raises(pf.InputError, match="modes is 30, but the file has 9 elastic ones"):
        first(whole, 30)


def test_attachments_that_cannot_be(read):
    modes = read()
    for options, words in (
        ({"ids": [999]}, "has node 999, which the model has not"),
        ({"ids": [[1, 2]]}, "patch of 2 nodes"),
        ({"ids": [[1, 2, 3], [3, 4, 5]]}, "both hold node"),
        ({"points": [[9.0, 0, 0]]}, "is on no node"),
        ({"points": [[9.0, 0, 0]], "radius": 0.1}, "off the body"),
        ({"points": [[0, 0, 0]], "radius": 0.01}, "too few for a patch"),
        ({}, "both given, or neither"),
        ({"ids": [1], "points": [[0, 0, 0]]}, "both given, or neither"),
    ):
        with pytest.raises(pf.InputError, match=words):
            pf.fe.attached(modes, **options)


def test_patch_moves_as_its_nodes_do_in_the_mean(read):
    """In a rigid motion of the nodes a patch does the same; the shapes of a linear field are exact."""
    modes = read()
    held = pf.fe.attached(modes, ids=[[1, 2, 3, 5], 10])
    assert len(held.nodes) == len(modes.nodes) + 1
    assert held.corners == (217, 9)
    group = [0, 1, 2, 4]
    assert np.allclose(held.nodes[217], modes.nodes[group].mean(axis=0))
    assert np.allclose(held.shapes[:, 217], modes.shapes[:, group].mean(axis=1))
    # least squares: rotation with which the nodes' motion differs least from a rigid one
    s = modes.nodes[group] - held.nodes[217]
    for k in range(3):
        A = np.concatenate([np.cross(np.eye(3)[None], s[:, None]).swapaxes(1, 2)])
        b = modes.shapes[k, group] - held.shapes[k, 217]
        best = np.linalg.lstsq(A.reshape(-1, 3), b.ravel(), rcond=None)[0]
        assert np.allclose(held.rotations[k, 217], best, atol=1e-12)


def test_units():
    assert units_named("mm-tonne-s").density == pytest.approx(1e12)
    # 1 lbf s²/in⁴ is 1.0687e7 kg/m³: steel's 7.33e-4 there is 7833 kg/m³ (the NX case of 2012)
    assert 7.3315e-4 * units_named("in-lbf").density == pytest.approx(7835, rel=1e-3)
    assert 2.9e7 * units_named("in-lbf").pressure == pytest.approx(2.0e11, rel=1e-3)
    steel = {"SI": (7850, 2.1e11), "mm-tonne-s": (7.85e-9, 2.1e5), "mm-kg-ms": (7.85e-6, 210.0)}
    steel |= {"mm-kg-s": (7.85e-6, 2.1e8), "cm-g-s": (7.85, 2.1e12), "in-lbf": (7.35e-4, 3.05e7)}
    steel |= {"ft-lbf": (15.2, 4.39e9)}
    assert set(steel) == set(SYSTEMS)
    for written, values in steel.items():
        for named_so in SYSTEMS:
            if named_so == written:
                check_material("steel", *values, SYSTEMS[named_so])
            else:
                with pytest.raises(pf.InputError, match=f'did you mean .*"{written}"'):
                    check_material("steel", *values, SYSTEMS[named_so])
