"""Robot files that say what a builder knows: a hexapod, legs by kind, a payload, the tool and sensors."""

import numpy as np
import pytest

import parflex as pf
from measures import random_states, relative
from parflex.files.robot_file import read_robot
from parflex.robots.hexapod_geometry import HexapodGeometry
from parflex.robots.legs import ALL_LEG_KINDS

HEXAPOD = """\
format = "parflex-robot-1"
name = "hexapod"

[hexapod]
base_radius = "250 mm"
platform_radius = "150 mm"
height = "300 mm"
base_spread = "20 deg"
platform_spread = "20 deg"

[hexapod.strut]
cylinder = { mass = "300 g", com = "120 mm", inertia = [2e-5, 1.1e-3] }
rod = { mass = "200 g", com = "100 mm", inertia = ["10 kg mm^2", 8e-4] }
stroke = ["290 mm", "400 mm"]
stiffness = "20 N/um"
damping = 20

[payload]
mass = "5 kg"
com = ["10 mm", "-20 mm", "60 mm"]
inertia = [0.02, 0.03, 0.04, 0, 0, 0]
"""

ROWS = """\
format = "parflex-robot-1"
home = {{ position = [0, 0, "300 mm"] }}

[chain.strut]
joints = [
  {{ type = "revolute", alpha = "-90 deg" }},
  {{ type = "revolute", alpha = "90 deg", mass = 0.3, com = [0, -0.12, 0],
     inertia = [{a}, 2e-5, {a}, 0, 0, 0] }},
  {{ type = "prismatic", actuated = true, alpha = "90 deg", mass = 0.2, com = [0, 0, -0.1],
     inertia = [{b}, {b}, 1e-5, 0, 0, 0], stiffness = 2e7, rest = {rest!r}, viscous = 20,
     min = 0.29, max = 0.4 }},
]
tips = [{{ frame = 3 }}]
{legs}
[platform]
kind = "rigid"
mass = {mass!r}
first_moment = {first}
second_moment = {second}
attachments = {points}
"""


def rows() -> str:
    """The same hexapod by Denavit–Hartenberg rows, from radii and angles; disc and payload as one body."""
    angle = np.radians([[-10, 10, 110, 130, 230, 250], [-50, 50, 70, 170, 190, 290]])
    x, y = np.array([[0.25], [0.15]]) * [np.cos(angle), np.sin(angle)]
    turns = np.arctan2(y[1] - y[0], x[1] - x[0])
    legs = "".join(
        f'[[leg]]\nchain = "strut"\norigin = [{x[0, i]!r}, {y[0, i]!r}, 0]\nrotation = [0, 0, {turns[i]!r}]\n'
        f"attachments = [{i}]\n"
        for i in range(6)
    )
    disc = 2700 * np.pi * (1.125 * 0.15) ** 2 * 0.15 / 8  # aluminium, as docs/robot-files.md says
    across = disc * (3 * (1.125 * 0.15) ** 2 + (0.15 / 8) ** 2) / 12
    along = disc * (1.125 * 0.15) ** 2 / 2
    com = np.array([0.01, -0.02, 0.06])
    second = np.diag([along / 2, along / 2, across - along / 2]) + 5 * np.outer(com, com)
    second += 0.045 * np.eye(3) - np.diag([0.02, 0.03, 0.04])
    rest = np.sqrt(0.3**2 + 0.25**2 + 0.15**2 - 2 * 0.25 * 0.15 * np.cos(np.radians(40)))
    points = [[float(a), float(b), 0.0] for a, b in zip(x[1], y[1], strict=True)]
    return plain(
        ROWS.replace(",\n     ", ", ").format(
            a=1.1e-3 + 0.3 * 0.12**2,
            b=8e-4 + 0.2 * 0.1**2,
            rest=float(rest),
            legs=legs,
            mass=float(disc + 5),
            first=(5 * com).tolist(),
            second=second.tolist(),
            points=points,
        )
    )


def plain(text: str) -> str:
    """Numbers of NumPy as those of Python."""
    return text.replace("np.float64(", "").replace(")", "")


def loaded(folder, text: str) -> pf.Robot:
    (folder / "robot.toml").write_text(text, encoding="utf-8")
    return pf.load_robot(folder / "robot.toml")


