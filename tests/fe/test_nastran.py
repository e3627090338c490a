"""Modes from Nastran: MYSTRAN's of the paper's plate, and files of others where their folder is named.

PARFLEX_NASTRAN_CASES is the folder of plate_py.op2, plate_py.dat and beam_modes_m2.op2, of pyNastran's
model collection.
"""

import os
import struct
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest

import parflex as pf
from paper_robot import PLATE, corners
from parflex.fe.imports.nastran.bulk_data import read_bulk
from parflex.fe.imports.unit_systems import INCH, POUND_FORCE, SYSTEMS
from places import DATA

pytest.importorskip("pyyeti", reason="pyYeti reads Nastran's files")

CASES = os.environ.get("PARFLEX_NASTRAN_CASES", "")
OP2, BULK = DATA / "hexQ8.OP2", DATA / "hexQ8.bdf"

needs_cases = pytest.mark.skipif(not CASES, reason="PARFLEX_NASTRAN_CASES names no folder")

# radian frequencies in words 7 of the mode headers of hexQ8.OP2 (MYSTRAN writes them beside ω²)
HEXAGON = (186.5524, 186.55243, 311.61548, 394.86853, 468.13437, 686.9625, 686.96295, 740.9634, 740.9636)


def read(op2=OP2, bulk=BULK, units="SI") -> pf.Modes:
    return pf.fe.read_nastran(op2=op2, bulk=bulk, units=units)


@pytest.fixture(scope="module")
def hexagon() -> pf.Modes:
    return read()


def test_frequencies_are_those_of_the_file(hexagon):
    """To single precision, of which ω² has 24 bits."""
    assert np.max(np.abs(hexagon.frequencies[:9] / HEXAGON - 1)) <= 1e-6


def test_modes_are_orthonormal_and_without_momentum(hexagon):
    """As read to single precision; made so to round-off."""
    report = hexagon.report
    assert report.rigid_modes == 6
    assert report.normalised == "MASS"
    assert max(report.orthonormality, report.S, report.beta) <= 1e-7
    assert max(report.orthonormality_after, report.momentum_after) <= 1e-13
    assert report.residual_stiffness <= 1e-10


def test_mass_is_that_of_the_plate_and_of_the_rigid_modes(hexagon):
    """ρ h A of a regular hexagon, of which I_z = 5/12 m s² (1 % off on nodes); the six rigid modes
    hold MYSTRAN's own."""
    body, own = hexagon.report.body, hexagon.report.own
    mass = PLATE["density"] * PLATE["thickness"] * 1.5 * np.sqrt(3) * 0.5**2
    assert body.mass == pytest.approx(mass, rel=1e-6)
    assert own.mass == pytest.approx(mass, rel=1e-6)
    assert body.inertia[2, 2] == pytest.approx(5 / 12 * mass * 0.5**2, rel=0.02)
    assert np.allclose(own.inertia, body.inertia, rtol=0, atol=1e-6 * body.inertia[2, 2])


def test_against_the_kirchhoff_plate(hexagon):
    """192 four-node shells with lumped mass are 1 … 3.2 % too slow, mode by mode."""
    own = pf.fe.plate_modes(corners(), n_modes=9, **PLATE).frequencies
    difference = hexagon.frequencies[:9] / own - 1
    assert np.all((difference >= -0.033) & (difference <= -0.009))


def test_shapes_against_the_kirchhoff_plate(hexagon):
    """Nine modes span nearly the same space: the corners' deflections under unit static loads agree."""
    own = pf.fe.plate_modes(corners(), n_modes=9, **PLATE)
    compliance = []
    for modes in (own, hexagon):
        w = pf.FlexibleBody.from_modes(modes, at_corners(modes)).attachment_shapes[:, 2, :9]
        compliance.append(w / modes.frequencies[:9] ** 2 @ w.T)
    assert np.max(np.abs(compliance[1] - compliance[0])) <= 0.07 * np.max(compliance[0])


def at_corners(modes: pf.Modes) -> np.ndarray:
    """Nodes at the corners, in the order of the legs."""
    wanted = np.column_stack([corners(), np.zeros(6)])
    return np.argmin(np.linalg.norm(modes.nodes[:, None] - wanted, axis=2), axis=0)


def test_body_is_the_one_of_nodal_masses(hexagon):
    """`from_nodes`, which sums over nodes by itself, makes the same moments."""
    masses = read_bulk(BULK, SYSTEMS["SI"]).masses["lumped"].diagonal()
    body = pf.FlexibleBody.from_nodes(hexagon.nodes, masses, hexagon.shapes, hexagon.frequencies)
    for found, expected in zip(hexagon.moments, body.moments, strict=True):
        assert np.allclose(found, expected, rtol=0, atol=1e-12)


