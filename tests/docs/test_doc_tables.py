"""The tables of robot files that the documentation shows, each in the file of a whole robot."""

import re
import tomllib
from pathlib import Path

import given
import numpy as np
import pytest

import parflex as pf
from paper_robot import PLATE, corners
from parflex.files.robot_writing import robot_text
from places import DOCS


def tables(page: str) -> list[dict]:
    """The platforms in a page's TOML: a table, or alternatives line by line."""
    (text,) = re.findall(r"```toml\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), re.DOTALL)
    parts = [text] if text.startswith("[") else text.splitlines()
    return [tomllib.loads(part)["platform"] for part in parts]


def loaded(robot: pf.Robot, table: dict, folder: Path) -> pf.Robot:
    (folder / "robot.toml").write_text(robot_text(robot, table))
    return pf.load_robot(folder / "robot.toml")


def test_imported_platform(tmp_path):
    given.nastran(tmp_path)
    (table,) = tables("importing.md")
    assert loaded(pf.robots.gough_stewart(0), table, tmp_path).platform.modes == table["modes"]


@pytest.mark.slow
def test_modal_file_and_step_file(tmp_path):
    pytest.importorskip("netgen.occ")
    modal, solid = tables("platforms.md")
    (tmp_path / modal["file"]).parent.mkdir()
    pf.fe.write_modes(pf.fe.plate_modes(corners(), n_modes=3, **PLATE), tmp_path / modal["file"])
    assert loaded(pf.robots.gough_stewart(0), modal, tmp_path).platform.modes == 3
    given.step(tmp_path)
    found = loaded(pf.robots.rps3(), solid, tmp_path).platform
    assert found.modes > 3
    held, wanted = found.nodes[list(found.attachments)], np.array(solid["attachments"])
    assert np.allclose(held - held[0], wanted - wanted[0], rtol=0, atol=1e-9)  # wherever the frame lies


def test_materials_are_those_of_the_table():
    page = (DOCS / "platforms.md").read_text(encoding="utf-8")
    for made in pf.fe.MATERIALS.values():
        numbers = f"{made.young / 1e9:g} | {made.poisson:g} | {made.density:g}"
        assert f"| {made.name} | {numbers} | {made.source} |" in page
    rows = re.findall(r"^\| [^|]+ \| [\d.]+ \| [\d.]+ \| \d+ \| ", page, re.MULTILINE)
    assert len(rows) == len(pf.fe.MATERIALS)
