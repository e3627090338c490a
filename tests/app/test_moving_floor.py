"""The table [base] of a trajectory file: samples of a floor that shakes."""

import re

import numpy as np
import pytest

import parflex as pf

PLAN = """format = "parflex-trajectory-1"
rest = [0, 0.02]
sample_time = "2 ms"
{more}
[[move]]
position = [0, 0, "2 mm"]
duration = "40 ms"

[base]
file = "floor.csv"
{law}"""


@pytest.fixture
def folder(tmp_path):
    pf.robots.rps3().to_file(tmp_path / "robot.toml")
    return tmp_path


def floor(folder, x, tilt=None, seconds=0.1):
    """A file of samples: x in mm, and a tilt about y in mrad, as functions of time."""
    t = np.linspace(0, seconds, 101)
    rows = zip(t, x(t), 0 * t if tilt is None else tilt(t), strict=True)
    lines = ["t [s], x [mm], ry [mrad]", *(f"{a:.6f}, {b:.9f}, {c:.9f}" for a, b, c in rows)]
    (folder / "floor.csv").write_text("\n".join(lines))


def shaking(t):
    return np.sin(40 * t) ** 3


def plan(folder, more="", law=""):
    (folder / "plan.toml").write_text(PLAN.format(more=more, law=law))


def flown(parflex):
    code, out, err = parflex("simulate", "robot.toml", "--trajectory", "plan.toml", "--out", "run")
    assert code == 0, out + err
    return out, pf.load_result("run/result.nc").dataset


def test_a_floor_that_shakes(parflex, folder):
    floor(folder, shaking)
    plan(folder)
    out, data = flown(parflex)
    assert np.allclose(data["base_position"].values[:, 0], 1e-3 * shaking(data["time"].values), atol=1e-8)
    assert "largest acceleration of the base" in out
    assert (folder / "run" / "base.png").exists()
    residual = np.max(np.abs(data["energy_residual"].values))
    assert residual <= 1e-6 * np.ptp(data["energy_base"].values)  # tolerances are those of files


@pytest.mark.parametrize("start", ["equilibrium", "home"])
def test_the_start_stands_on_the_base(parflex, folder, start):
    """A floor that is displaced and tilted from the beginning: servos keep to what is seen from it."""
    floor(folder, lambda t: 50 + 0 * t, lambda t: 30 + 0 * t)
    plan(folder, f'start = "{start}"')
    _, data = flown(parflex)
    home = pf.robots.rps3().home
    assert np.allclose(data["relative_position"].values[0], home.position, rtol=0, atol=1e-12)
    assert np.allclose(data["base_position"].values[0], [0.05, 0, 0], rtol=0, atol=1e-12)
    assert np.max(np.abs(data["pose_error"].values)) < 2e-4  # m, rad: the weight of a tilted robot, at 20 Hz


def test_computed_torque_begins_where_the_base_is(parflex, folder):
    floor(folder, lambda t: 50 + 0 * t)
    law = '\n[controller]\nkind = "computed-torque"\nkp = 400\nkd = 40\nrows = [2, 3, 4]\n'
    plan(folder, law=law)
    _, data = flown(parflex)
    assert np.max(np.abs(data["pose_error"].values)) < 1e-6


@pytest.mark.parametrize(
    ("samples", "words"),
    [
        ("t [s], x\n0, 0\n", "plan.toml:10: base.file: floor.csv:1: column x has no unit"),
        ("t [s], x [mm]\n0, 0\n", "plan.toml:10: base.file: .*BaseSamples have 1 sample; give 6 or more"),
        (
            "t [s], x [mm]\n" + "".join(f"{k / 10}, {int(k > 5)}\n" for k in range(20)),
            "plan.toml:10: base.file: .*floor.csv: BaseSamples.position jumps at t = 0.6 s: x goes from 0 to",
        ),
        (None, "plan.toml:10: base.file: .*floor.csv: there is no such file"),
    ],
)
def test_samples_that_cannot_be_are_refused_with_the_line(parflex, folder, samples, words):
    if samples is not None:
        (folder / "floor.csv").write_text(samples)
    plan(folder)
    code, _, err = parflex("simulate", "robot.toml", "--trajectory", "plan.toml", "--out", "run")
    assert code == 2
    assert re.search(words, err), err


def test_a_floor_that_ends_before_the_run(parflex, folder):
    floor(folder, shaking, seconds=0.05)
    plan(folder)
    code, _, err = parflex("simulate", "robot.toml", "--trajectory", "plan.toml", "--out", "run")
    assert code == 2
    assert "base samples go from t = 0 to 0.05 s, and t = 0.06 s is asked for" in err