def test_other_units_are_the_same_plate(tmp_path, hexagon):
    """The plate written in mm, tonnes and seconds: another bulk file, the same platform.

    Mass-normalised shapes grow by the root of 1000 in tonnes, and their lengths by 1000 in mm.
    """
    text = BULK.read_text().replace("2.+10  ", "20000.  ").replace("   7500.", "  7.5-9 ")
    text = text.replace(".015    ", "15.     ")
    lines = [in_millimetres(line) if line.startswith("GRID") else line for line in text.splitlines()]
    (tmp_path / "mm.bdf").write_text("\n".join(lines))
    (tmp_path / "mm.op2").write_bytes(scaled(OP2.read_bytes(), np.sqrt(1e3)))
    found = read(tmp_path / "mm.op2", tmp_path / "mm.bdf", "mm-tonne-s")
    assert np.allclose(found.nodes, hexagon.nodes, rtol=0, atol=1e-9)
    assert found.moments.m == pytest.approx(hexagon.moments.m, rel=1e-9)
    assert np.allclose(found.shapes, hexagon.shapes, rtol=0, atol=1e-6 * np.max(hexagon.shapes))
    assert np.allclose(found.rotations, hexagon.rotations, rtol=0, atol=1e-6 * np.max(hexagon.rotations))


def in_millimetres(line: str) -> str:
    fields = [line[k : k + 8] for k in range(0, len(line), 8)]
    places = (f"{1e3 * float(field):8.4f}"[:8] for field in fields[3:6])
    return "".join(fields[:3]) + "".join(places)


def scaled(op2: bytes, factor: float, turned: float = 1e-3) -> bytes:
    """All displacements times a factor, rotations times factor × turned."""

    def change(rows: np.ndarray) -> None:
        rows[:, 2:5] *= np.float32(factor)
        rows[:, 5:8] *= np.float32(factor * turned)

    return changed(op2, change)


def changed(op2: bytes, change) -> bytes:
    """An OP2 file whose records of 217 nodes, as rows of eight reals, `change` has edited in place."""
    out, source = BytesIO(), BytesIO(op2)
    while head := source.read(4):
        (length,) = struct.unpack("<i", head)
        data = source.read(length)
        if length == 217 * 32:
            rows = np.frombuffer(data, "<f4").reshape(217, 8).copy()
            change(rows)
            data = rows.tobytes()
        out.write(head + data + source.read(4))
    return out.getvalue()


def test_max_normalised_modes_make_the_same_platform(tmp_path, hexagon):
    """Each mode scaled to a largest component of one, as EIGRL with NORM = MAX does."""

    def to_one(rows: np.ndarray) -> None:
        rows[:, 2:8] /= np.max(np.abs(rows[:, 2:8]))

    (tmp_path / "max.op2").write_bytes(changed(OP2.read_bytes(), to_one))
    found = read(tmp_path / "max.op2")
    assert "MAX" in found.report.normalised
    sign = np.sign(np.sum(found.shapes * hexagon.shapes, axis=(1, 2)))
    assert np.allclose(sign[:, None, None] * found.shapes, hexagon.shapes, rtol=0, atol=1e-6)


def test_the_mass_matrix_that_fits_is_taken(tmp_path, hexagon):
    """PARAM,COUPMASS,1 beside modes of the lumped mass: said, and the platform is the same."""
    text = BULK.read_text().replace("PARAM   POST    -1", "PARAM   COUPMASS1")
    (tmp_path / "coupled.bdf").write_text(text)
    found = read(bulk=tmp_path / "coupled.bdf")
    assert found.report.mass_kind == "lumped"
    assert any("ask for the consistent mass" in note for note in found.notes)
    assert np.array_equal(found.shapes, hexagon.shapes)


def test_point_mass_with_inertia(tmp_path):
    """A CONM2 of 2 kg with an inertia, off grid 1, adds its own mass, moment and inertia."""
    card = "CONM2,900,1,0,2.0,0.1,0.0,0.05\n,0.03,0.001,0.04,0.0,0.0,0.05\nENDDATA"
    (tmp_path / "loaded.bdf").write_text(BULK.read_text().replace("ENDDATA", card))
    bare, loaded = (read_bulk(path, SYSTEMS["SI"]) for path in (BULK, tmp_path / "loaded.bdf"))
    weight = [model.masses["lumped"].diagonal() for model in (bare, loaded)]
    assert weight[1].sum() - weight[0].sum() == pytest.approx(2.0, rel=1e-12)
    cloud, masses = loaded.nodes[217:], weight[1][217:]
    assert masses @ cloud / 2.0 == pytest.approx(np.array([0.1, 0.0, 0.05]), abs=1e-12)
    arms = cloud - [0.1, 0.0, 0.05]
    inertia = sum(m * (a @ a * np.eye(3) - np.outer(a, a)) for m, a in zip(masses, arms, strict=True))
    expected = [[0.03, -0.001, 0], [-0.001, 0.04, 0], [0, 0, 0.05]]
    assert np.allclose(inertia, expected, rtol=0, atol=1e-12)


