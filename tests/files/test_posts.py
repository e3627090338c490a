"""Robot files with posts, hinges and columns: read, checked, written again."""

import numpy as np
import pytest

import parflex as pf

TABLE = """
format = "parflex-robot-1"
mobility = 1
[platform]
kind = "rigid"
mass = 10
com = [0.25, 0, 0]
inertia = [0.1, 0.3, 0.4, 0, 0, 0]
attachments = [[0, 0.1, 0], [0, -0.1, 0], [0.5, 0, 0]]
[home]
position = [0, 0, 0]
[chain.post]
joints = []
tips = [{ frame = 0 }]
[chain.column]
joints = [
  { type = "revolute", alpha = "90 deg", mass = 1, inertia = [0.01, 0.01, 0.01, 0, 0, 0] },
  { type = "prismatic", actuated = true, alpha = "90 deg", mass = 0.5, com = [0, 0, -0.2] },
]
tips = [{ frame = 2 }]
[[leg]]
chain = "post"
origin = [0, 0.1, 0]
attachments = [0]
[[leg]]
chain = "post"
origin = [0, -0.1, 0]
attachments = [1]
[[leg]]
chain = "column"
origin = [0.5, 0, -0.6]
attachments = [2]
"""


@pytest.fixture
def path(tmp_path):
    file = tmp_path / "table.toml"
    file.write_text(TABLE, encoding="utf-8")
    return file


def test_posts_are_read_and_written(path, tmp_path):
    """Half of the table and the rod, which rides on the slide, rest on the column, and do so once written."""
    robot = pf.load_robot(path)
    assert [leg.word for leg in robot.legs] == ["post", "post", "RP*"]
    again = pf.load_robot(robot.to_file(tmp_path / "again.toml"))
    assert again.to_file(tmp_path / "third.toml").read_text() == (tmp_path / "again.toml").read_text()
    for each in (robot, again):
        forces = pf.Model(each, "numpy").equilibrium(*each.home_pose)[1]
        assert np.allclose(forces, 49.05 + 4.905, rtol=0, atol=1e-9)


def test_check_tells_of_posts(parflex, path):
    """Command and drawing."""
    code, out, err = parflex("check", str(path), "--out", "seen")
    assert code == 0, err
    assert "post" in out
    assert "1 freedoms" in out
    assert "none" in out  # their inverse geometry


def test_tips_of_posts_are_on_the_base(path):
    path.write_text(TABLE.replace("{ frame = 0 }", "{ frame = 1 }"), encoding="utf-8")
    with pytest.raises(pf.InputError, match=r"\d+: chain.post.tips\[0\].frame is 1; this leg has no links"):
        pf.load_robot(path)
