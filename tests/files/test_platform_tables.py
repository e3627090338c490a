"""Platforms that a robot file names in a line: those made in Python."""

import numpy as np
import pytest

import parflex as pf
from parflex.files.platform_schema import ModalTable, SolidTable
from parflex.files.platform_tables import platform
from parflex.files.reading import Reader
from parflex.files.robot_schema import robot_table
from solid_plates import JOINTS, modes


def test_robot_file_names_modes_in_one_line(tmp_path):
    """The platform of a robot file is that of the modes."""
    file = pf.fe.write_modes(modes(), tmp_path / "plate.h5", damping_ratio=0.03)
    body = platform(ModalTable(kind="modal", file=file.name), file.parent)
    expected = pf.FlexibleBody.from_modes(modes(), damping_ratio=0.03)
    assert np.array_equal(body.stiffness, expected.stiffness)
    assert np.array_equal(body.damping, expected.damping)
    assert np.allclose(body.attachment_points, JOINTS, atol=1e-12)


def test_robot_file_names_a_step_file(tmp_path):
    """A solid platform in one line of a robot file is the one made in Python."""
    occ = pytest.importorskip("netgen.occ")
    occ.Box((0, 0, 0), (600, 400, 30)).WriteStep(str(tmp_path / "plate.step"))
    points = [(0.05, 0.05, 0.0), (0.55, 0.05, 0.0), (0.3, 0.35, 0.0)]
    line = {"file": "plate.step", "size": "120 mm", "young": "70 GPa", "poisson": 0.3, "density": 2700.0}
    table = SolidTable(kind="solid", attachments=points, radius=0.06, modes=3, **line)
    body = platform(table, tmp_path)
    mesh = pf.fe.step_mesh(tmp_path / "plate.step", size=0.12)
    solid = pf.fe.solid_body(mesh, pf.fe.Material(7e10, 0.3, 2700.0))
    expected = pf.fe.FreeFreeWithAttachment(3, points, radius=0.06).modes(solid)
    assert np.allclose(body.stiffness, expected.frequencies**2)
    assert np.allclose(body.attachment_points, np.array(points) - [0.3, 0.2, 0.015], atol=1e-9)


ROBOT = """format = "parflex-robot-1"
home = { position = [0, 0, 0.3] }
leg = []
[platform]
"""
POLYGON = """kind = "polygon"
corners = [[0, 0], [0.6, 0], [0.6, 0.4], [0, 0.4]]
thickness = "10 mm"
material = "aluminium"
modes = 3
"""
DISC = """kind = "disc"
diameter = "340 mm"
bore = "60 mm"
thickness = "20 mm"
material = "steel"
attachments = [["150 mm", 0, "-10 mm"], ["-75 mm", "130 mm", "-10 mm"], ["-75 mm", "-130 mm", "-10 mm"]]
radius = "30 mm"
size = "40 mm"
modes = 3
"""


def loaded(text, folder):
    """The platform of a robot file, which itself is not made: it has no legs."""
    (folder / "robot.toml").write_text(ROBOT + text)
    reader = Reader(folder / "robot.toml")
    table = reader.table(robot_table())
    found = reader.must(("platform",), platform, table.platform, folder)
    reader.warn()
    return found


def test_a_material_by_name_is_its_numbers(tmp_path):
    numbers = POLYGON.replace('material = "aluminium"', 'young = "70 GPa"\npoisson = 0.33\ndensity = 2700')
    named, given = (loaded(text, tmp_path) for text in (POLYGON, numbers))
    assert np.array_equal(named.frequencies, given.frequencies)


def test_attachments_may_be_anywhere_on_a_plate(tmp_path):
    places = [[0.1, 0.1], [0.5, 0.1], [0.3, 0.4]]
    for text in (POLYGON, POLYGON.replace("modes = 3\n", "")):
        body = loaded(text + f"attachments = {places}\norigin = [0, 0, 0]\n", tmp_path)
        assert np.allclose(body.attachment_points[:, :2], places, atol=1e-9)


def test_a_ring_is_the_one_made_in_python(tmp_path):
    pytest.importorskip("netgen.occ")
    body = loaded(DISC, tmp_path)
    points = [(0.15, 0, -0.01), (-0.075, 0.13, -0.01), (-0.075, -0.13, -0.01)]
    mesh = pf.fe.outline_mesh((0, 0, 0.17), 0.02, holes=[(0, 0, 0.03)], size=0.04)
    made = pf.fe.modes(pf.fe.solid_body(mesh, "steel"), points, radius=0.03, n=3)
    assert np.allclose(body.frequencies, made.frequencies)
    assert np.allclose(body.attachment_points, points, atol=1e-9)


@pytest.mark.parametrize(
    ("change", "line", "words"),
    [
        (('"aluminium"', '"alumnium"'), 8, "platform.material is 'alumnium', which is not known; did you"),
        (('material = "aluminium"', ""), 4, "platform: material is not given; name one of aluminium, steel"),
        (('material = "aluminium"', "young = 7e10"), 4, "platform: poisson is not given, but young is"),
        (("modes = 3", "density = 2700"), 9, "platform.density is given, and material too"),
        (("modes = 3", "attachments = [[0.1, 0.1], [0.7, 0.1]]"), 9,
         "platform.attachments[1] at (0.7, 0.1, 0) is off the plate, 0.1 m from its edge"),
    ],
)  # fmt: skip
def test_what_is_wrong_has_its_line(tmp_path, change, line, words):
    with pytest.raises(pf.InputError) as told:
        loaded(POLYGON.replace(*change), tmp_path)
    assert str(told.value).startswith(f"robot.toml:{line}: {words}")


def test_absurd_values_are_warned_of_with_their_line(tmp_path):
    with pytest.warns(pf.ImplausibleValue) as told:
        loaded(POLYGON.replace('"10 mm"', "10"), tmp_path)
    expected = 'robot.toml:7: platform.thickness is 10 m on a plate of 0.6 m; did you mean "10 mm"?'
    assert [str(each.message) for each in told] == [expected]


def test_a_disc_without_attachments_is_told(tmp_path):
    lines = [line for line in DISC.splitlines() if not line.startswith("attachments")]
    with pytest.raises(pf.InputError, match="attachments is missing; give the points that legs may hold"):
        loaded("\n".join(lines), tmp_path)


HEXAPOD = """format = "parflex-robot-1"
[hexapod]
base_radius = "250 mm"
platform_radius = "150 mm"
height = "300 mm"
base_spread = "20 deg"
platform_spread = "20 deg"
[platform]
"""


def test_a_hexapod_holds_a_disc_at_its_joints(tmp_path):
    """The disc stands on the joints: they are on its lower face, in whose plane the platform's frame is."""
    pytest.importorskip("netgen.occ")
    disc = "\n".join(line for line in DISC.splitlines() if not line.startswith(("attachments", "radius")))
    (tmp_path / "robot.toml").write_text(HEXAPOD + disc + '\nradius = "25 mm"\n')
    robot = pf.load_robot(tmp_path / "robot.toml")
    points = robot.platform.attachment_points
    assert np.allclose(np.linalg.norm(points[:, :2], axis=1), 0.15)
    assert np.allclose(points[:, 2], 0, atol=1e-12)
    assert np.isclose(robot.platform.moments.MS0[2] / robot.platform.moments.m, 0.01, rtol=1e-6)
    assert len(robot.legs) == 6
