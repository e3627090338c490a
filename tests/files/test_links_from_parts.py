"""Robot files whose links are parts: STEP files, matrices, modal files beside; complaints by line."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse

import parflex as pf
from bits import bits
from blocks import box
from measures import relative
from parts import LENGTH, STEEL, step_tube, tube_shape

HEAD = """\
format = "parflex-robot-1"

[home]
position = [0, 0, "900 mm"]

[chain.strut]
joints = [
  { type = "revolute", alpha = "-90 deg" },
  { type = "revolute", alpha = "90 deg" },
  { type = "prismatic", actuated = true, alpha = "90 deg", body = { BODY } },
]
tips = [ { frame = 3, offset = [0, 0, "620 mm"] } ]
"""
FEET = [(0.5, 0.1, 0), (-0.4, 0.5, 0), (-0.4, -0.5, 0), (0.6, -0.2, 0.1), (0.1, 0.7, 0), (-0.6, 0, 0)]
LEGS = "".join(
    f'[[leg]]\nchain = "strut"\norigin = {list(foot)}\nattachments = [{i}]\n' for i, foot in enumerate(FEET)
)
HEADS = [[float(0.2 * np.cos(i)), float(0.2 * np.sin(i)), 0.0] for i in range(6)]
PLATFORM = f"""\
[platform]
kind = "rigid"
mass = 4
inertia = [0.1, 0.1, 0.2, 0, 0, 0]
attachments = {HEADS}
"""
STEP = """kind = "solid", file = "tube.step", size = "7 mm", young = "205 GPa", poisson = 0.29, \
density = 7850, frame = [0, 0, 0], interfaces = [[0, 0, "620 mm"]]"""
MATRICES = """kind = "imported", program = "matrices", units = "SI", \
files = { stiffness = "K.npz", mass = "M.npz", nodes = "nodes.txt" }, ids = IDS"""
LINE = 10


def loaded(folder, body):
    (folder / "robot.toml").write_text(HEAD.replace("BODY", body) + LEGS + PLATFORM, encoding="utf-8")
    return pf.load_robot(folder / "robot.toml")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A tube in STEP, and the matrices of a bar as another program writes them, its nodes numbered from
    11."""
    place = tmp_path_factory.mktemp("parts")
    occ = pytest.importorskip("netgen.occ")
    tube_shape(occ).WriteStep(str(place / "tube.step"))
    two = occ.Compound([occ.Box((0, 0, 0), (10, 10, 620)), occ.Box((20, 0, 0), (30, 10, 620))])
    two.WriteStep(str(place / "two.step"))
    text = (place / "tube.step").read_text()
    (place / "cut.step").write_text(text[: len(text) // 2])
    body = bar()
    for name, matrix in (("K", body.stiffness), ("M", body.mass)):
        sparse.save_npz(place / f"{name}.npz", sparse.csr_matrix(matrix))
    np.savetxt(place / "nodes.txt", np.column_stack([11 + np.arange(len(body.nodes)), body.nodes]))
    return place


def bar() -> pf.fe.FreeBody:
    """A bar of steel along z, as long as the strut, about the origin."""
    return pf.fe.solid_body(box((0.03, 0.02, LENGTH), (2, 1, 12)), pf.fe.Material(**STEEL))


def ends(first=11):
    """The numbers of the nodes at both ends of the bar."""
    z = bar().nodes[:, 2]
    return [(first + np.flatnonzero(np.abs(z - end) < 1e-9)).tolist() for end in (-LENGTH / 2, LENGTH / 2)]


@pytest.fixture(scope="module")
def robot(folder):
    return loaded(folder, STEP)


def test_struts_from_step_are_those_of_python(robot):
    for leg in robot.legs:
        assert bits(leg.joints[2].body) == bits(step_tube())


def test_struts_from_step_are_written_once_and_read_to_the_bit(robot, tmp_path):
    path = robot.to_file(tmp_path / "robot.toml")
    assert bits(pf.load_robot(path)) == bits(robot)
    assert len(list(tmp_path.glob("robot.link-*.nc"))) == 1


def fewer(joint):
    """The joint whose link has its four lowest modes."""
    return replace(joint, body=joint.body.with_modes(range(4)))


def test_a_hexapod_on_struts_from_step_keeps_its_energy(robot):
    """It falls and swings freely: direct model, integrator and energies together."""
    legs = [replace(leg, joints=(*leg.joints[:2], fewer(leg.joints[2]))) for leg in robot.legs]
    slim = replace(robot, legs=legs)
    model = pf.Model(slim, "vm")
    rng = np.random.default_rng(1)
    bent = [1e-3 * rng.normal(size=4) for _ in range(6)]
    state = replace(slim.home, leg_elastic=bent)
    run = pf.simulate(model, np.zeros(6), state, np.linspace(0, 0.005, 3), rtol=1e-10, atol=1e-12)
    start, end = (model.energies(run.state(each)) for each in (0, -1))
    total = [each.kinetic + each.strain + each.gravity for each in (start, end)]
    assert abs(total[1] - total[0]) <= 1e-8 * (start.strain + end.kinetic)
    assert end.kinetic > 0.1 * start.strain


def test_matrices_are_links_by_node_numbers(folder):
    """The same as in Python, from the same matrices; the file warns of what they do not tell."""
    with pytest.warns(pf.NoForeshortening, match="P_cr about"):
        found = loaded(folder, MATRICES.replace("IDS", str(ends())))
    own = bar()
    expected = pf.fe.link(own, (0, 0, -LENGTH / 2), [(0, 0, LENGTH / 2)])
    body = found.legs[0].joints[2].body
    assert relative(body.stiffness / expected.stiffness, np.ones(expected.modes)) < 1e-8
    assert body.attachment_points == pytest.approx(np.array([[0, 0, LENGTH]]))


BAD = {
    "no frame": (STEP.replace("frame = [0, 0, 0], ", ""), "body.frame is missing; give the joint frame's"),
    "no interfaces": (STEP[: STEP.index(", interfaces")], "body.interfaces is missing; give the points"),
    "an interface in the air": (
        STEP.replace('"620 mm"]]', '"700 mm"]]'),
        "body.interfaces[0] at [0.  0.  0.7] m is nowhere on the part",
    ),
    "a tip elsewhere": (STEP.replace('[[0, 0, "620 mm"]]', "[[0, 0, 0.62], [0, 0, 0.62]]"), "hold node"),
    "two bodies": (STEP.replace("tube", "two"), "the mesh has 2 parts that do not touch"),
    "half a file": (
        STEP.replace("tube", "cut"),
        "cut.step names no unit of length; it is no",
    ),
    "no such file": (STEP.replace("tube", "away"), "away.step cannot be read"),
    "no material": (STEP.replace('young = "205 GPa", ', ""), "body: young is not given, but poisson is"),
    "a kind that there is not": (STEP.replace('"solid"', '"rigid"'), 'body.kind is "rigid"; choose "'),
    "a single node": (MATRICES.replace("IDS", "[[11, 12, 13, 14, 15, 16], [90]]"), "is a patch of 1 nodes"),
    "an unknown node": (
        MATRICES.replace("IDS", "[[11, 12, 13], [1, 2, 3]]"),
        "ids[1] has node 1, which",
    ),
    "an unknown program": (
        MATRICES.replace("IDS", "[[1], [2]]").replace('"matrices"', '"abacus"'),
        "body.program is 'abacus'; choose one of",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_complaints_name_line_field_and_value(name, folder):
    body, words = BAD[name]
    with pytest.raises(pf.InputError) as caught:
        loaded(folder, body)
    told = str(caught.value)
    assert told.startswith(f"robot.toml:{LINE}: "), told
    assert words in told, told
    assert "\n" not in told
