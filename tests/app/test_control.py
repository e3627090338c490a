"""The commands say whether the control is stable, before the run and in the report."""

from pathlib import Path

import numpy as np

import parflex as pf
from heavy_disc import disc, on_struts

WAY = """\
format = "parflex-trajectory-1"
rest = [0.0, 0.05]
[[move]]
position = [0, 0, "2 mm"]
duration = "50 ms"
"""
TORQUE = '[controller]\nkind = "computed-torque"\nkp = 400\nkd = 40\n'


def files(robot: pf.Robot, control: str = "") -> None:
    """A robot file and a trajectory file in the folder."""
    robot.to_file("robot.toml")
    Path("way.toml").write_text(WAY + control)


def test_servos_are_the_default(parflex):
    files(pf.robots.rus6(modes=3))
    code, out, err = parflex("simulate", "robot.toml", "--trajectory", "way.toml", "--out", ".")
    assert code == 0, err
    assert "verdict servo: stable" in out
    assert out.index("verdict") < out.index("flying")
    assert "rms error of the actuated joints" in out
    data = pf.load_result("result.nc").dataset
    assert data.attrs["control"] == "servo"
    assert data.attrs["stable"] == 1
    code, out, err = parflex("report", "result.nc", "--out", "report.html")
    assert code == 0, err
    page = Path("report.html").read_text(encoding="utf-8")
    assert "servo: stable" in page
    assert "checks passed" in page
    assert "forces are plausible" in page


def test_a_platform_that_buckles_flies_on_computed_torque(parflex):
    files(pf.robots.gough_stewart(modes=9))
    code, out, err = parflex("simulate", "robot.toml", "--trajectory", "way.toml", "--out", ".")
    assert code == 0, err
    assert "computed torque is the default here: the platform buckles on its locked legs" in out
    assert "verdict computed torque: stable" in out
    code, out, err = parflex("check", "robot.toml")
    assert code == 0, err
    assert "buckles" in out


def test_what_diverges_is_told_first_and_reported_as_failed(parflex):
    files(on_struts(disc()), TORQUE)
    code, out, err = parflex("check", "robot.toml")
    assert code == 0, err
    assert "verdict servo: stable" in out
    assert "verdict computed torque: unstable" in out
    code, out, err = parflex("simulate", "robot.toml", "--trajectory", "way.toml", "--out", ".")
    assert code == 1
    assert out.index("verdict computed torque: unstable") < out.index("flying")
    assert "the motion diverges" in out
    assert "reach" not in out + err
    data = pf.load_result("result.nc").dataset
    assert data.attrs["stable"] == 0
    code, out, err = parflex("report", "result.nc", "--out", "report.html")
    assert code == 0, err
    page = Path("report.html").read_text(encoding="utf-8")
    head = page[: page.index("What was simulated")]
    assert "FAILED" in head
    assert "the run came to its end" in head
    assert "UNSTABLE" in head
    assert np.all(np.isfinite(data.position))


def test_gains_that_no_sampled_controller_bears(parflex):
    files(pf.robots.rus6(modes=0), '[controller]\nkind = "servo"\nkp = 1e9\nkd = 1e6\n')
    code, _, err = parflex("simulate", "robot.toml", "--trajectory", "way.toml", "--out", ".")
    assert code == 2
    assert "way.toml:8: " in err
    assert "at 4000 samples a second" in err
    assert "\n" not in err.strip()