@needs_cases
def test_plate_of_nx_nastran():
    """Inches; the elastic frequencies of the case's own account, ΦᵀMΦ of the bulk data's lumped mass."""
    found = read(Path(CASES) / "plate_py.op2", Path(CASES) / "plate_py.dat", "in-lbf")
    assert found.frequencies == pytest.approx([39791.5, 47095.4, 102029.2, 107829.0], abs=0.06)
    assert found.report.orthonormality <= 1e-7
    assert max(found.report.S, found.report.beta) <= 1e-7
    # ρ · 2 in · 1 in · 0.125 in, ρ = 0.00073315 lbf s²/in⁴
    assert found.moments.m == pytest.approx(0.00073315 * 0.25 * POUND_FORCE / INCH, rel=1e-6)
    assert np.ptp(found.nodes, axis=0) == pytest.approx([2 * INCH, INCH, 0], abs=1e-12)


@needs_cases
def test_clamped_beam_is_no_free_platform():
    with pytest.raises(pf.InputError, match="held, not free: node 1 moves in no mode"):
        read(Path(CASES) / "beam_modes_m2.op2", None, "in-lbf")


@needs_cases
def test_swapped_files_of_two_models():
    plate = Path(CASES) / "plate_py.op2", Path(CASES) / "plate_py.dat"
    with pytest.raises(pf.InputError, match="231 nodes, bulk has 217 grids"):
        read(plate[0], BULK)
    with pytest.raises(pf.InputError, match="217 nodes, bulk has 231 grids"):
        read(OP2, plate[1], "in-lbf")


@pytest.mark.parametrize("units", sorted(set(SYSTEMS) - {"SI"}))
def test_wrong_units_are_no_material(units):
    with pytest.raises(pf.InputError, match='nothing has; did you mean "SI"?'):
        read(units=units)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda text: text.replace(".015    ", ".016    "), "computed with 73.071 kg"),
        (lambda text: text.replace("PARAM   POST    -1", "PARAM   WTMASS  .5"), "WTMASS"),
        (lambda text: text.replace("ENDDATA", "CBEAM   999     1       1       2\nENDDATA"), "CBEAM cards"),
        (lambda text: text.replace("ENDDATA", "SECONCT 1       2\nENDDATA"), "superelements"),
        (lambda text: text.replace(".0625000.0000000", ".0725000.0000000"), "kg at|leaves the rigid body"),
        (lambda text: "\n".join(text.splitlines()[:100]), "no ENDDATA"),
        (lambda text: text.replace("PSHELL  1 ", "PSHELL  2 "), "property 1, which is not there"),
    ],
)  # fmt: skip
def test_bulk_data_of_another_model(tmp_path, change, words):
    (tmp_path / "other.bdf").write_text(change(BULK.read_text()))
    with pytest.raises(pf.InputError, match=words):
        read(bulk=tmp_path / "other.bdf")


def test_missing_pieces():
    with pytest.raises(pf.InputError, match="bulk is not given"):
        read(bulk=None)
    with pytest.raises(pf.InputError, match="units is not given"):
        read(units="")
    with pytest.raises(pf.InputError, match="No such file"):
        read(op2=DATA / "absent.op2")
    with pytest.raises(pf.InputError, match="no OUTPUT2 file"):
        read(op2=BULK)
    with pytest.raises(pf.InputError, match="has no GRID cards"):
        read(bulk=OP2)


def test_truncated_op2(tmp_path):
    (tmp_path / "half.op2").write_bytes(OP2.read_bytes()[:100_000])
    with pytest.raises(pf.InputError, match="cut short at byte"):
        read(tmp_path / "half.op2")


FRAME = {  # axes of output components at a place, as rows, for CORD2 cards with B on the z axis
    "CORD2R": lambda x, y: [[np.sqrt(0.75), 0.5, 0], [-0.5, np.sqrt(0.75), 0], [0, 0, 1]],
    "CORD2C": lambda x, y: radial(np.arctan2(y, x)),
}


def radial(angle: float) -> list[list[float]]:
    return [[np.cos(angle), np.sin(angle), 0], [-np.sin(angle), np.cos(angle), 0], [0, 0, 1]]


