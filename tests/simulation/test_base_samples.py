"""Samples of the base: the motion through them, and what they refuse."""

import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import parflex as pf
from parflex.simulation.surroundings.jumps import first_jump

T = np.linspace(0.0, 2.0, 2001)
STEP = 1e-4
DIFFERENCES = 1e-5  # of the same functions by steps of 1e-4, third derivatives being up to 1e3
THROUGH = 1e-6  # second derivatives of splines through samples a 1/300 of a period apart, m/s² and rad/s²


def place(t):
    return np.stack([1e-3 * np.sin(30 * t), 2e-3 * np.sin(20 * t + 1), 1e-3 * np.cos(10 * t)], axis=-1)


def speed(t):
    return np.stack([0.03 * np.cos(30 * t), 0.04 * np.cos(20 * t + 1), -0.01 * np.sin(10 * t)], axis=-1)


def growth(t):
    return -place(t) * [900, 400, 100]


def turn(t):
    return np.stack([0.3 * np.sin(5 * t), 0.2 * np.sin(7 * t), 0.4 * np.sin(3 * t)], axis=-1)


@pytest.fixture(scope="module")
def shaken():
    return pf.BaseSamples(T, place(T), turn(T))


@pytest.fixture(scope="module")
def times():
    return np.random.default_rng(0).uniform(0.1, 1.9, 50)


def test_translation_is_that_of_the_function(shaken, times):
    found = shaken(times)
    assert np.allclose(found.position, place(times), rtol=0, atol=1e-12)
    assert np.allclose(found.twist[:, :3], speed(times), rtol=0, atol=1e-9)
    assert np.allclose(found.acceleration[:, :3], growth(times), rtol=0, atol=THROUGH)


def test_rotation_is_that_of_the_vectors(shaken, times):
    found = shaken(times).rotation
    assert np.allclose(found, Rotation.from_rotvec(turn(times)).as_matrix(), rtol=0, atol=1e-11)
    assert np.array_equal(np.stack([shaken(t).rotation for t in times[:3]]).round(14), found[:3].round(14))


@pytest.mark.parametrize("scale", [1.0, 8.0])  # by the series, and by the closed form beyond one radian
def test_twist_and_acceleration_are_the_rates_of_the_pose(times, scale):
    """ω̂ = Ṙ Rᵀ and the rates of ω, by central differences."""
    samples = pf.BaseSamples(T, place(T), scale * turn(T))
    before, now, after = (samples(times + s) for s in (-STEP, 0, STEP))
    spin = (after.rotation - before.rotation) / (2 * STEP) @ np.swapaxes(now.rotation, -1, -2)
    omega = np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]], axis=-1)
    assert np.allclose(now.twist[:, 3:], omega, rtol=0, atol=scale**3 * DIFFERENCES)
    rates = (after.twist - before.twist) / (2 * STEP)
    assert np.allclose(now.acceleration, rates, rtol=0, atol=scale**4 * DIFFERENCES)


def test_velocities_are_integrated_from_the_origin(shaken, times):
    own = shaken(T)
    found = pf.BaseSamples(T, velocity=own.twist[:, :3], angular_velocity=own.twist[:, 3:])(times)
    wanted = shaken(times)
    assert np.allclose(found.position, wanted.position - own.position[0], rtol=0, atol=1e-11)
    assert np.allclose(found.rotation @ own.rotation[0], wanted.rotation, rtol=0, atol=1e-11)
    assert np.allclose(found.acceleration, wanted.acceleration, rtol=0, atol=THROUGH)


def test_accelerations_are_integrated_from_rest(shaken, times):
    own = shaken(T).acceleration
    found = pf.BaseSamples(T, acceleration=own[:, :3], angular_acceleration=0.1 * own[:, 3:])
    now, start = found(times), found(0.0)
    assert np.allclose(np.append(start.position, start.twist), 0, rtol=0, atol=1e-12)
    wanted = shaken(times).acceleration * [1, 1, 1, 0.1, 0.1, 0.1]
    assert np.allclose(now.acceleration, wanted, rtol=0, atol=10 * THROUGH)
    placed = place(times) - place(0) - np.outer(times, speed(0))
    assert np.allclose(now.position, placed, rtol=0, atol=1e-10)


