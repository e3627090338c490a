"""Robot files: to the bit there and back, units, and complaints with their lines."""

import json
import re
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from scipy.spatial.transform import Rotation

import parflex as pf
from bits import bits, leaves
from measures import relative
from paper_robot import links
from parflex.app.json_schema import ALL_SCHEMAS
from parflex.fe.modal_file import FIELDS, MOMENTS, save_body
from parflex.files.lines import line_of
from places import DOCS

GOOD = """\
format = "parflex-robot-1"
gravity = [0, 0, -9.81]

[home]
position = [0, 0, "600 mm"]

[chain.ups]
joints = [  # base to tip
  {type = "revolute", alpha = "-90 deg"},
  # the cylinder
  {type = "revolute", alpha = "90 deg", mass = "6 kg", com = [0, "-200 mm", 0],
   inertia = [0.4, 0.01, 0.4, 0, 0, 0]},
  {type = "prismatic", actuated = true, alpha = "90 deg", mass = 3, min = "0.3 m", rotor_inertia = 20},
]
tips = [{frame = 3, offset = [0, 0, 0.1]}]

[[leg]]
chain = "ups"
origin = [0.5, 0, 0]
attachments = [0]

[[leg]]
chain = "ups"
origin = [-0.5, 0, 0]
rotation = [0, 0, "180 deg"]
attachments = [1]

[platform]
kind = "rigid"
mass = 4.0
inertia = [0.1, 0.1, 0.2, 0, 0, 0]
attachments = [
  [0.3, 0, 0],
  [-0.3, 0, 0],
]
"""
# TOML wants an inline table on one line
GOOD = GOOD.replace("0],\n   inertia", "0], inertia")


def written(folder: Path, text: str) -> Path:
    path = folder / "robot.toml"
    path.write_text(text, encoding="utf-8")
    return path


def changed(*changes: tuple[str, str]) -> str:
    """The good file with words replaced, each of which it has."""
    text = GOOD
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    return text


def random_robot(platform: pf.FlexibleBody) -> pf.Robot:
    """Legs alike and different, every field of theirs in use."""
    rng = np.random.default_rng(7)
    legs = []
    for i in range(len(platform.attachments)):
        first, second, third = links()
        extra = {"Fv": rng.random(), "Fs": rng.random(), "v_s": rng.random(), "k": 3.0, "q_0": rng.random()}
        inertia = rng.random((3, 3))
        third = replace(third, q_min=-rng.random(), I=inertia + inertia.T, **extra)
        second = replace(second, q_max=np.pi, gamma=-0.0)
        rotation = Rotation.random(rng=rng).as_matrix()
        joints = (first, second, third) if i % 2 else links()
        posture = rng.random(3) if i % 3 else None
        tip = pf.Tip(3, (-0.0, 0.0, rng.random()), attachment=i)
        legs.append(pf.Leg(rotation, rng.random(3), joints, (tip,), posture))
    home = (rng.random(3), Rotation.random(rng=rng).as_matrix())
    return pf.Robot(tuple(legs), platform, gravity=rng.random(3), home_pose=home)


def rigid_platform() -> pf.FlexibleBody:
    points = np.random.default_rng(3).random((4, 3))
    return pf.FlexibleBody.rigid(1 / 3, points[0], np.diag([0.1, 0.2, 0.25]), points)


def nodal_platform() -> pf.FlexibleBody:
    """Without rotation shapes, triangles or symmetry."""
    rng = np.random.default_rng(5)
    positions, masses = rng.random((5, 3)), rng.random(5)
    shapes = np.linalg.qr((rng.random((2, 5, 3)) * np.sqrt(masses)[:, None]).reshape(2, 15).T)[0].T
    shapes = shapes.reshape(2, 5, 3) / np.sqrt(masses)[:, None]
    return pf.FlexibleBody.from_nodes(positions, masses, shapes, [10.0, 20.0], 0.1, [0, 3, 3])


PLATFORMS = {
    "rigid": rigid_platform,
    "held by none": lambda: pf.FlexibleBody.rigid(2.0, (0, 0, 0.1), np.eye(3), np.zeros((0, 3))),
    "nodes": nodal_platform,
    "plate": lambda: pf.robots.gough_stewart(3).platform,
    "rigid plate": lambda: pf.robots.gough_stewart(0).platform,
}


@pytest.mark.parametrize("name", PLATFORMS)
def test_there_and_back_to_the_bit(name, tmp_path):
    robot = random_robot(PLATFORMS[name]())
    path = robot.to_file(tmp_path / "new" / "robot.toml")
    again = pf.load_robot(path)
    assert bits(again) == bits(robot)
    assert again.to_file(tmp_path / "twice.toml").read_text().replace("twice", "robot") == path.read_text()
    assert (path.parent / "robot.platform.nc").exists() == (name not in ("rigid", "held by none"))