def test_a_hexapod_in_a_few_lines_is_the_same_by_rows(tmp_path):
    """Payload and stiff struts in at most 25 lines; direct and inverse model to 1e-14."""
    assert len(HEXAPOD.splitlines()) <= 25
    mine, theirs = loaded(tmp_path, HEXAPOD), loaded(tmp_path, rows())
    states = random_states(mine, 20, 1)
    position = mine.home.position + 0.2 * (states.position - mine.home.position)
    states = pf.State(position, states.rotation, states.twist)
    models = [pf.Model(robot, "numpy") for robot in (mine, theirs)]
    direct = [model.direct(states, np.full(6, 30.0)).platform for model in models]
    assert relative(*direct) <= 1e-14
    inverse = [model.inverse(states, np.ones(6)).forces for model in models]
    assert relative(*inverse) <= 1e-14


def test_a_plate_is_held_at_the_joints_that_the_hexapod_has(tmp_path):
    """Without attachments of its own; below its plane by the offset, the payload on the nearest node."""
    joints = HexapodGeometry(
        base_radius=0.25, platform_radius=0.15, height=0.3, base_spread=np.pi / 9, platform_spread=np.pi / 9
    ).platform_joints[[1, 2, 3, 4, 5, 0], :2]
    plate = f"""
[platform]
kind = "polygon"
corners = {joints.tolist()}
thickness = "8 mm"
young = "70 GPa"
poisson = 0.33
density = 2700
modes = 3
"""
    text = HEXAPOD.replace("[hexapod.strut]", 'platform_offset = "-20 mm"\n[hexapod.strut]') + plate
    robot = loaded(tmp_path, text)
    assert [leg.tips[0].attachment for leg in robot.legs] == list(range(6))
    held = np.pad(joints[[5, 0, 1, 2, 3, 4]], ((0, 0), (0, 1)), constant_values=-0.02)
    assert np.allclose(robot.platform.attachment_points, held, atol=1e-12)
    assert np.allclose(robot.home_pose[0], (0, 0, 0.32))
    modes = pf.fe.plate_modes(joints, 0.008, 70e9, 0.33, 2700, n_modes=3, points=held[:, :2])
    bare = pf.FlexibleBody.from_modes(modes, origin=(0, 0, 0.02))
    laden = pf.Payload(5.0, (0.01, -0.02, 0.06), np.diag([0.02, 0.03, 0.04])).on(bare)
    for mine, theirs in zip(robot.platform.moments, laden.moments, strict=True):
        assert relative(mine, theirs) < 1e-9  # an eigensolver between


def test_legs_may_share_the_joints_of_a_plate(tmp_path):
    """An ideal hexapod on a plate that names no joints is that whose file names each of the three twice, on
    the plate that Python computes of three."""
    corners = [[0.2, 0.2], [-0.25, 0.2], [-0.25, -0.2], [0.2, -0.2]]
    at = np.radians([-60, 60, 180])
    places = (0.15 * np.stack([np.cos(at), np.sin(at)], axis=-1)).tolist()
    named = [places[k] for k in (0, 1, 1, 2, 2, 0)]
    plate = f"""
[platform]
kind = "polygon"
corners = {corners}
thickness = "12 mm"
material = "steel"
modes = 2
"""
    ideal = (
        HEXAPOD.partition("[payload]")[0].replace('platform_spread = "20 deg"', "platform_spread = 0") + plate
    )
    modes = pf.fe.plate_modes(corners, 0.012, material="steel", points=places, n_modes=2)
    for more in ("", f"attachments = {named}\norigin = [0, 0, 0]"):
        robot = loaded(tmp_path, ideal + more)
        body = robot.platform
        held = body.attachment_points[[leg.tips[0].attachment for leg in robot.legs]]
        assert np.allclose(held[:, :2], named, atol=1e-12)
        assert len(body.attachments) == 6
        assert len(set(body.attachments)) == 3
        assert body.frequencies == pytest.approx(modes.frequencies, rel=1e-9)


def test_rigid_platforms_name_their_joints_without_a_hexapod(tmp_path):
    text = three(JACK).replace("attachments = [[0.3", "# [[0.3")
    with pytest.raises(
        pf.InputError, match=r"robot.toml:11: platform: attachments is missing; give the points"
    ):
        loaded(tmp_path, text)


