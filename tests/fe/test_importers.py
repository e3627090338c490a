"""The contract of all importers: one platform, checked and reported, or one clear sentence."""

import os
import warnings
from codecs import BOM_UTF8
from pathlib import Path

import numpy as np
import pytest

import blocks as solids
import parflex as pf
from imports import ALL_CASES, CORNERS
from paper_robot import PLATE, TABLE_2
from spoil import spoilt

NAMES = [importer.name for importer in pf.fe.IMPORTERS]
SPOILT = int(os.environ.get("PARFLEX_SPOILT", "60"))  # files of each kind
MASS = PLATE["density"] * PLATE["thickness"] * 1.5 * np.sqrt(3) * 0.5**2  # kg, ρ h A of the hexagon
ROTATIONS = {("nastran", "op2"), ("arrays", "path")}  # files that hold rotations, which no law ties down


@pytest.fixture(scope="module", params=sorted(NAMES))
def case(request, tmp_path_factory):
    return ALL_CASES[request.param](tmp_path_factory.mktemp(request.param))


@pytest.fixture(scope="module")
def modes(case):
    return case.read()


def test_every_importer_has_a_case():
    assert set(NAMES) == set(ALL_CASES)


def test_mass_and_inertia_are_the_plates(modes):
    """m = ρ h A and I_z = 5/12 m s²; a lumped mass is 1.3 % off in the inertia on this mesh."""
    moments = modes.moments
    assert moments.m == pytest.approx(MASS, rel=1e-5)
    assert np.trace(moments.P0[:2, :2]) == pytest.approx(5 / 12 * MASS * 0.5**2, rel=0.014)
    assert np.allclose(moments.MS0 / moments.m, 0, atol=1e-6)


def test_modes_are_orthonormal_without_momentum(modes):
    from parflex.fe.body.integrals import rigid_momentum

    modal = np.trace(modes.moments.P2, axis1=-2, axis2=-1)
    assert np.max(np.abs(modal - np.eye(len(modal)))) <= 1e-12
    assert np.max(np.abs(rigid_momentum(modes.moments))) <= 1e-11 * np.sqrt(MASS)


def test_first_frequency_is_the_plates(modes):
    """Of Table 2, within what shells of four nodes (−1.4 %) and 18 tetrahedra (+9.2 %) leave."""
    assert -0.02 <= modes.frequencies[0] / TABLE_2[0] - 1 <= 0.095


def test_platform_is_held_at_the_corners_and_drives_a_robot(modes):
    """Inverse and direct models of the paper's robot undo one another."""
    body = pf.FlexibleBody.from_modes(modes, origin=(0, 0, 0), damping_ratio=0.4)
    assert np.allclose(body.attachment_points, CORNERS, rtol=0, atol=1e-9)
    robot = pf.robots.gough_stewart(platform=body)
    model = pf.Model(robot, "numpy")
    state, forces = model.equilibrium(*robot.home_pose)
    acc = model.direct(state, 1.01 * forces)
    found = model.inverse(state, acc.platform).forces
    assert np.max(np.abs(found - 1.01 * forces)) <= 1e-8 * np.max(np.abs(forces))


def test_report_is_returned_and_not_printed(case, capsys):
    told = str(case.read().report)
    assert f"{MASS:.4g}" in told
    assert "rigid" in told
    assert capsys.readouterr().out == ""


def test_units_are_asked_for(case):
    with pytest.raises(pf.InputError, match="units is not given"):
        case.read(units="")
    with pytest.raises(pf.InputError, match="units is 'metric'; choose one of"):
        case.read(units="metric")


@pytest.mark.parametrize("units", ["mm-tonne-s", "mm-kg-ms", "in-lbf", "ft-lbf"])
def test_wrong_units_are_told(case, units):
    """Density, modulus, size, mass and frequency make something that nothing is."""
    with pytest.raises(pf.InputError, match="units"):
        case.read(units=units)


def test_missing_files_are_told(case):
    for name in case.files:
        with pytest.raises(pf.InputError, match=r"absent.*: No such file"):
            case.read(**{name: Path("absent.npz" if name == "mass" else "absent.x")})


