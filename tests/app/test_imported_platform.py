"""Platforms from other programs at work: the command, the robot file, the paper's trajectory."""

import numpy as np
import pytest

import parflex as pf
from ccx import deck, needs_ccx, plate_mesh, run
from imports import CORNERS, DATA
from paper_robot import DAMPING_RATIO, PLATE, corners
from parflex.app import paper
from parflex.fe.body.attach import first

pytest.importorskip("pyyeti", reason="pyYeti reads Nastran's files")

SHAKE = 1.75  # s: half a second at rest, and the first move


def nastran() -> pf.Modes:
    """MYSTRAN's nine lowest modes of the plate, held at its corners."""
    modes = first(pf.fe.read_nastran(DATA / "hexQ8.OP2", DATA / "hexQ8.bdf", "SI"), 9)
    nearest = [np.argmin(np.linalg.norm(modes.nodes - corner, axis=1)) for corner in CORNERS]
    return pf.fe.attached(modes, ids=[modes.ids[k] for k in nearest])


def flown(modes: pf.Modes):
    """The beginning of the paper's trajectory: actuator forces, and deformation at the corners."""
    body = pf.FlexibleBody.from_modes(modes, origin=(0, 0, 0), damping_ratio=DAMPING_RATIO)
    robot = pf.robots.gough_stewart(platform=body)
    model, way = pf.Model(robot), paper.trajectory(robot)
    times, start = np.linspace(0, SHAKE, 71), model.equilibrium(*robot.home_pose)[0]
    run = pf.simulate(model, pf.ComputedTorque(model, way), start, times, rtol=1e-6, atol=1e-8, max_step=0.02)
    return run.dataset["forces"].values, run.dataset["attachment_deformation"].values


def compliance(modes: pf.Modes) -> np.ndarray:
    """Of the corners along the normal, Φ ω⁻² Φᵀ (6, 6)."""
    w = pf.FlexibleBody.from_modes(modes).attachment_shapes[:, 2]
    return w / modes.frequencies**2 @ w.T


def largest(values: np.ndarray) -> float:
    return float(np.max(np.abs(values)))


@pytest.fixture(scope="module")
def own():
    """The Kirchhoff plate, nine modes."""
    modes = pf.fe.plate_modes(corners(), n_modes=9, **PLATE)
    return modes, *flown(modes)


def compared(modes: pf.Modes, own) -> tuple[float, float, float]:
    """Differences from our plate: of forces and deformation in flight, and of the corners' compliance."""
    forces, deformation = flown(modes)
    soft = largest(compliance(modes) - compliance(own[0])) / largest(compliance(own[0]))
    return (
        largest(forces - own[1]) / largest(own[1]),
        largest(deformation - own[2]) / largest(own[2]),
        soft,
    )


def test_trajectory_with_the_platform_of_nastran(own):
    """Four-node shells of 62 mm are soft: the corners give 2.6 % more under unit forces, and bend so much
    more in flight; the forces differ by what that bending moves, 0.4 %."""
    forces, deformation, soft = compared(nastran(), own)
    assert 0.02 < soft < 0.03
    assert abs(deformation - soft) <= 0.005
    assert forces <= 0.005


@needs_ccx
def test_trajectory_with_the_platform_of_calculix(own, tmp_path):
    """A solid shears, which a Kirchhoff plate does not: the corners give 0.7 % more on this mesh (1.2 % on
    the next finer one), and bend so much more in flight."""
    job = run(tmp_path, "modes", deck(*plate_mesh(3), "*FREQUENCY\n16"))
    modes = first(pf.fe.read_calculix(job.with_suffix(".frd"), job, "SI"), 9)
    forces, deformation, soft = compared(pf.fe.attached(modes, points=CORNERS), own)
    assert 0.005 < soft < 0.01
    assert abs(deformation - soft) <= 0.005
    assert forces <= 0.003


ROBOT = """
kind = "imported"
program = "nastran"
files = {{ op2 = "hexQ8.OP2", bulk = "hexQ8.bdf" }}
units = "SI"
modes = 9
ids = {ids}
origin = [0, 0, 0]
damping_ratio = 0.4
"""


def test_a_robot_file_takes_it(tmp_path, monkeypatch):
    """The same platform as by Python, in the paper's robot; and back from the file that `to_file` writes."""
    modes = nastran()
    body = pf.FlexibleBody.from_modes(modes, origin=(0, 0, 0), damping_ratio=0.4)
    path = tmp_path / "robot.toml"
    pf.robots.gough_stewart(platform=body).to_file(path)
    text = path.read_text()
    ids = [modes.ids[k] for k in modes.corners]
    path.write_text(text[: text.index("[platform]")] + "[platform]" + ROBOT.format(ids=ids))
    for name in ("hexQ8.OP2", "hexQ8.bdf"):
        (tmp_path / name).write_bytes((DATA / name).read_bytes())
    found = pf.load_robot(path).platform
    assert np.array_equal(found.shapes, body.shapes)
    assert np.array_equal(found.stiffness, body.stiffness)
    assert found.attachments == body.attachments
    for change, words in (
        (("hexQ8.OP2", "other.OP2"), r"robot.toml:\d+: platform: op2 .*other.OP2 cannot be read"),
        (('"SI"', '"in-lbf"'), r'platform.units is "in-lbf", which makes material 1'),
        (('"nastran"', '"abaqus"'), "platform.program is 'abaqus'; choose one of nastran"),
        ((f"ids = {ids}", "ids = [999999]"), r"platform.ids\[0\] has node 999999"),
    ):
        path.write_text(
            text[: text.index("[platform]")] + "[platform]" + ROBOT.format(ids=ids).replace(*change)
        )
        with pytest.raises(pf.InputError, match=words):
            pf.load_robot(path)


def test_the_command_takes_it(parflex, tmp_path):
    files = ("--file", f"op2={DATA / 'hexQ8.OP2'}", "--file", f"bulk={DATA / 'hexQ8.bdf'}")
    held = [word for corner in CORNERS[:3] for word in ("-a", ",".join(map(str, corner)))]
    code, out, err = parflex("modes", "--from", "nastran", *files, "--units", "SI", "--modes", "3", *held,
                             "--radius", "0.07")  # fmt: skip
    assert code == 0, err
    words = " ".join(out.split())
    assert "ΦᵀMΦ − 1 │ 6.7e-08 as read" in words
    assert "6 found and removed" in words
    assert (tmp_path / "parflex-modes" / "modes.h5").stat().st_size > 10_000
    assert (tmp_path / "parflex-modes" / "modes.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--from", "nastran"), "op2 is not given; nastran takes op2, bulk"),
        (("--from", "ansys"), "choose one of nastran"),
        (("--from", "nastran", "--file", "x.op2"), 'write it as "name=path"'),
        (("--from", "nastran", "--node", "one"), "give node numbers"),
        (("--from", "nastran", "-c", "0,0"), "--from imports modes; leave out"),
    ],
)  # fmt: skip
def test_the_command_says_what_is_wrong(parflex, tmp_path, words, told):
    code, _, err = parflex("modes", *words)
    assert code == 2
    assert told in " ".join(err.split())
    assert not list((tmp_path / "parflex-modes").glob("*"))
