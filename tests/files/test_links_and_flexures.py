"""Robot files with links that bend and tips that are flexures: there and back, by hand, and complaints."""

import re
import tomllib
from dataclasses import replace
from math import radians

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import parflex as pf
from bits import bits
from measures import relative
from oracle import tree
from parflex.app.overview import bending_links
from parflex.fe.modal_file import save_body
from parflex.mechanics.paths import leg_paths
from parflex.model.core import core_of
from parflex.robot.beam_section import with_numbers

HEAD = """\
format = "parflex-robot-1"

[home]
position = [0, 0, "900 mm"]
rotation = [0.05, -0.1, 0.2]

[chain.strut]
joints = [
  { type = "revolute", alpha = "-90 deg" },
  { type = "revolute", alpha = "90 deg", beam = { end = [0, "-700 mm", 0], outer = "80 mm", inner = "68 mm", \
young = "205 GPa", poisson = 0.29, density = 7850, bending = 1 } },
  { type = "prismatic", actuated = true, alpha = "90 deg", beam = { end = [0, 0, "620 mm"], outer = "32 mm", \
young = "205 GPa", poisson = 0.29, density = 7850, bending = 1, axial = 1, damping_ratio = 0.005 } },
]
tips = [ { frame = 3, offset = [0, 0, "620 mm"], flexure = { bending = "5 N m/rad", \
torsion = "260 N m/rad", damping = "0.1 N m s/rad" } } ]
"""
FEET = [(0.5, 0.1, 0), (-0.4, 0.5, 0), (-0.4, -0.5, 0), (0.6, -0.2, 0.1), (0.1, 0.7, 0), (-0.6, 0, 0)]
LEGS = "".join(
    f'[[leg]]\nchain = "strut"\norigin = {list(foot)}\nrotation = [0, 0, {0.3 * i}]\nattachments = [{i}]\n'
    for i, foot in enumerate(FEET)
)
HEADS = [[0.2 * np.cos(i), 0.2 * np.sin(i), 0.0] for i in range(6)]
PLATFORM = f"""\
[platform]
kind = "rigid"
mass = 4
inertia = [0.1, 0.1, 0.2, 0, 0, 0]
attachments = {[[float(x) for x in head] for head in HEADS]}
"""
GOOD = HEAD + LEGS + PLATFORM


def loaded(folder, text):
    (folder / "robot.toml").write_text(text, encoding="utf-8")
    return pf.load_robot(folder / "robot.toml")


def clamped(rotation_shapes=True):
    """A link of three nodes by hand, clamped at the first, held at the last, its masses and shapes random."""
    rng = np.random.default_rng(4)
    masses = np.array([0.3, 0.5, 0.7])
    shapes = np.concatenate([np.zeros((2, 1, 3)), rng.normal(size=(2, 2, 3))], axis=1)
    weighted = (shapes * np.sqrt(masses)[:, None]).reshape(2, -1)
    shapes = (np.linalg.qr(weighted.T)[0].T).reshape(2, 3, 3) / np.sqrt(masses)[:, None]
    turns = np.concatenate([np.zeros((2, 1, 3)), rng.normal(size=(2, 2, 3))], axis=1)
    H = rng.normal(size=(1, 3, 2, 2))
    return pf.FlexibleBody.from_nodes(
        *([(0, 0, 0), (0, 0, 0.3), (0, 0, 0.62)], masses, shapes, [300.0, 400.0], 0.01, [2]),
        rotation_shapes=turns if rotation_shapes else None,
        foreshortening=H + np.swapaxes(H, -1, -2),
    )


def hexapod(**flexures):
    """Struts whose cylinders and rods bend, in every way."""
    cylinder = pf.Bar(outer=0.03, inner=0.024, length=0.22, density=2700.0, young=70e9, static=True)
    rod = pf.Bar(outer=0.012, length=0.2, mass=0.17, young=205e9, axial=2, poisson=0.3, torsion=1,
                 damping_ratio=np.full(5, 0.1 + 0.2))  # fmt: skip
    sizes = dict(base_radius=0.25, platform_radius=0.15, height=0.3)
    spreads = dict(base_spread=radians(20), platform_spread=radians(21))
    return pf.robots.hexapod(**sizes, **spreads, strut=pf.Strut(cylinder, rod))


