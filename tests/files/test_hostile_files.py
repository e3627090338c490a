"""Files spoilt at random: each is read, or refused by one of this library's errors, after little work.

`PARFLEX_FUZZ=20000 pytest tests/files/test_hostile_files.py -m ''` spoils as many as it says.
"""

import os
import re
import time
import warnings
from pathlib import Path

import numpy as np
import pytest

import parflex as pf
from hostile import hostile
from parflex.app.templates import write_templates
from parflex.app.trajectory_file import read_plan
from parflex.files.lines import line_of

COUNT = int(os.environ.get("PARFLEX_FUZZ", "300"))
LONGEST = 2.0  # s of this process, for what is refused or read: told by the whole run only


@pytest.fixture(scope="module")
def texts(tmp_path_factory) -> dict[str, str]:
    """A robot with a platform of one mode, a rigid one and one with legs that bend, as the library writes
    them, and a trajectory."""
    folder = tmp_path_factory.mktemp("hostile")
    robot, trajectory = write_templates(folder / "robot.toml")
    rigid = pf.robots.gough_stewart(platform=ring()).to_file(folder / "rigid.toml")
    return {
        "plate": re.sub(r"(?m)^modes = .*$", "modes = 1", robot.read_text()),
        "rigid": rigid.read_text(),
        "bending": bending().to_file(folder / "bending.toml").read_text().replace(TIP, TIP + FLEXURE),
        "trajectory": trajectory.read_text(),
    }


TIP = "offset = [0.0, 0.0, 0.5]\n"
FLEXURE = """[chain.rrp-1.tips.flexure]
bending = 5.0
torsion = "260 N m/rad"
damping = 0.1
"""


def bending() -> pf.Robot:
    """A hexapod whose cylinders and rods bend."""
    steel = {"density": 7850.0, "young": 2e11, "poisson": 0.3}
    bars = (
        pf.Bar(outer=0.04, length=0.5, **steel, static=True),
        pf.Bar(outer=0.02, length=0.5, **steel, torsion=1),
    )
    sizes = dict(base_radius=0.5, platform_radius=0.3, height=0.7, base_spread=0.3, platform_spread=0.3)
    return pf.robots.hexapod(**sizes, strut=pf.Strut(*bars))


def ring() -> pf.FlexibleBody:
    points = [(np.cos(a), np.sin(a), 0.0) for a in np.arange(6)]
    return pf.FlexibleBody.rigid(10.0, (0, 0, 0), np.diag([1.0, 1, 2]), points)


def outcome(read, path: Path) -> str:
    """How a file is answered: read, refused, or what went wrong; and whether it took long."""
    start = time.process_time()
    try:
        read(path)
        said = "read"
    except pf.InputError as error:
        shown = str(error)
        fine = len(shown) < 4000 and shown.count("\n") <= 5 and str(path.name) in shown and "\0" not in shown
        said = "refused" if fine else f"refused badly: {shown}"
    except Exception as error:
        said = f"{type(error).__name__}: {error}"
    taken = time.process_time() - start
    return said if COUNT <= 300 or taken < LONGEST else f"{said}, after {taken:.1f} s"


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["plate", "rigid", "bending", "trajectory"])
def test_hostile_files_are_read_or_refused(texts, kind, tmp_path):
    """Numbers to 1e400, other values, lost lines and bytes; no other error, no wait, no word too many."""
    rng = np.random.default_rng(11)
    read = read_plan if kind == "trajectory" else pf.load_robot
    path, odd, answers = tmp_path / "spoilt.toml", [], {"read": 0, "refused": 0}
    for number in range(COUNT):
        data = hostile(texts[kind], rng)
        path.write_bytes(data)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            said = outcome(read, path)
        if said in answers:
            answers[said] += 1
        else:
            odd.append((number, said))
    assert odd == []
    assert min(answers.values()) >= COUNT // 50


GIANT = {
    "a number of 5000 digits": ("mass = 4.0", "mass = " + "9" * 5000, "17: a number has thousands of digits"),
    "a number of 400 digits": (
        "mass = 4.0",
        "mass = " + "9" * 400,
        "17: platform.mass is a whole number",
    ),
    "one in base sixteen": (
        "mass = 4.0",
        "mass = 0x" + "f" * 5000,
        "17: platform.mass is a whole number",
    ),
    "brackets": ("mass = 4.0", "mass = " + "[" * 9999 + "]" * 9999, "17: this is nested deeper"),
    "tables": ("mass = 4.0", "mass = " + "{a = " * 99 + "1" + "}" * 99, "17: this is nested deeper"),
    "a key of many": ("mass = 4.0", ".".join("m" * 9999) + " = 4", "17: this is nested deeper"),
    "a power of a power": (
        "mass = 4.0",
        'mass = "1 kg**9**9**9"',
        "17: platform.mass is .*; exponents",
    ),
    "a power of brackets": (
        "mass = 4.0",
        'mass = "1 (kg**9)**9"',
        "17: platform.mass is .*; exponents",
    ),
    "a power of a number": (
        "mass = 4.0",
        'mass = "1 kg*9**9"',
        "17: platform.mass is .*; exponents",
    ),
    "a long number": ("mass = 4.0", f'mass = "{"1" * 99999}"', r"17: platform.mass is .*\.\.\.; expected"),
    "a NUL": ("mass = 4.0", 'mass = "\\u0000"', r'17: platform.mass is "\\u0000"; expected'),
}
RIGID = """\
format = "parflex-robot-1"
home = {position = [0, 0, 1], rotation = [0, 0, 0]}
[chain.ups]
joints = [{type = "prismatic", mass = 1.0}]
tips = [{frame = 1}]

[[leg]]
chain = "ups"
attachments = [0]
origin = [0, 0, 0]
[platform]
kind = "rigid"
inertia = [0.1, 0.1, 0.2, 0, 0, 0]
attachments = [[0.3, 0, 0]]
# here
# comes
mass = 4.0
"""


