"""The files that `parflex init` writes: each robot stands, and flies the trajectory beside it."""

from importlib.resources import files

import numpy as np
import pytest

import parflex as pf
from parflex.app.templates.starts import STARTS
from parflex.model.core import core_of

GALLERY = ("rus6", "pus6", "rps3", "prs3", "delta", "octapod", "nano-hexapod")
ROUNDED = 2e-7  # m, rad: numbers in the files have seven digits
QUICK = ("hexapod",)  # the others fly when slow tests do


def started(parflex, name):
    code, _, err = parflex("init", f"{name}.toml", "--robot", name)
    assert code == 0, err
    return f"{name}.toml", f"{name}.trajectory.toml"


def test_every_file_of_the_folder_is_a_start():
    there = {file.name for file in files("parflex.app.templates").iterdir() if file.name.endswith(".toml")}
    assert there == {f"{name}.toml" for name in STARTS} | {"trajectory.toml"}


def test_help_lists_them(parflex):
    _, out, _ = parflex("init", "--help")
    words = " ".join(out.replace("│", " ").split())
    assert ", ".join(STARTS) in words


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=() if n in QUICK else pytest.mark.slow) for n in STARTS]
)
def test_it_checks_and_flies(parflex, name):
    robot, trajectory = started(parflex, name)
    code, out, err = parflex("check", robot, "--out", "seen")
    assert code == 0, err
    assert "warning" not in err
    code, out, err = parflex("simulate", robot, "--trajectory", trajectory, "--out", "run")
    assert code == 0, err
    assert "largest actuator force" in out
    result = pf.load_result("run/result.nc")
    assert not result.partial
    assert not result.dataset.attrs.get("beyond_limits")
    assert np.max(np.abs(result.dataset.forces)) < most(pf.load_robot(robot))


def most(robot: pf.Robot) -> float:
    """N, and N m less: twenty times the weight, or what a piezo stack's own stiffness takes for 0.15 mm."""
    stack = max(joint.k for leg in robot.legs for joint in leg.joints)
    return max(20 * 9.81 * robot.platform.moments.m, 150e-6 * stack)


@pytest.mark.parametrize("name", GALLERY)
def test_it_is_the_robot_of_the_gallery(parflex, name):
    """Joints at home, masses and the plate of the file are those of `pf.robots`, which has its own tables."""
    robot, _ = started(parflex, name)
    found, expected = pf.load_robot(robot), getattr(pf.robots, name.replace("-", "_"))()
    models = [pf.Model(each, "numpy") for each in (found, expected)]
    joints = [model.joints(model.robot.home).q for model in models]
    assert np.max(np.abs(np.array(joints[0]) - joints[1])) < ROUNDED
    masses = [[joint.M for leg in each.legs for joint in leg.joints] for each in (found, expected)]
    assert np.allclose(*masses, rtol=1e-3)
    assert np.allclose(found.platform.frequencies, expected.platform.frequencies, rtol=1e-5)
    assert found.platform.modes == expected.platform.modes
    if name == "nano-hexapod":  # its springs, by all frequencies
        free = [np.abs(core_of(model).at_home.free_poles()) for model in models]
        assert np.allclose(*np.sort(free), rtol=1e-5)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("hexpod", "--robot is 'hexpod', which is not known; did you mean hexapod? There are gough-stewart"),
        ("biped", "--robot is 'biped', which is not known; there are gough-stewart, hexapod"),
    ],
)
def test_unknown_names_are_told(parflex, tmp_path, name, words):
    code, _, err = parflex("init", "other", "--robot", name)
    assert code == 2
    assert words in " ".join(err.split())
    assert not list(tmp_path.iterdir())