def with_links(robot, link):
    """The robot with another rod on each leg."""
    legs = [
        replace(
            leg,
            joints=(*leg.joints[:2], replace(leg.joints[2], body=link(i))),
            tips=[replace(leg.tips[0], offset=link(i).attachment_points[0])],
        )
        for i, leg in enumerate(robot.legs)
    ]
    return replace(robot, legs=legs)


def with_flexures(robot):
    """The robot with another flexure at each tip."""
    rng = np.random.default_rng(2)

    def flexure(number):
        K, D = (x @ x.T for x in rng.normal(size=(2, 3, 3)))
        rest = Rotation.random(random_state=number).as_matrix() if number % 2 else None
        return pf.Flexure(K, 0.5 * (D + D.T), friction=0.1 * number, friction_speed=2e-3, rest=rest)

    legs = [replace(leg, tips=[replace(leg.tips[0], flexure=flexure(i))]) for i, leg in enumerate(robot.legs)]
    return replace(robot, legs=legs)


ROD = pf.beam((0, 0, 0.2), 0.01, young=2e11, poisson=0.3, density=7e3)
ROBOTS = {
    "beams": hexapod,
    "bodies by nodes": lambda: with_links(hexapod(), lambda i: clamped()),
    "without rotation shapes": lambda: with_links(hexapod(), lambda i: clamped(rotation_shapes=False)),
    "a beam with fewer modes": lambda: with_links(hexapod(), lambda i: ROD.with_modes([i % 2])),
    "a beam of another section": lambda: with_links(hexapod(), lambda i: with_numbers(ROD, {"outer": 0.012})),
    "flexures": lambda: with_flexures(hexapod()),
}
FILES = {"bodies by nodes": 1, "without rotation shapes": 1, "a beam with fewer modes": 2}
FILES |= {"a beam of another section": 1}


@pytest.mark.parametrize("name", ROBOTS)
def test_there_and_back_to_the_bit(name, tmp_path):
    """Beams stay beams; other links are in files beside, one for all that are alike."""
    robot = ROBOTS[name]()
    path = robot.to_file(tmp_path / "robot.toml")
    again = pf.load_robot(path)
    assert bits(again) == bits(robot)
    assert again.to_file(tmp_path / "twice.toml").read_text().replace("twice", "robot") == path.read_text()
    assert len(list(tmp_path.glob("robot.link-*.nc"))) == FILES.get(name, 0)


def test_legs_of_one_kind_are_told_once(tmp_path):
    tables = tomllib.loads(hexapod().to_file(tmp_path / "r.toml").read_text())
    assert list(tables["chain"]) == ["rrp-1"]
    [_, cylinder, rod] = tables["chain"]["rrp-1"]["joints"]
    assert cylinder["beam"]["young"] == 70e9
    assert cylinder["beam"]["static"] is True
    assert rod["beam"]["damping_ratio"] == [0.1 + 0.2] * 5


def test_beams_of_a_file_are_those_of_the_library(tmp_path):
    """By units and defaults, against the same links in SI units, written in Python."""
    steel = dict(young=205e9, poisson=0.29, density=7850.0)
    cylinder = pf.beam((0, -0.7, 0), 0.08, 0.068, **steel)
    rod = pf.beam((0, 0, 0.62), 0.032, **steel, axial=1, damping_ratio=0.005)
    for leg in loaded(tmp_path, GOOD).legs:
        assert leg.joints[0].body is None
        for joint, expected in zip(leg.joints[1:], (cylinder, rod), strict=True):
            assert joint.M == 0
            assert relative(joint.body.moments.P2, expected.moments.P2) < 1e-12
            assert relative(joint.body.stiffness / expected.stiffness, np.ones(expected.modes)) < 1e-12
            assert relative(joint.body.damping, expected.damping) < 1e-12