@pytest.mark.parametrize("name", GIANT)
def test_what_would_never_end_is_refused_at_its_line(name, tmp_path):
    old, new, words = GIANT[name]
    path = tmp_path / "robot.toml"
    path.write_text(RIGID.replace(old, new))
    with pytest.raises(pf.InputError, match=f"robot.toml:{words}") as caught:
        pf.load_robot(path)
    assert len(str(caught.value)) < 300


@pytest.mark.parametrize(
    ("field", "given", "words"),
    [
        ("modes", "1000000000", "platform.modes is 1000000000; a mode takes 12 unknowns"),
        ("refine", "1000000000", "platform.refine is 1000000000, which makes more than 30000 unknowns"),
        ("refine", "9", "give 5 or less"),
        ("young", "1e308", "platform: nothing can be made of this"),
        ("thickness", "1e-300", "platform: nothing can be made of this"),
        ("density", "1e308", "platform: nothing can be made of this"),
    ],
)
def test_numbers_that_nothing_can_be_made_of(texts, field, given, words, tmp_path):
    """With the line of the table or the field, and no traceback."""
    text, path = (
        texts["plate"].replace("modes =", "refine = 2\nmodes =" if field == "refine" else "modes ="),
        tmp_path / "robot.toml",
    )
    text = re.sub(rf"(?m)^{field} = .*$", f"{field} = {given}", text)
    path.write_text(text)
    with pytest.raises(pf.InputError, match=words) as caught:
        pf.load_robot(path)
    table = "platform" in words and "nothing" in words
    line = line_of(text, ("platform",) if table else ("platform", field))
    assert str(caught.value).startswith(f"robot.toml:{line}: ")


def test_many_complaints_cost_no_more_than_few(tmp_path):
    """Those that are shown are located, the first by line; the others are counted."""
    path = tmp_path / "robot.toml"
    rows = "".join(f"  [{i}, 0, true],\n" for i in range(20_000))
    path.write_text(RIGID.replace("[[0.3, 0, 0]]", f"[\n{rows}]"))
    with pytest.raises(pf.InputError) as caught:
        pf.load_robot(path)
    lines = str(caught.value).splitlines()
    assert [line.split(":")[1] for line in lines[:5]] == [str(n) for n in range(15, 20)]
    assert lines[5] == "… and 19995 more"


def test_no_file_of_this_kind_is_that_large(tmp_path):
    path = tmp_path / "robot.toml"
    path.write_bytes(b"#" * 5_000_000)
    with pytest.raises(pf.InputError, match="larger than 4 MB"):
        pf.load_robot(path)
    with pytest.raises(pf.InputError, match=r"cannot be read|larger than"):
        pf.load_robot("/dev/zero")
    with pytest.raises(pf.InputError, match="cannot be read"):
        pf.load_robot("a\0b.toml")


@pytest.mark.parametrize("kind", ["plate", "rigid", "trajectory"])
def test_marks_and_line_ends_of_editors_change_nothing(texts, kind, tmp_path):
    """UTF-8 with a byte order mark and lines that end with CR LF, as Notepad writes; lines count alike."""
    text, path = texts[kind], tmp_path / "file.toml"
    read = read_plan if kind == "trajectory" else pf.load_robot
    path.write_bytes(b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode())
    read(path)
    path.write_bytes(b"\xef\xbb\xbf" + (text + "\n[nowhere]\n").replace("\n", "\r\n").encode())
    with pytest.raises(pf.InputError, match=f"file.toml:{text.count(chr(10)) + 2}: nowhere is not known"):
        read(path)


STRETCHED, SHEARED, MIRRORED = (
    "[[1, 0, 0], [0, 1, 0], [0, 0, 2]]",
    "[[1, 0.1, 0], [0, 1, 0], [0, 0, 1]]",
    "[[1, 0, 0], [0, 1, 0], [0, 0, -1]]",
)


@pytest.mark.parametrize("matrix", [STRETCHED, SHEARED, MIRRORED])
@pytest.mark.parametrize("field", ["home", "leg[0]", "move[0]"])
def test_matrices_that_are_no_rotations_are_refused_in_every_field(texts, field, matrix, tmp_path):
    """Stretched, sheared, mirrored; at the field, with its line."""
    path, given = tmp_path / "file.toml", f"rotation = {matrix}"
    if field == "move[0]":
        text, read = re.sub(r"(?m)^rotation = .*$", given, texts["trajectory"]), read_plan
    else:
        begin = "[home]\n" if field == "home" else "[[leg]]\n"
        at = texts["rigid"].index(begin)
        head, tail = texts["rigid"][:at], texts["rigid"][at:]
        text, read = head + re.sub(r"(?m)^rotation = .*$", given, tail, count=1), pf.load_robot
    path.write_text(text)
    with pytest.raises(pf.InputError, match=rf"file.toml:\d+: {re.escape(field)}.rotation is not a rotation"):
        read(path)