def test_there_and_back(tmp_path):
    """Written by its joints, payload and all, to the bit."""
    robot = loaded(tmp_path, HEXAPOD)
    again = pf.load_robot(robot.to_file(tmp_path / "rows.toml"))
    assert np.array_equal(again.platform.moments.P0, robot.platform.moments.P0)
    for mine, theirs in zip(again.legs, robot.legs, strict=True):
        assert np.array_equal(mine.rotation, theirs.rotation)
        assert [repr(joint) for joint in mine.joints] == [repr(joint) for joint in theirs.joints]


BAD = {
    "a stroke that home violates": (
        '["290 mm", "400 mm"]', '["290 mm", "340 mm"]', 14,
        "hexapod.strut.stroke is 0.29 … 0.34 m, but at home a strut is 0.3429 m long",
    ),
    "pairs over each other": ('"20 deg"', '"60 deg"', 8, "base_spread and platform_spread are 120 deg"),
    "struts through each other": (
        'base_radius = "250 mm"', 'base_radius = "40 mm"', 11,
        "hexapod.strut: at home the axes of legs 1 and 2 pass within",
    ),
    "no mass": ('mass = "300 g", ', "", 12, "strut.cylinder: mass is missing; give it, or all of"),
    "no radius": ('base_radius = "250 mm"\n', "", 4, "hexapod.base_radius is missing; give the radius"),
    "a misspelling": ("height", "heigth", 7, "hexapod.heigth is not known; did you mean height?"),
    "a length for an angle": ('"20 deg"', '"20 mm"', 8, 'base_spread is "20 mm", which is not an angle'),
    "six inertias": ("[2e-5, 1.1e-3]", "[1, 1, 1, 0, 0, 0]", 12, "cylinder.inertia has 6 entries; give 2"),
    "no body": ("0.04, 0, 0, 0]", "0.9, 0, 0, 0]", 21, "payload.inertia is"),
    "a node there is not": ("com = [", "node = 9\ncom = [", 20, "payload.node is 9; this body"),
    "legs beside": (
        "[payload]", '[[leg]]\nchain = "ups"\norigin = [0, 0, 0]\nattachments = [0]\n[payload]', 18,
        "leg is given beside [hexapod], which makes legs and home",
    ),
    "two places": (
        "[payload]", "[tool]\nposition = [0, 0, 0]\nnode = 1\n[payload]", 18, "tool needs position or node"
    ),
    "a tool on no node": ("[payload]", "[tool]\nnode = 7\n[payload]", 19, "tool.node is 7; the platform has"),
    "a sensor of no kind": (
        "[payload]", '[sensor.a]\ntype = "camera"\n[payload]', 19, 'sensor.a.type is "camera"; choose "acc'
    ),
    "a sensor nowhere": (
        "[payload]", '[sensor.a]\ntype = "accelerometer"\n[payload]', 18, "has no position, and the file no"
    ),
    "a sensor at no leg": (
        "[payload]", '[sensor.a]\ntype = "encoder"\nleg = 6\n[payload]', 20, "sensor.a.leg is 6; there are"
    ),
    "no label": (
        "[payload]", '[sensor."a.b"]\ntype = "encoder"\n[payload]', 18, "the name is 'a.b'; give letters"
    ),
    "no direction": (
        "[payload]", '[sensor.a]\ntype = "displacement"\nnode = 0\ndirection = [0, 0, 0]\n[payload]', 21,
        "sensor.a.direction is [0.0, 0.0, 0.0]; give one",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_complaints_name_line_field_and_value(name, tmp_path):
    old, new, line, words = BAD[name]
    assert old in HEXAPOD
    text = HEXAPOD.replace(old, new) if "deg" in old else HEXAPOD.replace(old, new, 1)
    if name == "struts through each other":
        text = text.replace("com = ", 'outer = "100 mm", com = ', 2)
    with pytest.raises(pf.InputError) as caught:
        loaded(tmp_path, text)
    told = str(caught.value)
    assert told.splitlines()[0].startswith(f"robot.toml:{line}: "), told
    assert words in told


DOUBTS = {
    "millimetres": ('"250 mm"', "250", "5: hexapod.base_radius is 250 m, more than 50 m"),
    "a tonne on a disc": ('"5 kg"', "1000", "18: payload.mass is 1000 kg, on a platform of 4.529 kg"),
    "a bar in mm": ('com = "120 mm"', "com = 120", "12: hexapod.strut.cylinder.com is 120 m, more than 50"),
    "a bar in cm": ('com = "120 mm"', "com = 12", "12: hexapod.strut.cylinder.com is 12 m, of a strut"),
}


@pytest.mark.parametrize("name", DOUBTS)
def test_what_is_hardly_meant_is_told_with_its_line(name, tmp_path):
    old, new, told = DOUBTS[name]
    text = HEXAPOD.replace(old, new, 1).replace('stroke = ["290 mm", "400 mm"]\n', "")
    with pytest.warns(pf.ImplausibleValue) as caught:
        loaded(tmp_path, text)
    assert {each.filename for each in caught} == {__file__}
    words = [str(each.message) for each in caught]
    assert len(words) == 1
    assert words[0].startswith(f"robot.toml:{told}")


MEET = "so that joints of neighbouring pairs coincide or change places; give less than 120 deg"
SLIPPED = {
    "a radius": (
        '"250 mm"', "250",
        ['5: hexapod.base_radius is 250 m, more than 50 m; if it is in mm, give 0.25 m, in files "250 mm"',
         "14: hexapod.strut.stroke is 0.29 … 0.4 m, but at home a strut is 249.9 m long"],
    ),
    "a stroke": (
        '"290 mm", "400 mm"', "290, 400",
        ["14: hexapod.strut.stroke is 290 … 400 m, but at home",
         '14: hexapod.strut.stroke is 400 m, more than 50 m; if it is in mm, give 0.4 m, in files "400 mm"'],
    ),
    "an angle": (
        'base_spread = "20 deg"', "base_spread = 20",
        [f'8: hexapod.base_spread is 1146 deg, {MEET}; did you mean "20 deg"?',
         "8: hexapod.base_spread is 20 rad, more than a full turn"],
    ),
    "a small angle": (
        'base_spread = "20 deg"', "base_spread = 4",
        [f'8: hexapod.base_spread is 229.2 deg, {MEET}; did you mean "4 deg"?'],
    ),
    "a large angle": (
        'base_spread = "20 deg"', 'base_spread = "130 deg"', [f"8: hexapod.base_spread is 130 deg, {MEET}"],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SLIPPED)
def test_slips_are_told_beside_the_errors_that_they_lead_to(name, tmp_path):
    old, new, lines = SLIPPED[name]
    with pytest.raises(pf.InputError) as caught:
        loaded(tmp_path, HEXAPOD.replace(old, new, 1))
    told = str(caught.value).splitlines()
    for line, expected in zip(told, lines, strict=True):
        assert line.startswith(f"robot.toml:{expected}")
    assert told[-1].endswith("?") == lines[-1].endswith("?")


def test_many_slips_leave_room_for_errors(tmp_path):
    """Five doubts beside an error: four of them, the error, and that there is one more."""
    text = HEXAPOD.replace('"250 mm"', "250").replace('"150 mm"', "150").replace('"300 mm"', "300")
    text = text.replace('com = "120 mm"', "com = 120").replace('com = "100 mm"', "com = 100")
    with pytest.raises(pf.InputError) as caught:
        loaded(tmp_path, text)
    *told, more = str(caught.value).splitlines()
    assert more == "… and 1 more"
    assert [line.split(":")[1] for line in told] == ["5", "6", "7", "12", "14"]


@pytest.mark.filterwarnings("default::parflex.ImplausibleValue")
def test_the_command_tells_it_in_a_line(parflex, tmp_path):
    (tmp_path / "robot.toml").write_text(HEXAPOD.replace('"5 kg"', "1000"), encoding="utf-8")
    code, out, err = parflex("check", "robot.toml")
    assert code == 0
    assert [line[:41] for line in err.splitlines()] == ["warning robot.toml:19: payload.mass is 10"]
    assert "6 freedoms" in out


JACKS = """\
format = "parflex-robot-1"
home = {{ position = [0, 0, 0.65] }}

[chain.leg]
{chain}

[platform]
kind = "rigid"
mass = 4
inertia = [0.1, 0.1, 0.2, 0, 0, 0]
attachments = [[0.3, 0, 0], [-0.15, {side}, 0], [-0.15, -{side}, 0]]
{legs}"""
THIRD = """
[[leg]]
chain = "leg"
origin = [{x}, {y}, 0]
rotation = [0, 0, "{angle} deg"]
attachments = [{number}]
"""
JACK = """\
type = "RPS"
cylinder = { outer = "60 mm", inner = "48 mm", length = "400 mm", density = 7850 }
rod = { outer = "24 mm", length = "400 mm", density = 7850 }
rotor_inertia = 4
"""


def three(chain: str) -> str:
    """A file of three legs of a kind, about the world's z."""
    legs = [
        THIRD.format(x=0.4 * np.cos(a), y=0.4 * np.sin(a), angle=np.degrees(a), number=i)
        for i, a in enumerate(np.arange(3) * 2 * np.pi / 3)
    ]
    return JACKS.format(chain=chain, legs="".join(legs), side=0.3 * np.sqrt(0.75))


def test_legs_by_kind_are_those_of_the_gallery(tmp_path):
    """The jacks of the gallery's 3-RPS, joint by joint."""
    mine, theirs = loaded(tmp_path, three(JACK)).legs[0].joints, pf.robots.rps3().legs[0].joints
    for found, wanted in zip(mine, theirs, strict=True):
        for name, value in vars(wanted).items():
            if value is None:
                assert getattr(found, name) is None
                continue
            finite = np.isfinite(value)
            assert relative(np.where(finite, getattr(found, name), 0), np.where(finite, value, 0)) < 1e-15, (
                name
            )


def test_springs_of_legs_by_kind_are_at_rest_at_home(tmp_path):
    """One length for all three, to the bit, so that they are traced as one leg."""
    stiff = loaded(tmp_path, three(JACK + "stiffness = 1e6"))
    rests = {leg.joints[1].q_0 for leg in stiff.legs}
    assert len(rests) == 1
    plain = loaded(tmp_path, three(JACK))
    forces = [pf.Model(robot, "numpy").equilibrium(*robot.home_pose)[1] for robot in (stiff, plain)]
    assert relative(*forces) < 1e-6
    [rest] = {leg.joints[1].q_0 for leg in loaded(tmp_path, three(JACK + "stiffness = 1e6\nrest = 0.6")).legs}
    assert rest == 0.6


KINDS = {
    "a kind there is not": ('"RPS"', '"RSP"', 5, 'chain.leg.type is "RSP"; choose "Delta" or "PRS" or "PUS"'),
    "a field of another kind": ("rod =", "crank =", 4, "chain.leg.crank is not known; known here"),
    "a stroke that home violates": ("rotor_inertia = 4", 'stroke = ["700 mm", 0.9]', 8,
                                    "chain.leg.stroke is 0.7 m … 0.9 m, but at home leg 1 is at 0.6576 m"),
    "limits the wrong way": ("rotor_inertia = 4", "stroke = [0.9, 0.6]", 8, "stroke is [0.9, 0.6]; give the"),
    "no axis": ("rotor_inertia = 4", "axis = [0, 0, 0]", 8, "axis is [0.0, 0.0, 0.0]; give a direction"),
    "a posture of three": ("rotor_inertia = 4", "posture = [0, 0, 0]", 8, "give one for each of the 2"),
    "said twice": ("density = 7850 }", "density = 7850, mass = 1 }", 6, "cylinder.density is 7850.0, beside"),
    "a spring by an angle": ("rotor_inertia = 4", 'stiffness = "5 N m/rad"', 8, "which is not a stiffness"),
}  # fmt: skip


@pytest.mark.parametrize("name", KINDS)
def test_complaints_about_legs_by_kind(name, tmp_path):
    old, new, line, words = KINDS[name]
    with pytest.raises(pf.InputError) as caught:
        loaded(tmp_path, three(JACK.replace(old, new, 1)))
    told = str(caught.value)
    assert told.splitlines()[0].startswith(f"robot.toml:{line}: "), told
    assert words in told


def test_tool_and_sensors_are_kept(tmp_path):
    text = (
        HEXAPOD
        + """
[tool]
position = [0, 0, "45 mm"]

[sensor.up]
type = "accelerometer"
direction = [0, 0, 1]

[sensor.lengths]
type = "encoder"
"""
    )
    (tmp_path / "robot.toml").write_text(text, encoding="utf-8")
    table = read_robot(tmp_path / "robot.toml").table
    assert table.tool.position == [0, 0, pytest.approx(0.045)]
    assert table.sensor["up"].direction == [0, 0, 1]
    assert table.sensor["lengths"].leg is None


def test_a_robot_without_home_is_told_both_ways_out(tmp_path):
    with pytest.raises(
        pf.InputError, match=r"robot.toml:1: the file: home is missing; .* or describe a \[hexapod"
    ):
        loaded(tmp_path, 'format = "parflex-robot-1"\n')


OTHER = '[chain.other]\njoints = [{{ type = "revolute", {} }}]\ntips = [{{ frame = 1 }}]\n[[leg]]'
SLIPS = {
    "grams": ("mass = 4\n", "mass = 73000\n", "13: platform.mass is 73000 kg, .* if it is in g,"),
    "kg mm²": ("[0.1, 0.1, 0.2", "[1e6, 1e6, 2e6", r"14: platform.inertia is 2000000 kg m\^2, .* give 2 kg"),
    "millimetres": ("position = [0, 0, 0.65]", "position = [0, 0, 650]", "2: home.position is 650 m"),
    "a leg's foot": ("origin = [0.4", "origin = [400", r"\d+: leg\[0\].origin is 400 m"),
    "degrees": (
        "[[leg]]", OTHER.format("alpha = -90"),
        r"\d+: chain.other.joints\[0\].alpha is -90 rad, .* if it is in deg",
    ),
    "a link in grams": (
        "[[leg]]", OTHER.format("mass = 3e4"),
        r"\d+: chain.other.joints\[0\].mass is 30000 kg",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SLIPS)
def test_likely_slips_are_told_with_their_line(name, tmp_path):
    """By the names that the file has for them, whatever is then found wrong with the robot."""
    old, new, words = SLIPS[name]
    text = three(JACK)
    assert old in text
    with pytest.warns(pf.ImplausibleValue, match=f"robot.toml:{words}") as caught:
        loaded(tmp_path, text.replace(old, new, 1))
    assert len(caught) == 1


BAR = '{ mass = 0.5, length = "400 mm", outer = "20 mm" }'
BY_KIND = {
    "UPS": (f"cylinder = {BAR}\nrod = {BAR}\naxis = [1, 0, 0]", ("cylinder", "rod"), {"axis": (1, 0, 0)}),
    "RPS": (f"cylinder = {BAR}\nrod = {BAR}\ndamping = 3", ("cylinder", "rod"), {"damping": 3.0}),
    "RUS": (f'crank = {BAR}\nrod = {BAR}\nstroke = ["-1 rad", 1]', ("crank", "rod"), {"stroke": (-1, 1)}),
    "PUS": (f"carriage = 2\nrod = {BAR}\nrail = [0, 1, 0]", ("rod",), {"carriage": 2.0, "rail": (0, 1, 0)}),
    "PRS": (f'carriage = "2 kg"\nrod = {BAR}\nrest = 1', ("rod",), {"carriage": 2, "rest": 1.0}),
    "Delta": (f'arm = {BAR}\nrod = {BAR}\nspacing = "90 mm"', ("arm", "rod"), {"spacing": 0.09}),
}  # fmt: skip


def test_every_kind_has_its_table():
    assert set(BY_KIND) == {kind.word for kind in ALL_LEG_KINDS}


@pytest.mark.parametrize("name", BY_KIND)
def test_every_kind_is_read(name, tmp_path):
    """The joints and tips of the same leg made in Python."""
    lines, bars, others = BY_KIND[name]
    [kind] = [kind for kind in ALL_LEG_KINDS if kind.word == name]
    bar = pf.Bar(mass=0.5, length=0.4, outer=0.02)
    expected = kind(**dict.fromkeys(bars, bar), **others)
    text = JACKS.format(
        chain=f'type = "{name}"\n{lines}', side=0.2, legs=THIRD.format(x=0, y=0, angle=0, number=0)
    )
    text = text.replace("attachments = [0]", f"attachments = {list(range(len(expected.tips)))}")
    (tmp_path / "robot.toml").write_text(text, encoding="utf-8")
    [leg] = read_robot(tmp_path / "robot.toml").robot.legs
    assert [repr(joint) for joint in leg.joints] == [repr(joint) for joint in expected.joints]
    assert [(tip.frame, *tip.offset) for tip in leg.tips] == [
        (tip.frame, *tip.offset) for tip in expected.tips
    ]