def test_torsion_is_about_the_strut_as_the_platform_sees_it_at_home(tmp_path):
    """n from foot to head, which the strut lies along, in the axes of the turned platform."""
    robot = loaded(tmp_path, GOOD)
    position, rotation = robot.home_pose
    for leg, foot, head in zip(robot.legs, FEET, HEADS, strict=True):
        n = rotation.T @ (position + rotation @ head - foot)
        nn = np.outer(n, n) / (n @ n)
        [tip] = leg.tips
        assert relative(tip.flexure.stiffness, 5 * (np.eye(3) - nn) + 260 * nn) < 1e-11
        assert np.array_equal(tip.flexure.damping, 0.1 * np.eye(3))
        assert tip.flexure.rest is None


def test_a_tip_at_the_origin_of_a_slide_is_on_its_axis(tmp_path):
    """Rigid rods, from the tip down; the direction at home by the oracle's frames."""
    text = GOOD.replace(', offset = [0, 0, "620 mm"]', "")
    start, end = text.index(', beam = { end = [0, 0, "620 mm"]'), text.index("0.005 } }")
    robot = loaded(tmp_path, text[:start] + ", mass = 3 }" + text[end + 9 :])
    q = pf.Model(robot, "numpy").joints(robot.home).q
    for leg, at in zip(robot.legs, q, strict=True):
        n = robot.home_pose[1].T @ tree(leg, at)[0][2][:, 2]
        expected = 5 * (np.eye(3) - np.outer(n, n)) + 260 * np.outer(n, n)
        assert relative(leg.tips[0].flexure.stiffness, expected) < 1e-12


def test_a_flexure_in_full(tmp_path):
    rows = "[[3, 1, 0], [1, 4, 0], [0, 0, 5]]"
    flexure = f'stiffness = {rows}, damping = {rows}, friction = "2 N m", friction_speed = "1 deg/s"'
    text = GOOD.replace('bending = "5 N m/rad", torsion = "260 N m/rad", damping = "0.1 N m s/rad"',
                        flexure + ', rest = [0, 0, "90 deg"]')  # fmt: skip
    found = loaded(tmp_path, text).legs[2].tips[0].flexure
    K = np.array([[3, 1, 0], [1, 4, 0], [0, 0, 5]])
    assert np.array_equal(found.stiffness, K)
    assert np.array_equal(found.damping, K)
    assert (found.friction, found.friction_speed) == (2.0, pytest.approx(np.pi / 180))
    assert relative(found.rest, Rotation.from_rotvec([0, 0, np.pi / 2]).as_matrix()) < 1e-15