@pytest.mark.parametrize("kind", FRAME)
def test_output_coordinate_systems(tmp_path, hexagon, kind):
    """Displacements in turned or radial components, as a CD field makes them, are turned back.

    The origin of the radial system is off the plate, where its axes are defined.
    """
    origin = (0.0, 0.0) if kind == "CORD2R" else (-0.7, 0.1)
    points = [*origin, 0.0], [*origin, 1.0], [origin[0] + np.cos(np.pi / 6), origin[1] + 0.5, 0.0]
    if kind == "CORD2C":
        points[2][:] = [origin[0] + 1.0, origin[1], 0.0]
    numbers = ",".join(f"{value:.12g}" for point in points for value in point[:3])
    first, rest = ",".join(numbers.split(",")[:6]), ",".join(numbers.split(",")[6:])
    lines = [
        f"{line.ljust(48)}1" if line.startswith("GRID") else line for line in BULK.read_text().splitlines()
    ]
    text = "\n".join(lines).replace("ENDDATA", f"{kind},1,0,{first}\n,{rest}\nENDDATA")
    (tmp_path / "turned.bdf").write_text(text)
    places = hexagon.nodes - [*origin, 0.0]
    turn = np.array([FRAME[kind](x, y) for x, y, _ in places])

    def change(rows: np.ndarray) -> None:
        for part in (slice(2, 5), slice(5, 8)):
            rows[:, part] = np.einsum("kab,kb->ka", turn, rows[:, part].astype(float))

    (tmp_path / "turned.op2").write_bytes(changed(OP2.read_bytes(), change))
    found = read(tmp_path / "turned.op2", tmp_path / "turned.bdf")
    assert np.allclose(found.shapes, hexagon.shapes, rtol=0, atol=1e-6 * np.max(np.abs(hexagon.shapes)))
    assert np.allclose(
        found.rotations, hexagon.rotations, rtol=0, atol=1e-6 * np.max(np.abs(hexagon.rotations))
    )


CUBE = "\n".join(
    f"GRID,{1 + k},,{x}.,{y}.,{z}." for k, (x, y, z) in enumerate(
        [(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0), (0, 0, 3), (2, 0, 3), (2, 1, 3), (0, 1, 3)])
)  # fmt: skip
MATERIALS = "MAT1,1,7.+10,,.3,2700.\nMAT8,2,1.+11,1.+10,.3,5.+9,,,1600."
WEIGHTS = {  # cards, and what they weigh in kg: 2700 and 1600 kg/m³, faces of 2 × 1, edges of 2 m
    "solid": ("CHEXA,1,1,1,2,3,4,5,6\n,7,8\nPSOLID,1,1", 2700 * 6),
    "prism": ("CPENTA,1,1,1,2,3,5,6,7\nPSOLID,1,1", 2700 * 3),
    "tetra": ("CTETRA,1,1,1,2,3,5\nPSOLID,1,1", 2700 * 1),
    "shell": ("CQUAD4,1,1,1,2,3,4\nPSHELL,1,1,.1,1,,1,,4.5", 2 * (270 + 4.5)),
    "triangle": ("CTRIA3,1,1,1,2,3\nPSHELL,1,1,.1", 270),
    "laminate": ("CQUAD4,1,1,1,2,3,4\nPCOMP,1,,1.5\n,2,.01,0.,YES,,,90.\n,1,.02", 2 * (1.5 + 32 + 54)),
    "symmetric": ("CQUAD4,1,1,1,2,3,4\nPCOMP,1,,,,,,,SYM\n,2,.01,0.,YES,1,.02", 2 * 2 * (16 + 54)),
    "bar": ("CBAR,1,1,1,2,0.,1.,0.\nPBAR,1,1,.01,1.-4,1.-4,1.-4,.7", 2 * (27 + 0.7)),
    "rod": ("CROD,1,1,1,2\nPROD,1,1,.01,1.-4,0.,.7", 2 * (27 + 0.7)),
    "conrod": ("CONROD,1,1,2,1,.01,1.-4,0.,.7", 2 * (27 + 0.7)),
    "point": ("CONM2,1,3,,8.5", 8.5),
    "pounds": ("CONM2,1,3,,8.5\nPARAM,WTMASS,.5", 4.25),
}  # fmt: skip


@pytest.mark.parametrize("name", WEIGHTS)
def test_what_elements_weigh(tmp_path, name):
    cards, weight = WEIGHTS[name]
    path = tmp_path / "model.bdf"
    path.write_text("\n".join(["BEGIN BULK", CUBE, MATERIALS, cards, "ENDDATA"]))
    for mass in read_bulk(path, SYSTEMS["SI"]).masses.values():
        assert mass.sum() == pytest.approx(weight, rel=1e-12)