def test_one_axis_turns_as_far_as_it_likes():
    """2 rad/s for ten seconds."""
    t = np.linspace(0, 10, 101)
    found = pf.BaseSamples(t, angular_velocity=np.tile([0, 0, 2.0], (101, 1)))(7.3)
    assert np.allclose(found.rotation, Rotation.from_rotvec([0, 0, 14.6]).as_matrix(), rtol=0, atol=1e-12)
    assert np.allclose(found.twist, [0, 0, 0, 0, 0, 2.0], rtol=0, atol=1e-12)


def test_samples_need_not_be_evenly_apart(times):
    uneven = np.sort(np.append(np.random.default_rng(1).uniform(0, 2, 3000), [0.0, 2.0]))
    found = pf.BaseSamples(uneven, place(uneven))(times)
    assert np.allclose(found.position, place(times), rtol=0, atol=1e-9)


def honest(seed):
    """Sums of sines of up to a third of the rate of the samples, evenly apart or not."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(6, 400))
    t = np.sort(rng.uniform(0, 1, n)) if seed % 2 else np.linspace(0, 1, n)
    parts = [
        rng.normal() * np.sin(2 * np.pi * rng.uniform(0.1, n / 3) * t + rng.uniform(0, 6)) for _ in range(4)
    ]
    return t, sum(parts)


def test_honest_shaking_is_no_jump():
    assert [seed for seed in range(500) if first_jump(*honest(seed)) is not None] == []
    for noise in (
        np.random.default_rng(2).normal(size=5000),
        np.cumsum(np.random.default_rng(3).normal(size=5000)),
    ):
        assert first_jump(np.arange(5000.0), noise) is None


@pytest.mark.parametrize("samples", [4, 8, 40, 400])
def test_a_smooth_step_of_some_samples_is_no_jump(samples):
    """A polynomial of fifth order from rest to rest, in so many samples."""
    x = np.clip((np.arange(1000.0) - 300) / samples, 0, 1)
    assert first_jump(np.arange(1000.0), x**3 * (10 - 15 * x + 6 * x * x)) is None


@pytest.mark.parametrize("shaking", [0.0, 1e-5, 3e-4])
def test_a_jump_is_said_with_its_time(shaking):
    moved = shaking * np.sin(30 * T) + np.where(T < 1.2, 0.0, 1e-3)
    with pytest.raises(
        pf.InputError, match=r"BaseSamples.position jumps at t = 1.2 s: y goes from .* no derivative"
    ):
        pf.BaseSamples(T, np.outer(moved, [0, 1, 0]))


def test_a_sample_that_is_out_of_the_way_is_a_jump():
    moved = 1e-3 * np.sin(30 * T)
    moved[777] += 1e-3
    with pytest.raises(pf.InputError, match=r"rotation jumps at t = 0.777 s: rz goes"):
        pf.BaseSamples(T, rotation=np.outer(moved, [0, 0, 1]))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"t": T[:5]}, r"have 5 samples; give 6 or more"),
        ({"t": np.append(T, 1.0)}, r"t does not increase at t = 1 s; give each time once"),
        ({"t": T, "position": place(T)[1:]}, r"position has 2000 rows for 2001 times"),
        ({"t": T, "position": place(T)[:, :2]}, r"position has shape \(2001, 2\); expected \(n, 3\)"),
        (
            {"t": T, "position": np.where(T[:, None] == 1, np.nan, place(T))},
            r"position is nan at index \(1000, 0\)",
        ),
        (
            {"t": T, "position": place(T), "velocity": speed(T)},
            r"give position and velocity along x; keep one",
        ),
        (
            {"t": T, "rotation": turn(T), "angular_velocity": turn(T)},
            r"give rotation and angular_velocity; keep",
        ),
        (
            {"t": T, "angular_velocity": 30 * turn(T)},
            r"turn by more than 3 rad about several axes, at t = .* s",
        ),
    ],
)
def test_bad_samples_are_refused(arguments, words):
    with pytest.raises(pf.InputError, match=words):
        pf.BaseSamples(**arguments)


def test_no_time_outside_the_samples(shaken):
    assert np.allclose(shaken(2.0 + 1e-12).position, place(2.0), rtol=0, atol=1e-9)
    with pytest.raises(
        pf.InputError, match=r"go from t = 0 to 2 s, and t = 2.1 s is asked for; give samples for"
    ):
        shaken([0.1, 2.1])


def written(folder, text):
    path = folder / "floor.csv"
    path.write_text(text)
    return path


def table(head, *columns):
    return "\n".join(
        [head, *(", ".join(f"{value:.17g}" for value in row) for row in zip(*columns, strict=True))]
    )


def test_files_have_units(tmp_path):
    x, ry, az = 3.0 * np.sin(9 * T), np.sin(5 * T), 0.1 * np.cos(4 * T)
    text = table("# of the second floor\n\nt [ms], x [mm], ry [mrad], az [g]", 1e3 * T, x, ry, az)
    found = pf.BaseSamples.from_file(written(tmp_path, text))
    assert np.allclose(found.t, T, rtol=0, atol=1e-15)
    assert np.allclose(found.position[:, 0], 1e-3 * x, rtol=0, atol=1e-17)
    assert np.allclose(found.rotation, np.outer(1e-3 * ry, [0, 1, 0]), rtol=0, atol=1e-17)
    assert np.allclose(found.acceleration[:, 2], 9.80665 * az, rtol=1e-15, atol=0)
    assert "x, ry, az" in repr(found)


@pytest.mark.parametrize("mark", [",", ";", "\t"])
def test_columns_are_set_apart_by_what_is_usual(tmp_path, mark):
    text = table("t [s], vx [mm/s], omegaz [deg/s], alphay [rad/s^2]", T, T, 0 * T, 0 * T).replace(", ", mark)
    found = pf.BaseSamples.from_file(written(tmp_path, "\ufeff" + text.replace("\n", f"{mark}\r\n")))
    assert np.allclose(found(1.0).position, [0.5e-3, 0, 0], rtol=0, atol=1e-15)


ROWS = "".join(f"0.{k},0\n" for k in range(9))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", r"floor.csv is empty; begin it with a header like t \[s\], x \[mm\]"),
        (
            f"t [s],x\n{ROWS}",
            r"floor.csv:1: column x has no unit; write x \[m\], or another unit of a length",
        ),
        (f"t [s],x []\n{ROWS}", r"floor.csv:1: column x has no unit"),
        (f"t [s],x [deg]\n{ROWS}", r'floor.csv:1: the unit of column x is "deg", which is not a length'),
        (f"t [s],ax [m/s]\n{ROWS}", r"floor.csv:1: the unit of column ax .* not an acceleration"),
        (f"t [s],x [furlongz]\n{ROWS}", r'"furlongz" is no unit'),
        (f"t [s],x [{'m*' * 99}m]\n{ROWS}", r"floor.csv:1: the unit of column x is "),
        (f"t [s],xx [m]\n{ROWS}", r'floor.csv:1: column "xx" is not known; did you mean x?'),
        (f"t [s],q [m]\n{ROWS}", r'floor.csv:1: column "q" is not known; '),
        ("t [s],x [m],x [m]\n", r"floor.csv:1: column x is there twice; keep one"),
        (f"x [m],t [s]\n{ROWS}", r'floor.csv:1: the first column is "x"; begin with t \[s\]'),
        (f"t [s],x [m]\n{ROWS}0.9\n", r"floor.csv:11: this row has 1 values; the header names 2 columns"),
        (f"t [s],x [m]\n{ROWS}0.9,abc\n", r'floor.csv:11: x is "abc"; write a number'),
        (f"t [s],x [m]\n{ROWS}0.9,nan\n", r"floor.csv:11: x is nan; leave such rows out"),
        (f"t [s],x [m]\n{ROWS}\n0.5,0\n", r"floor.csv:12: t is 0.5, not later than 0.8 before it"),
        ("t [s],x [m]\n0,0\n", r"floor.csv: BaseSamples have 1 sample; give 6 or more"),
        (f"t [s],x [m]\n{ROWS}0.9,1\n1,1\n1.1,1\n", r"floor.csv: BaseSamples.position jumps at t = 0.9 s"),
    ],
)
def test_bad_files_are_refused_with_their_line(tmp_path, text, words):
    with pytest.raises(pf.InputError, match=words) as caught:
        pf.BaseSamples.from_file(written(tmp_path, text))
    assert "\n" not in str(caught.value)


def test_a_file_that_is_not_there(tmp_path):
    written(tmp_path, "")
    with pytest.raises(pf.InputError, match=r"floor.cvs: there is no such file; did you mean .*floor.csv\?"):
        pf.BaseSamples.from_file(tmp_path / "floor.cvs")


def test_bytes_that_are_no_text(tmp_path):
    path = tmp_path / "floor.csv"
    path.write_bytes(b"\x00\xff\xfe")
    with pytest.raises(pf.InputError, match=re.escape("is no text in UTF-8; a file of samples is")):
        pf.BaseSamples.from_file(path)
