"""Homes of robots of few freedoms in files: on the closure, off it by decimals, and off it."""

import re
from pathlib import Path

import numpy as np
import pytest

import parflex as pf

HOME = 'position = [0, 0, "300 mm"]'
TYPES = {
    "RPS": 'cylinder = { mass = "0.3 kg", length = "220 mm" }\nrod = { mass = "0.2 kg", length = "200 mm" }',
    "PRS": 'carriage = "0.5 kg"\nrod = { mass = "0.2 kg", length = "320 mm" }',
}


def file_of(folder, kind: str, decimals: int, home: str = HOME) -> Path:
    """The path of three legs of a kind, 120° apart, their places to so many decimals of a millimetre."""
    angles = np.radians([0, 120, 240])
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    feet, heads = (
        [[f"{x:.{decimals}f} mm" for x in point] for point in radius * ring] for radius in (250, 150)
    )
    legs = "".join(
        f"[[leg]]\nchain = 'a'\norigin = {[*foot, 0]}\nrotation = [0, 0, '{turn} deg']\nattachments = [{k}]\n"
        for k, (foot, turn) in enumerate(zip(feet, (0, 120, 240), strict=True))
    )
    platform = (
        f"mass = 4\ninertia = [0.02, 0.02, 0.04, 0, 0, 0]\nattachments = {[[*head, 0] for head in heads]}"
    )
    text = f'format = "parflex-robot-1"\n[home]\n{home}\n[chain.a]\ntype = "{kind}"\n{TYPES[kind]}\n'
    path = folder / "robot.toml"
    path.write_text(f'{text}[platform]\nkind = "rigid"\n{platform}\n{legs}', encoding="utf-8")
    return path


@pytest.mark.parametrize("kind", TYPES)
@pytest.mark.parametrize("decimals", [2, 3, 4])
def test_decimals_keep_no_robot_from_its_home(kind, decimals, parflex, tmp_path):
    """Three millionths of a millimetre and more; the home is moved by as little, and is one of the robot."""
    robot = pf.load_robot(file_of(tmp_path, kind, decimals))
    assert np.linalg.norm(robot.home_pose[0] - [0, 0, 0.3]) < 10.0**-decimals * 1e-3
    assert np.linalg.norm(robot.home_pose[1] - np.eye(3)) < 10.0**-decimals * 1e-2
    assert pf.Model(robot, "numpy").equilibrium(*robot.home_pose)[1].shape == (3,)
    assert parflex("check", "robot.toml")[0] == 0


@pytest.mark.parametrize("kind", TYPES)
def test_a_home_on_the_closure_is_kept_to_the_bit(kind, tmp_path):
    place, turn = pf.load_robot(file_of(tmp_path, kind, 5)).home_pose
    assert place.tolist() == [0, 0, 0.3]
    assert turn.tolist() == np.eye(3).tolist()


@pytest.mark.parametrize("kind", TYPES)
@pytest.mark.parametrize("home", ['position = ["3 mm", 0, "300 mm"]', HOME + '\nrotation = [0, 0, "2 deg"]'])
def test_the_remedy_for_a_home_that_the_legs_do_not_allow_works(kind, home, parflex, tmp_path):
    file_of(tmp_path, kind, 5, home)
    code, _, err = parflex("check", "robot.toml")
    words = " ".join(err.split())
    assert code == 2
    assert re.search(r"robot.toml:2: home: at home a gap of \d\S* mm remains between leg \d and its", words)
    place, turn = re.search(r"nearest home, (position = \[.*?\]), (rotation = \[.*?\])", words).groups()
    file_of(tmp_path, kind, 5, f"{place}\n{turn}")
    code, _, err = parflex("check", "robot.toml")
    assert (code, err) == (0, "")


def test_a_leg_that_cannot_reach_is_named(parflex, tmp_path):
    path = file_of(tmp_path, "PRS", 5)
    path.write_text(path.read_text(encoding="utf-8").replace('"320 mm"', '"50 mm"'), encoding="utf-8")
    code, _, err = parflex("check", "robot.toml")
    assert code == 2
    assert " ".join(err.split()).startswith(
        "error robot.toml:2: home: at home leg 1 cannot reach its attachment; move the home pose"
    )