def test_legs_of_one_kind_are_told_once(tmp_path):
    tables = tomllib.loads(pf.robots.gough_stewart(0).to_file(tmp_path / "r.toml").read_text())
    assert len(tables["leg"]) == 6
    assert list(tables["chain"]) == ["rrp-1"]


def test_what_cannot_be_written_leaves_what_was_there(tmp_path):
    (tmp_path / "robot.toml").mkdir()
    with pytest.raises(pf.InputError, match="was not written"):
        random_robot(rigid_platform()).to_file(tmp_path / "robot.toml")
    assert [path.name for path in tmp_path.iterdir()] == ["robot.toml"]


def test_units_and_defaults(tmp_path):
    """The file against the same robot in SI units, written in Python."""
    robot = pf.load_robot(written(tmp_path, GOOD))
    quarter = np.pi / 2
    cylinder = {"M": 6.0, "MS": (0, -1.2, 0), "I": np.diag([0.4, 0.01, 0.4])}
    joints = (
        pf.Joint(0, 0, alpha=-quarter),
        pf.Joint(1, 0, alpha=quarter, **cylinder),
        pf.Joint(2, 1, mu=1, alpha=quarter, M=3, IA=20, q_min=0.3),
    )
    turn = np.diag([-1.0, -1.0, 1.0])
    legs = [
        pf.Leg(rotation, origin, joints, (pf.Tip(3, (0, 0, 0.1), i),))
        for i, (rotation, origin) in enumerate([(np.eye(3), (0.5, 0, 0)), (turn, (-0.5, 0, 0))])
    ]
    body = pf.FlexibleBody.rigid(4.0, (0, 0, 0), np.diag([0.1, 0.1, 0.2]), [[0.3, 0, 0], [-0.3, 0, 0]])
    expected = pf.Robot(tuple(legs), body, home_pose=((0, 0, 0.6), np.eye(3)))
    mine, theirs = leaves(robot), leaves(expected)
    assert mine.keys() == theirs.keys()
    for name, (found, wanted) in ((name, (mine[name], theirs[name])) for name in mine):
        finite = np.isfinite(wanted)
        assert relative(found[finite], wanted[finite]) < 1e-14, name  # the round-off of a unit's factor


def test_polygon_platform(tmp_path):
    """A plate from its table is the plate of the library."""
    table = """[platform]
kind = "polygon"
corners = [[0, 0], ["600 mm", 0], [0.6, 0.4], [0, 0.4]]
thickness = "10 mm"
young = "70 GPa"
poisson = 0.33
density = "2.7 g/cm^3"
modes = 2
damping_ratio = [0.01, 0.02]
origin = [0.1, 0.1, 0]
"""
    path = written(tmp_path, GOOD[: GOOD.index("[platform]")] + table)
    body = pf.load_robot(path).platform
    modes = pf.fe.plate_modes([(0, 0), (0.6, 0), (0.6, 0.4), (0, 0.4)], 0.01, 70e9, 0.33, 2700, 2)
    expected = pf.FlexibleBody.from_modes(modes, origin=(0.1, 0.1, 0), damping_ratio=[0.01, 0.02])
    assert relative(body.stiffness, expected.stiffness) < 1e-9
    assert relative(body.moments.MS0, expected.moments.MS0) < 1e-12
    assert body.attachments == (1, 2, 3, 4)


def test_plate_without_modes_gets_the_right_basis(tmp_path):
    """No number of modes: free–free and attachment modes, right to 1 %."""
    table = """[platform]
kind = "polygon"
corners = [[0, 0], [0.6, 0], [0.6, 0.4], [0, 0.4]]
thickness = 0.01
young = 70e9
poisson = 0.33
density = 2700
"""
    body = pf.load_robot(written(tmp_path, GOOD[: GOOD.index("[platform]")] + table)).platform
    plate = pf.fe.plate_body([(0, 0), (0.6, 0), (0.6, 0.4), (0, 0.4)], 0.01, 70e9, 0.33, 2700)
    found = pf.fe.modes(plate)
    assert found.error.within(0.01)
    assert relative(body.stiffness, found.frequencies**2) < 1e-9


EIGENSOLVER = 1e-7  # modes of corners that differ by round-off, pairs turned by as much


def test_template_is_the_robot_of_the_paper(parflex):
    """Written by hand with units, against the tables of Section 6."""
    assert parflex("init")[0] == 0
    mine, paper = pf.load_robot("robot.toml"), pf.robots.gough_stewart(7)
    models = [pf.Model(robot, "numpy") for robot in (mine, paper)]
    (bent, forces), (sagging, expected) = (model.equilibrium(*paper.home_pose) for model in models)
    assert relative(forces, expected) < 1e-9
    found, wanted = models[0].direct(bent, 1.1 * forces), models[1].direct(sagging, 1.1 * expected)
    assert relative(found.platform, wanted.platform) < EIGENSOLVER


