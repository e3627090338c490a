"""The report: it tells the result's numbers, and its checks fail where something is wrong."""

import re

import numpy as np
import pytest

import flexlegs
import parflex as pf
from parflex.views.report import report_of
from parflex.views.report.checks import checks_of


@pytest.fixture(scope="module")
def run(model_of) -> pf.Result:
    """A held robot that is pushed for 0.1 s."""
    model = model_of(4, "vm")
    start, forces = model.equilibrium(*model.robot.home_pose)
    hold = pf.JointPD(model, start, kp=2e5, kd=2e3, forces=forces)
    return pf.simulate(model, hold, start, np.linspace(0, 0.1, 41), wrenches=[pf.Wrench(0, (0, 0, -200))])


@pytest.fixture
def saved(run, tmp_path):
    return run.save(tmp_path / "result.nc")


def test_report_tells_the_numbers_of_the_result(run, saved):
    text = report_of(saved)
    data = run.dataset
    assert "http" not in re.sub(r"data:[^\"]+", "", text)
    assert f"{float(abs(data['forces']).max()):.5g} N" in text
    for omega in data["frequency"].values:
        assert f"<td>{omega:.2f}</td>" in text
    assert f"<td>{float(data['energy_strain'][-1]):.5g}</td>" in text
    for words in ("0.1 s, 41 instants", "6: RRP*", "Energy ledger", "Actuator forces", "CasADi"):
        assert words in text
    assert text.count('<span class="pass">passed</span>') == len(checks_of(data))
    assert f"all {len(checks_of(data))} checks passed" in text
    assert "FAILED" not in text


def test_the_robot_file_of_a_report_is_the_robot(run, tmp_path):
    """Its legs, read back, are those that were simulated; the platform is said to be beside it."""
    text = str(run.dataset["robot_file"].values)
    robot = pf.robots.gough_stewart(4)
    robot.to_file(tmp_path / "robot.toml")
    assert text == (tmp_path / "robot.toml").read_text()


SPOILED = {
    "numbers that are not finite": (
        "position",
        lambda v: np.where(np.arange(len(v))[:, None] > 30, np.nan, v),
    ),
    "rotation matrices": ("rotation", lambda v: 1.001 * v),
    "legs hold the platform": ("leg_path", lambda v: v + 1e-4),
    "pose and deformation agree": (
        "attachment_deformation",
        lambda v: v + 1e-6 * np.arange(len(v))[:, None, None],
    ),
    "energy balance": ("energy_residual", lambda v: v + 1e-3),
    "deformation is small": ("attachment_deformation", lambda v: 1e3 * v + 1.0),
}


@pytest.mark.parametrize("what", SPOILED)
def test_each_check_finds_what_it_is_for(run, what):
    name, spoil = SPOILED[what]
    data = run.dataset.copy(deep=True)
    assert all(check.passed for check in checks_of(data))
    data[name] = data[name].copy(data=spoil(data[name].values))
    assert what in [check.what for check in checks_of(data) if not check.passed]


def test_a_run_that_stopped_has_failed(run):
    data = run.dataset.copy()
    data.attrs["stopped"] = "at t = 0.01 s: it diverges"
    assert [check.what for check in checks_of(data) if not check.passed] == ["the run came to its end"]


def test_forces_beyond_what_a_rigid_platform_needs_have_failed(run):
    """A hundred times what it needs, where the run says what that is."""
    data = run.dataset.copy()
    for part, passed in ((1.0, True), (0.01, False)):
        data["rigid_forces"] = part * data["forces"]
        [check] = [check for check in checks_of(data) if check.what == "forces are plausible"]
        assert check.passed == passed


def test_checks_are_each_spoiled_once(run):
    told = [check.what for check in checks_of(run.dataset)]
    assert sorted(told) == sorted([*SPOILED, "the run came to its end", "strokes and joint limits are kept"])


def test_a_stroke_that_is_exceeded_has_failed(run):
    data = run.dataset.copy()
    data.attrs["beyond_limits"] = "leg 1, joint 3 was at 0.6 m … 0.8 m, beyond its limits 0.7 m … 1.6 m"
    [failed] = [check for check in checks_of(data) if not check.passed]
    assert failed.what == "strokes and joint limits are kept"
    assert "leg 1, joint 3" in failed.how


def test_reports_of_less(run, saved, tmp_path):
    """Without a mesh, without energies, partial: what is there is told, the rest is said to be missing."""
    data = run.dataset.drop_vars(["platform_triangle", "energy_residual", "frequency"])
    data.attrs |= {"partial": 1, "stopped": "at 0.05 s: <leg> 3 does not reach"}
    path = tmp_path / "less.nc"
    data.to_netcdf(path, engine="h5netcdf")
    text = report_of(path)
    assert "&lt;leg&gt; 3 does not reach" in text
    assert "No platform mesh" in text
    assert "natural frequencies (frequency)" in text


def test_what_is_no_run_is_refused(run, saved, tmp_path):
    run.dataset.isel(time=slice(0, 0)).to_netcdf(tmp_path / "empty.nc", engine="h5netcdf")
    with pytest.raises(pf.InputError, match="holds no run"):
        report_of(tmp_path / "empty.nc")
    (tmp_path / "cut.nc").write_bytes(saved.read_bytes()[:5000])
    with pytest.raises(pf.InputError, match="is truncated: 5000 of its"):
        report_of(tmp_path / "cut.nc")
    with pytest.raises(pf.InputError, match=r"did you mean .*result\.nc"):
        report_of(tmp_path / "reslut.nc")


def test_report_of_legs_that_bend(tmp_path):
    """The frequencies of the links, once for legs that are alike, and how far the legs go."""
    robot = flexlegs.robot("gs_flexlegs")
    model = pf.Model(robot)
    run = pf.simulate(model, np.zeros(6), robot.home, [0, 1e-3, 2e-3], rtol=1e-6)
    text = report_of(run.save(tmp_path / "run.nc"))
    assert "Modes of the legs" in text
    assert "<td>1, 2, 3, 4, 5, 6</td><td>2</td><td>193.94, 193.94, 1252.9</td>" in text
    moved = np.linalg.norm(run.dataset["leg_deformation"].values, axis=-1).max(axis=(0, 2))
    worst = int(run.dataset["path_leg"].values[np.argmax(moved)])
    assert f"{1e3 * moved.max():.5g} mm (leg {worst})" in text
    assert "6: RRP* (* driven)" in text
