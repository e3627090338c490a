"""`parflex vibrate`: table, modes.nc, pictures, page, and what it refuses."""

import re

import numpy as np
import pytest
import xarray as xr

import parflex as pf
from parflex.simulation.holding import held, swinging


@pytest.fixture
def bends(parflex) -> pf.Robot:
    """A robot on cranks without springs, whose plate has three modes, in bends.toml."""
    robot = pf.robots.pus6(modes=3)
    robot.to_file("bends.toml")
    return robot


def words(text: str) -> str:
    return " ".join(text.split())


def told(out: str) -> np.ndarray:
    """Hz of the rows of the table."""
    rows = re.findall(r"^\W*(\d+)\W+([\d.]+(?:e[+-]\d+)?)\W", out, re.MULTILINE)
    return np.array([float(hertz) for _, hertz in rows])


def expected(robot: pf.Robot, motors: str) -> tuple[str, np.ndarray]:
    how, lin = held(pf.Model(robot, "numpy"), motors)
    modes = lin.modes()
    return how, modes.frequency.values[swinging(modes)]


def test_table_file_pictures_and_page(parflex, bends, tmp_path):
    code, out, err = parflex("vibrate", "bends.toml", "--out", "seen")
    assert code == 0, err
    how, hertz = expected(bends, "auto")
    assert how == "on locked motors"
    assert len(hertz) == 3  # motors stand still, so that what is left are the plate's three modes
    assert np.allclose(told(out), hertz, rtol=1e-4)
    text = words(out)
    assert f"the machine first resonates at {hertz[0]:.4g} Hz on locked motors" in text
    assert "most of the energy of deformation is in the platform" in text
    with xr.open_dataset("seen/modes.nc", engine="h5netcdf") as data:
        assert np.allclose(data.frequency, hertz)
        assert data.frequency.attrs["units"] == "Hz"
        assert dict(data.sizes)["part"] == 4
    for i in range(3):
        assert (tmp_path / "seen" / f"mode_{i + 1}.png").stat().st_size > 10_000
    page = (tmp_path / "seen" / "modes.html").read_text(encoding="utf-8")
    assert f"mode 1: {hertz[0]:.4g} Hz" in page
    assert "on locked motors" in page


@pytest.mark.parametrize("motors", ["locked", "servo"])
def test_motors_hold_as_they_are_told_to(parflex, bends, motors):
    code, out, err = parflex("vibrate", "bends.toml", "--motors", motors)
    assert code == 0, err
    how, hertz = expected(bends, motors)
    assert np.allclose(told(out), hertz[:20], rtol=1e-4)
    assert how in words(out)


def test_motors_with_springs_swing_on_them(parflex):
    bar = pf.Bar(mass=1e-3, outer=0.01, length=0.15)
    strut = pf.Strut(bar, bar, stiffness=1e6)
    robot = pf.robots.hexapod(
        base_radius=0.25, platform_radius=0.15, height=0.3, base_spread=0.4, platform_spread=0.5, strut=strut
    )
    robot.to_file("sprung.toml")
    tables = []
    for motors in ("auto", "springs"):
        code, out, err = parflex("vibrate", "sprung.toml", "--motors", motors, "--modes", "4")
        assert code == 0, err
        assert "on its motors' springs" in words(out)
        assert "most of the energy of deformation is in the drives" in words(out)
        tables.append(told(out))
    assert len(tables[0]) == 4
    assert np.array_equal(*tables)


def test_without_springs_nothing_swings_on_them(parflex, bends):
    """Motors that hold nothing let the platform fall where it likes; that is told as it is."""
    code, out, err = parflex("vibrate", "bends.toml", "--motors", "springs")
    assert code == 0, err
    assert "on its motors' springs" in words(out)


def test_an_unstable_robot_is_said_to_be(parflex):
    """Struts under a platform whose springs are too weak for its weight: g m/h beats k."""
    bar = pf.Bar(mass=1e-3, outer=0.01, length=0.15)
    strut = pf.Strut(bar, bar, stiffness=1.0)
    robot = pf.robots.hexapod(
        base_radius=0.25, platform_radius=0.15, height=0.3, base_spread=0.4, platform_spread=0.5, strut=strut
    )
    robot.to_file("weak.toml")
    code, out, err = parflex("vibrate", "weak.toml", "--out", "weak")
    assert code == 0, err
    how, lin = held(pf.Model(robot, "numpy"), "springs")
    growth = float(np.max(np.linalg.eigvals(lin.A).real))
    assert growth > 0
    assert f"unstable {how}: a motion grows e-fold in {1 / growth:.3g} s" in words(out)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--motors", "loose"], "--motors is 'loose'; choose one of auto, locked, springs, servo"),
        (["--modes", "0"], "--modes is 0; ask for at least one"),
        (["--format", "doc"], "doc"),
    ],
)
def test_bad_options(parflex, bends, options, said, tmp_path):
    code, _, err = parflex("vibrate", "bends.toml", *options)
    assert code == 2
    assert said in words(err)
    assert not (tmp_path / "parflex-vibrate").exists()


def test_a_typo_is_told_with_its_line(parflex, bends, tmp_path):
    text = (tmp_path / "bends.toml").read_text()
    assert "gravity" in text
    (tmp_path / "typo.toml").write_text(text.replace("gravity", "gravty", 1))
    line = next(k for k, row in enumerate(text.splitlines(), start=1) if "gravity" in row)
    code, _, err = parflex("vibrate", "typo.toml")
    assert code == 2
    assert f"line {line}" in words(err) or f":{line}" in words(err)
    assert "gravty" in err


def test_a_file_that_is_not_there(parflex):
    code, _, err = parflex("vibrate", "nowhere.toml")
    assert code == 2
    assert "nowhere.toml" in err


def test_without_k3d_there_is_no_page(parflex, bends, monkeypatch, tmp_path):
    monkeypatch.setattr("parflex.app.vibrate.find_spec", lambda name: None)
    code, _, err = parflex("vibrate", "bends.toml", "--out", "seen")
    assert code == 0, err
    assert (tmp_path / "seen" / "modes.nc").exists()
    assert not (tmp_path / "seen" / "modes.html").exists()


def test_reports_tell_the_modes_as_vibrate_does(parflex):
    """The table of the report of a run, row by row, is that of the command."""
    code, _, err = parflex("init", "hexapod.toml", "--robot", "hexapod")
    assert code == 0, err
    code, _, err = parflex(
        "simulate", "hexapod.toml", "--trajectory", "hexapod.trajectory.toml", "--out", "run"
    )
    assert code == 0, err
    code, _, err = parflex("report", "run/result.nc", "--out", "report.html")
    assert code == 0, err
    with open("report.html", encoding="utf-8") as file:
        report = file.read()
    how, lin = held(pf.Model(pf.load_robot("hexapod.toml"), "numpy"), "auto")
    modes = lin.modes()
    assert "Modes of the whole machine" in report
    assert f"At home, {how.replace(chr(39), '&#39;')}." in report
    for i in swinging(modes):
        assert f"<td>{i + 1}</td><td>{float(modes.frequency[i]):.5g}</td>" in report
    data = pf.load_result("run/result.nc").dataset
    assert data.machine_frequency.attrs["units"] == "Hz"
    assert np.allclose(data.machine_frequency, modes.frequency.values[swinging(modes)], rtol=1e-6)