LOOP = ('actuated = true, alpha = "90 deg"', "actuated = true, antecedent = 3")
BAD = {
    "a loop": ([LOOP], 12, "antecedent 3; it must be a lower joint number"),
    "a joint without an axis": (
        [('type = "revolute", alpha = "90 deg"', 'alpha = "90 deg"')],
        11,
        'chain.ups.joints[1] is a joint without an axis; give type = "prismatic" or "revolute"',
    ),
    "a joint of another kind": (
        [('type = "prismatic"', 'type = "screw"')],
        12,
        'chain.ups.joints[2].type is "screw"; choose "prismatic" or "revolute"',
    ),
    "a tip on no link": (
        [("frame = 3", "frame = 4")],
        14,
        "chain.ups.tips[0].frame is 4; this leg has links 1 … 3",
    ),
    "a tip on no platform node": (
        [("attachments = [1]", "attachments = [7]")],
        25,
        "legs[1] holds attachment 7, but the platform has 2 (0 … 1)",
    ),
    "an attachment held twice": ([("[1]", "[0]")], 25, "legs[1] and legs[0] both hold attachment 0"),
    "two attachments for a tip": ([("[1]", "[1, 0]")], 25, "has 2 entries, but chain ups has 1 tips"),
    "a mass for a length": (
        [("[-0.5, 0, 0]", '["-500 g", 0, 0]')],
        23,
        'leg[1].origin[0] is "-500 g", which is not a length; expected a length in m, such as 0.3',
    ),
    "no unit": ([('"600 mm"', '"600"')], 5, 'home.position[2] is "600"; expected a length in m'),
    "an unknown unit": ([("600 mm", "600 smoot")], 5, '"smoot" is no unit'),
    "hertz": ([("mass = 3", 'coulomb_rate = "3 Hz"')], 12, "which leaves open what is counted"),
    "percent for an angle": ([("180 deg", "180 percent")], 24, "which is not an angle"),
    "degrees without a unit": ([('"180 deg"', "180")], 24, 'write degrees as "30 deg"'),
    "cut off": ([(GOOD[-9:], "")], 33, "not TOML: invalid value before the file ends"),
    "a value missing": ([("mass = 4.0", "mass =")], 29, "not TOML: invalid value"),
    "an unknown key": ([("origin = [0.5", "orgin = [0.5")], 18, "orgin is not known; did you mean origin?"),
    "a key like no other": ([("mass = 4.0", "mass = 4.0\nzzz = 1")], 30, "known here: kind, mass, com"),
    "not a number": ([("[0, 0, -9.81]", "[0, nan, -9.81]")], 2, "gravity[1] is nan"),
    "without bound": ([("0.1, 0.1, 0.2", "inf, 0.1, 0.2")], 30, "platform.inertia[0] is inf"),
    "a missing field": ([("origin = [0.5, 0, 0]\n", "")], 16, "leg[0].origin is missing; give the leg's"),
    "no platform": ([(GOOD[GOOD.index("[platform]") :], "")], 1, "platform is missing; give the table"),
    "another format": ([("robot-1", "robot-2")], 1, "format is \"parflex-robot-2\"; expected 'parflex-rob"),
    "an unknown chain": ([('chain = "ups"', 'chain = "upps"')], 17, 'did you mean "ups"?'),
    "two numbers for a point": ([("[0.3, 0, 0]", "[0.3, 0]")], 32, "attachments[0] has 2 entries; give at"),
    "a negative mass": ([("mass = 3", 'mass = "-3 kg"')], 12, 'mass is "-3 kg"; it cannot be negative'),
    "two centres": ([("com =", "first_moment = [0, 0, 0], com =")], 11, "gives com and first_moment"),
    "no body's inertia": ([("0.1, 0.1, 0.2", "0.1, 0.1, 0.9")], 30, "is not the inertia of a body"),
    "true for a number": ([("position = [0,", "position = [true,")], 5, "home.position[0] is true"),
    "text for a table": ([('kind = "rigid"', 'kind = "soft"')], 28, 'kind is "soft"; choose "disc" or'),
    "a posture of two": (
        [("tips =", "posture = [0, 1]\ntips =")],
        14,
        "posture has 2 entries; give one for each of the 3 joints",
    ),
    "a posture in wrong units": (
        [("tips =", 'posture = [0, "1 deg", "2 deg"]\ntips =')],
        14,
        'chain.ups.posture[2] is "2 deg", which is not a length',
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_complaints_name_line_field_and_value(name, tmp_path):
    changes, line, words = BAD[name]
    with pytest.raises(pf.InputError) as caught:
        pf.load_robot(written(tmp_path, changed(*changes)))
    told = str(caught.value)
    assert told.startswith(f"robot.toml:{line}: "), told
    assert words in told
    assert "\n" not in told


def test_all_complaints_come_together(tmp_path):
    text = changed(("[0.5, 0, 0]", '["1 kg", 0, 0]'), ("[1]", '["one"]'), ("mass = 4.0", "mass = 0"))
    with pytest.raises(pf.InputError) as caught:
        pf.load_robot(written(tmp_path, text))
    assert [line.split(":")[1] for line in str(caught.value).splitlines()] == ["18", "25", "29"]


def test_no_more_than_five(tmp_path):
    with pytest.raises(pf.InputError) as caught:
        pf.load_robot(written(tmp_path, GOOD.replace(" 0,", ' "x",')))
    assert len(str(caught.value).splitlines()) == 6
    assert str(caught.value).endswith("more")


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [("away.toml", None, "there is no such file"), ("latin.toml", b"name = '\xe9'", "is no text in UTF-8")],
)
def test_unreadable_files(tmp_path, name, content, words):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(pf.InputError, match=words):
        pf.load_robot(tmp_path / name)


def test_platform_files_that_fail(tmp_path):
    head = GOOD[: GOOD.index("[platform]")] + '[platform]\nkind = "modal"\nfile = "p.nc"\n'
    path = written(tmp_path, head)
    with pytest.raises(pf.InputError, match=r"robot.toml:29: platform.file is p.nc, but .* does not exist"):
        pf.load_robot(path)
    (tmp_path / "p.nc").write_bytes(b"no file of ours")
    with pytest.raises(pf.InputError, match=r"robot.toml:29: platform.file is p.nc, which is damaged"):
        pf.load_robot(path)
    save_body(pf.robots.rps3(2).platform, tmp_path / "whole.nc")
    whole = xr.load_dataset(tmp_path / "whole.nc", engine="h5netcdf")
    for name in (MOMENTS | FIELDS).keys() & set(whole.variables):
        whole.drop_vars(name).to_netcdf(tmp_path / "p.nc", engine="h5netcdf")
        optional = name in ("rotation_shapes", "triangles", "band", "missed")
        words = "was altered" if optional else f"lacks {name};"
        with pytest.raises(pf.InputError, match=f"robot.toml:29: platform.file is p.nc, which {words}"):
            pf.load_robot(path)


def test_expected_mobility(parflex, tmp_path):
    """The template's six freedoms, against an expectation of three, and without motors."""
    assert parflex("init")[0] == 0
    path = tmp_path / "robot.toml"
    text = path.read_text(encoding="utf-8")
    assert pf.load_robot(path).legs
    number = 1 + text[: text.index("mobility = 6")].count("\n")
    with pytest.raises(
        pf.InputError, match=rf"robot.toml:{number}: mobility: you expect 3, but .* 6 freedoms"
    ):
        pf.load_robot(written(tmp_path, text.replace("mobility = 6", "mobility = 3")))
    with pytest.raises(pf.InputError, match=rf":{number}: .* 6 freedoms at home, but only 0 joints"):
        pf.load_robot(written(tmp_path, text.replace("actuated = true", "actuated = false")))


LINES = '''# a comment
numbers = [1,
  2]

[table]
text = """
[not.a.table]
"""
rows = [
  {a = 1},
  # another
  {a = 2}]
deep.key = 1
[[list]]
[[list]]
a = 1
'''


@pytest.mark.parametrize(
    ("where", "line"),
    [
        ((), 1),
        (("numbers",), 2),
        (("numbers", 1), 3),
        (("table", "text"), 6),
        (("table", "rows", 0, "a"), 10),
        (("table", "rows", 1, "left out", "a"), 12),
        (("table", "deep", "key"), 13),
        (("list", 0, "missing"), 14),
        (("list", 1), 15),
        (("list", 1, "a"), 16),
    ],
)
def test_lines_of_values(where, line):
    assert line_of(LINES, where) == line


@pytest.mark.parametrize("name", ["robot", "trajectory"])
def test_schemas_of_the_documentation_are_up_to_date(name):
    stored = DOCS / f"{name}.schema.json"
    assert json.loads(stored.read_text(encoding="utf-8")) == ALL_SCHEMAS[name]()


@pytest.mark.parametrize("name", ["robot", "trajectory"])
def test_every_field_is_described(name):
    schema = ALL_SCHEMAS[name]()
    page = (DOCS / "robot-files.md").read_text(encoding="utf-8")
    for table in (schema, *schema["$defs"].values()):
        for field in table.get("properties", {}):
            assert re.search(rf"`\[*{field}[\].`]", page), field