BODY = 'body = {{ kind = "modal", file = "{}.nc" }} }},'
RODS = GOOD[GOOD.index('beam = { end = [0, 0, "620') : GOOD.index("]\ntips")].strip()
FLEXURE = GOOD[GOOD.index("flexure = {") : GOOD.index("[[leg]]")]
IDENTITY = "[[1, 0, 0], [0, 1, 0], [0, 0, 1]]"
UNEVEN = "flexure = { stiffness = [[1, 2, 0], [0, 1, 0], [0, 0, 1]] } } ]\n"
BAD = {
    "mass twice": (
        ("bending = 1 } }", "bending = 1 }, mass = 3 }"),
        10,
        "joints[1] gives beam and mass, each",
    ),
    "a centre, too": (
        ("bending = 1 } }", "bending = 1 }, com = [0, 0, 0] }"),
        10,
        "gives beam and com, each",
    ),
    "two links": ((RODS, RODS[:-3] + ", " + BODY.format("link")), 11, "joints[2] gives beam and body"),
    "a wall of nothing": (('"68 mm"', '"80 mm"'), 10, "beam.inner is 0.08; it must be less than outer"),
    "a number for a beam": ((RODS, "beam = 3 },"), 11, "joints[2].beam is 3; expected a table"),
    "no density": (
        (", density = 7850, bending = 1 }", ", bending = 1 }"),
        10,
        "give density of the material",
    ),
    "no length": (('[0, "-700 mm", 0]', "[0, 0, 0]"), 10, "beam.end is [0.0, 0.0, 0.0], where the beam"),
    "poisson": (("poisson = 0.29", "poisson = 0.6"), 10, "beam.poisson is 0.6; it must lie between -1 and"),
    "too many": (
        ("bending = 1 }", "bending = 17 }"),
        10,
        "beam.bending is 17, but the 33 nodes of a beam carry",
    ),
    "damping of other modes": (
        ("0.005", "[0.1, 0.1]"),
        11,
        "beam.damping_ratio has 2 entries; give one for all",
    ),
    "an unknown field": (("inner =", "diameter ="), 10, "beam.diameter is not known"),
    "a child away": (
        ('end = [0, "-700 mm", 0]', 'end = ["10 mm", "-700 mm", 0]'),
        11,
        "joint 3 on link 2, which is flexible, is at none of its attachments: its axis passes 0.01 m from "
        "the nearest, number 0 at (0.01, -0.7, 0) m",
    ),
    "a tip away": (
        ('offset = [0, 0, "620 mm"]', 'offset = [0, 0, "600 mm"]'),
        13,
        "tips[0] on link 3, which is flexible, is at none of its attachments: it is 0.02 m from the nearest, "
        "number 0 at (0, 0, 0.62)",
    ),
    "a flexure on a body without turns": (
        (RODS, BODY.format("bare")),
        13,
        "the body of joint 3 has no rotation shapes, but carries a tip with a flexure",
    ),
    "no such file": ((RODS, BODY.format("away")), 11, "joints[2].body.file is away.nc, but"),
    "two stiffnesses": (
        ('bending = "5', f'stiffness = {IDENTITY}, bending = "5'),
        13,
        "flexure gives stiffness and bending; keep one",
    ),
    "an uneven matrix": ((FLEXURE, UNEVEN), 13, "flexure.stiffness differs from its transpose by 2; give a"),
    "a spring that pushes": (
        ("5 N m/rad", "-5 N m/rad"),
        13,
        'bending is "-5 N m/rad"; it cannot be negative',
    ),
    "a strut without a direction": (
        ('{ frame = 3, offset = [0, 0, "620 mm"]', "{ frame = 1"),
        13,
        "flexure: stiffness differs along and across the strut, but the tip is at the origin of frame 1",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_complaints_name_line_field_and_value(name, tmp_path):
    (old, new), line, words = BAD[name]
    save_body(clamped(), tmp_path / "link.nc")
    save_body(clamped(rotation_shapes=False), tmp_path / "bare.nc")
    assert old in GOOD
    with pytest.raises(pf.InputError) as caught:
        loaded(tmp_path, GOOD.replace(old, new, 1))
    told = str(caught.value)
    assert told.startswith(f"robot.toml:{line}: "), told
    assert words in told
    assert "\n" not in told


def test_a_modulus_without_its_unit_is_doubted_at_its_line(tmp_path):
    with pytest.warns(pf.ImplausibleValue) as caught:
        loaded(tmp_path, GOOD.replace('"205 GPa"', "205", 1))
    [told] = caught
    assert str(told.message).startswith(
        "robot.toml:10: chain.strut.joints[1].beam.young is 205 Pa, less than"
    )


SPOILT = {"shapes": ("shapes move", 0), "turns": ("shapes turn", 1)}


@pytest.mark.parametrize("name", SPOILT)
def test_a_body_that_is_not_clamped_is_refused(name, tmp_path):
    """It moves or turns at the joint's frame."""
    words, which = SPOILT[name]
    body = clamped()
    arrays = [body.shapes.copy(), body.rotation_shapes.copy()]
    arrays[which][1, 0, 2] = 0.01
    save_body(replace(body, shapes=arrays[0], rotation_shapes=arrays[1]), tmp_path / "loose.nc")
    with pytest.raises(pf.InputError, match=rf"robot.toml:11: .*body: its {words} the origin of the joint's"):
        loaded(tmp_path, GOOD.replace(RODS, BODY.format("loose"), 1))


def test_a_flexure_on_a_platform_that_does_not_say_how_it_turns(tmp_path):
    """Of nodes by hand, all held, without rotation shapes."""
    shapes = np.zeros((1, 6, 3))
    shapes[0, :, 2] = np.array([1, -1, 1, -1, 1, -1]) / np.sqrt(6)
    save_body(
        pf.FlexibleBody.from_nodes(HEADS, np.ones(6), shapes, [60.0], 0, range(6)), tmp_path / "plate.nc"
    )
    with pytest.raises(
        pf.InputError, match=r"robot.toml:\d+: .*tips\[0\] has a flexure, but the platform has no"
    ):
        loaded(tmp_path, HEAD + LEGS + '[platform]\nkind = "modal"\nfile = "plate.nc"\n')


def test_a_joint_on_a_body_that_does_not_say_how_it_turns(tmp_path):
    """The same node by node as a cylinder: it carries a joint."""
    body = clamped(rotation_shapes=False)
    save_body(body, tmp_path / "bare.nc")
    start, end = GOOD.index("beam = { end = [0, "), GOOD.index("bending = 1 } }") + len("bending = 1 } }")
    text = GOOD[:start] + BODY.format("bare")[:-1] + GOOD[end:]
    with pytest.raises(
        pf.InputError, match="robot.toml:11: .*the body of joint 2 has no rotation shapes, but"
    ):
        loaded(tmp_path, text.replace('actuated = true, alpha = "90 deg"', "actuated = true, d = 0"))


def test_a_rest_that_is_half_a_turn_away_is_refused(tmp_path):
    """The first leg's turn at home, by the oracle's frames, turned further."""
    robot = loaded(tmp_path, GOOD)
    q = pf.Model(robot, "numpy").joints(robot.home).q
    turn = robot.home_pose[1].T @ tree(robot.legs[0], q[0])[0][2]

    def resting(degrees):
        away = Rotation.from_rotvec(np.radians(degrees) * np.array([0.6, 0, 0.8])).as_matrix()
        rest = f"flexure = {{ rest = {(away @ turn).tolist()}, "
        once = GOOD[: GOOD.index("[[leg]]", GOOD.index("[[leg]]") + 1)]  # one leg
        return (once + PLATFORM).replace("flexure = {", rest)

    assert loaded(tmp_path, resting(174)).legs
    with pytest.raises(
        pf.InputError, match=r"robot.toml:13: .*rest is 178.0 deg from how the tip is turned at"
    ):
        loaded(tmp_path, resting(178))


def test_what_bends_is_told():
    """Two links of each of six legs; three shapes in two planes of cylinders, five modes of rods."""
    [told] = bending_links(hexapod())
    assert told.startswith("links that bend: 12, 66 modes, ")
    assert bending_links(pf.robots.rps3(0)) == []


def test_bars_of_a_hexapod_bend(tmp_path):
    """Cylinder and rod of `[hexapod.strut]` by physical fields, against the same in Python."""
    text = """format = "parflex-robot-1"
[hexapod]
base_radius = "250 mm"
platform_radius = "150 mm"
height = "300 mm"
base_spread = "20 deg"
platform_spread = "21 deg"
[hexapod.strut]
cylinder = { outer = "30 mm", inner = "24 mm", length = "220 mm", density = 2700, \
young = "70 GPa", static = true }
rod = { outer = "12 mm", length = "200 mm", mass = "170 g", young = "205 GPa", axial = 2, torsion = 1, \
poisson = 0.3, damping_ratio = 0.3 }
"""
    found, expected = loaded(tmp_path, text), hexapod()
    for mine, theirs in zip(found.legs, expected.legs, strict=True):
        assert mine.modes == theirs.modes == (0, 6, 5)
        for a, b in zip(mine.joints, theirs.joints, strict=True):
            assert a.r == pytest.approx(b.r)
            if b.body is not None:
                assert relative(a.body.stiffness / b.body.stiffness, np.ones(b.body.modes)) < 1e-12
    with pytest.warns(pf.ImplausibleValue, match="robot.toml:9: .*cylinder.young is 70 Pa, less") as caught:
        loaded(tmp_path, text.replace('"70 GPa"', "70"))
    assert len(caught) == 1
    with pytest.raises(pf.InputError, match=r"toml:9: hexapod.strut.cylinder.* young is missing; a bar"):
        loaded(tmp_path, text.replace('young = "70 GPa", ', ""))
    with pytest.raises(
        pf.InputError, match=r"robot.toml:10: hexapod.strut.rod.bending is 20, but the 33 nodes"
    ):
        loaded(tmp_path, text.replace("axial = 2", "bending = 20"))
    with pytest.raises(pf.InputError, match=r"robot.toml:10: hexapod.strut.rod.com is given, but"):
        loaded(tmp_path, text.replace("axial = 2", "com = 0.1"))


def soft_struts(tmp_path):
    """The robot whose flexures give along and across their struts."""
    new = 'flexure = { axial = "94 N/um", shear = "2e6 N/m", translation_damping = "50 N s/m", bending = "5'
    assert 'flexure = { bending = "5' in GOOD
    return loaded(tmp_path, GOOD.replace('flexure = { bending = "5', new))


def test_soft_tips_are_stiff_along_their_struts(tmp_path):
    """K_t n = 94e6 n along the direction of the strut at home, found from the leg's points in the world."""
    robot = soft_struts(tmp_path)
    tip = robot.legs[0].tips[0]
    K = tip.flexure.translation
    paths = leg_paths(core_of(pf.Model(robot, "numpy")).system(robot.home)).points
    n = robot.home_pose[1].T @ (paths[0, -1] - paths[0, 0])
    n /= np.linalg.norm(n)
    assert n @ K @ n == pytest.approx(94e6, rel=1e-9)
    assert np.linalg.eigvalsh(K)[:2] == pytest.approx(2e6, rel=1e-9)
    assert np.array_equal(tip.flexure.translation_damping, 50 * np.eye(3))


def test_soft_tips_are_written_and_read_to_the_bit(tmp_path):
    robot = soft_struts(tmp_path)
    again = pf.load_robot(robot.to_file(tmp_path / "again.toml"))
    for one, other in zip(again.legs, robot.legs, strict=True):
        for a, b in zip(one.tips, other.tips, strict=True):
            assert np.array_equal(a.flexure.translation, b.flexure.translation)
            assert np.array_equal(a.flexure.translation_damping, b.flexure.translation_damping)


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ('axial = "1 N/m"', "gives axial without shear"),
        ('translation_damping = "1 N s/m"', "its tip is not soft"),
        (f"axial = 1.0, shear = 1.0, translation = {IDENTITY}", "gives translation and axial; keep one"),
    ],
)
def test_half_a_soft_tip_is_none(tmp_path, entry, words):
    with pytest.raises(pf.InputError, match=words):
        loaded(tmp_path, GOOD.replace("flexure = { bending", f"flexure = {{ {entry}, bending"))


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ("translation = [[1, 2, 0], [0, 1, 0], [0, 0, 1]]", "translation differs from its transpose by 2"),
        ("translation = [[-1, 0, 0], [0, 1, 0], [0, 0, 1]]", "translation has the principal value -1"),
        ("translation = [[nan, 0, 0], [0, 1, 0], [0, 0, 1]]", r"translation\[0\]\[0\] is nan; expected a"),
        ("translation = [[1, 0], [0, 1]]", r"translation\[0\] has 2 entries; give at least 3"),
        ('translation = "47 N/um"', 'translation is "47 N/um"; expected a list in brackets'),
        ('axial = "47 N m/rad", shear = 0.0', "axial is .* not a stiffness; expected a stiffness in N/m"),
        ('axial = "-47 N/um", shear = 0.0', "axial is .*; it cannot be negative"),
    ],
)
def test_what_a_soft_tip_cannot_be_is_told_with_its_line(tmp_path, entry, words):
    with pytest.raises(pf.InputError, match=words) as told:
        loaded(tmp_path, GOOD.replace("flexure = { bending", f"flexure = {{ {entry}, bending"))
    assert all(re.match(r".*\.toml:\d+: ", line) for line in str(told.value).splitlines())