def test_import_modes_knows_its_files(case):
    with pytest.raises(pf.InputError, match="program is 'ansys'; choose one of"):
        pf.fe.import_modes("ansys", {}, "SI")
    with pytest.raises(pf.InputError, match="is not given; .* takes"):
        pf.fe.import_modes(case.program, {}, "SI")
    with pytest.raises(pf.InputError, match="deck is not one of its files"):
        pf.fe.import_modes(case.program, {**case.files, "deck": "x"}, "SI")


def test_one_more_importer_is_a_value():
    """A reader and a line in the tuple: the same files, errors and places as for the others."""

    def read(box, units):
        return pf.fe.solid_body(solids.box((0.3, 0.2, 0.1), (3, 2, 1)), solids.STEEL)

    dummy = pf.fe.Importer("dummy", read, ("box",))
    more = (*pf.fe.IMPORTERS, dummy)
    ends = [(-0.15, -0.1, 0.0), (0.15, 0.1, 0.0)]
    found = pf.fe.import_modes("dummy", {"box": "any"}, "SI", 3, None, ends, 0.06, importers=more)
    assert np.allclose(found.nodes[list(found.corners)], ends)
    with pytest.raises(pf.InputError, match="box is not given; dummy takes box"):
        pf.fe.import_modes("dummy", {}, "SI", importers=more)
    with pytest.raises(pf.InputError, match="choose one of .*, arrays$"):
        pf.fe.import_modes("dummy", {}, "SI")


def test_spoilt_files_make_one_sentence_or_the_same_platform(case, modes, tmp_path):
    """Flipped bytes, lost ends, stretches overwritten, lost or doubled, in each file by turns.

    What is not refused is the same platform: flips in titles, tables that are not read and last digits. Of a
    thousand spoilt decks one or two are decks of a slightly other mesh, and repaired like one.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for name, path in case.spoilt.items():
            whole, rng = path.read_bytes(), np.random.default_rng(7)
            outcomes = [outcome(case, modes, name, path, spoilt(whole, rng), tmp_path) for _ in range(SPOILT)]
            assert outcomes.count("refused") >= SPOILT // 2, name
            assert set(outcomes) <= {"refused", "the same", "repaired, and said to be"}, name
            assert outcomes.count("repaired, and said to be") <= SPOILT // 200 + 1, name


def test_marks_and_line_ends_of_editors_change_nothing(case, modes, tmp_path):
    """UTF-8 with a byte order mark and lines that end with CR LF, as Notepad writes."""
    texts = {name: path for name, path in case.spoilt.items() if b"\0" not in path.read_bytes()}
    for name, path in texts.items():
        edited = BOM_UTF8 + path.read_bytes().replace(b"\r\n", b"\n").replace(b"\n", b"\r\n")
        assert outcome(case, modes, name, path, edited, tmp_path) == "the same", name


def softness(field: str):
    """Σ Φ² / ω² of each node and axis, which the orientation of degenerate pairs does not change."""
    return lambda modes: np.einsum("nki,n->ki", getattr(modes, field) ** 2, modes.frequencies**-2)


FIELDS = {
    "nodes": lambda modes: modes.nodes,
    "frequencies": lambda modes: modes.frequencies,
    "shapes": softness("shapes"),
    "mass": lambda modes: np.array([modes.moments.m]),
    "second moments": lambda modes: modes.moments.P0,
}


def one_sentence(text: str) -> bool:
    return "\n" not in text and len(text) < 400


def outcome(case, modes, name: str, path: Path, data: bytes, folder: Path) -> str:
    """Whether a file is refused, or what it changes."""
    files = {key: folder / other.name for key, other in case.spoilt.items()}
    for key, other in case.spoilt.items():
        files[key].write_bytes(data if key == name else other.read_bytes())
    given = {key: folder / Path(other).name for key, other in case.files.items()}
    try:
        found = case.read(**given)
    except pf.InputError as error:
        return "refused" if one_sentence(str(error)) else f"refused in too many words: {error}"
    if any("another mass matrix" in note for note in found.notes):
        return "repaired, and said to be"
    fields = FIELDS if (case.program, name) in ROTATIONS else FIELDS | {"rotations": softness("rotations")}
    for field, value in fields.items():
        old, new = value(modes), value(found)
        if old.shape != new.shape or np.max(np.abs(new - old)) > 2e-3 * np.max(np.abs(old)):
            return f"other {field}: {found.notes}"
    return "the same"
