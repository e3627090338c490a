"""The frequencies that `parflex check` tells: on the motors' springs, or on locked motors."""

import re
from math import radians

import numpy as np

import parflex as pf

STIFFNESS = 2e6  # N/m, of each strut
LIGHT = pf.Bar(mass=1e-5, outer=0.01, length=0.15)
SIZES = {"base_radius": 0.25, "platform_radius": 0.15, "height": 0.3}
SPREADS = {"base_spread": radians(20), "platform_spread": radians(30)}
TOLD = 1e-3  # four digits are written, and legs weigh 1e-5 kg


def swings(parflex, file) -> tuple[str, np.ndarray]:
    """How the robot of a file is held, and its frequencies in Hz; empty where `check` tells none."""
    code, out, err = parflex("check", file)
    assert code == 0, err
    found = re.findall(r"swings at home, (.*?): ([\d., e+]+) Hz", " ".join(out.split()))
    if not found:
        return "", np.zeros(0)
    ((how, values),) = found
    return how, np.array([float(value) for value in values.split(",")])


def test_on_springs(parflex):
    """Those of a rigid platform on massless struts: k Σ J Jᵀ, with Plücker coordinates J of the struts."""
    strut = pf.Strut(LIGHT, LIGHT, stiffness=STIFFNESS)
    robot = pf.robots.hexapod(**SIZES, **SPREADS, strut=strut)
    pf.Robot(robot.legs, robot.platform, (0, 0, 0), robot.home_pose).to_file("sprung.toml")
    how, found = swings(parflex, "sprung.toml")
    heads = robot.platform.attachment_points
    along = heads + robot.home.position - [leg.origin for leg in robot.legs]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    J = np.hstack([along, np.cross(heads, along)])
    moments = robot.platform.moments
    mass = np.diag([moments.m] * 3 + list(np.trace(moments.P0) - np.diag(moments.P0)))
    expected = np.sqrt(np.linalg.eigvals(np.linalg.solve(mass, STIFFNESS * J.T @ J)).real) / (2 * np.pi)
    assert how == "on its springs"
    assert np.allclose(found, np.sort(expected), rtol=TOLD)


def test_on_locked_motors(parflex):
    """Without springs motors are locked, and what bends swings; of a rigid robot nothing does."""
    pf.robots.pus6(modes=3).to_file("bends.toml")
    how, found = swings(parflex, "bends.toml")
    assert how == "on locked motors"
    assert len(found) == 3
    pf.robots.pus6(modes=0).to_file("rigid.toml")
    assert swings(parflex, "rigid.toml")[0] == ""
