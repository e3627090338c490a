"""The paper: its tables decoded, its equations housed, its Section 6 flown."""

import re
from pathlib import Path

import equations
import numpy as np
import pytest
from matplotlib.image import imread

import oracle
import paper_robot as source
import parflex as pf
from measures import relative
from parflex.app import paper

SOURCES = Path(pf.__file__).parent
EQUATIONS = range(1, 50)


def test_every_equation_has_a_home():
    """The tags "# Eq. n" in the sources are Eqs. 1 … 49, but those said to be unused, and none else."""
    found: dict[int, str] = {}
    for path in SOURCES.rglob("*.py"):
        for tag in re.findall(r"# Eqs?\. ([\d, ]+)", path.read_text()):
            for number in re.findall(r"\d+", tag):
                found[int(number)] = path.name
    unused = {each.number for each in equations.every_equation() if each.unused}
    assert sorted({*found, *unused}) == list(EQUATIONS)
    assert not unused & set(found)


def test_printed_equations_are_all_there():
    """The documentation's list has each number once, in the paper's order, and the code that goes with it."""
    assert [each.number for each in equations.every_equation() if each.number] == list(EQUATIONS)
    assert equations.contradictions(equations.every_equation(), equations.lines()) == []


def test_an_equation_without_code_is_noticed():
    """And one that is in the code though said to be unused, and a number that is not the paper's."""
    rows, lines = equations.every_equation(), equations.lines()
    tagged = {50 if n == 7 else n: at for n, at in lines.items()}
    wrong = equations.contradictions(rows, tagged)
    assert [words.split(" is ")[0] for words in wrong] == ["Eq. 50", "Eq. 7"]
    unused = [each._replace(unused="why not") if each.number in (7, 8) else each for each in rows]
    wrong = equations.contradictions(unused, tagged)
    assert [words.split(" is ")[0] for words in wrong] == ["Eq. 50", "Eq. 8"]


def test_table_4_puts_the_corners_on_a_hexagon():
    """Forward geometry of the printed joint values against the hexagon of side 0.5 m at z = 1."""
    for i, (R, origin) in enumerate(source.base_frames()):
        q1, q2, q3 = (source.TABLE_4[f"q_{j}"][i] for j in (1, 2, 3))
        axis = np.array([np.cos(q1) * np.sin(q2), -np.cos(q2), -np.sin(q1) * np.sin(q2)])
        corner = np.append(source.corners()[i], 0) + source.HOME
        assert np.max(np.abs(origin + q3 * R @ axis - corner)) <= 1.5e-3  # the table is rounded


def test_home_joints_are_those_of_table_4(model_of):
    """Inverse geometry at home; the table has three digits."""
    model = model_of(0)
    for i, q in enumerate(model.joints(model.robot.home).q):
        printed = [source.TABLE_4[f"q_{j}"][i] for j in (1, 2, 3)]
        assert np.max(np.abs(q - printed)) <= 1.5e-3


def test_mass_of_the_plate_is_the_printed_one(model_of):
    """73.069 kg in Sec. 6.1; 73.0709 kg is ρ h (3√3/2) s²."""
    assert model_of(0).robot.platform.moments.m == pytest.approx(73.069, rel=5e-5)


def test_run_follows_its_trajectory(flown):
    error = np.abs(flown.result.dataset.pose_error.values)
    assert not flown.result.partial
    assert np.max(error) <= 1e-7
    assert np.max(np.abs(flown.result.dataset.acceleration_error)) <= 1e-9


def test_trajectory_is_worth_flying(flown):
    """Rests at both ends; three poses away, ±0.1 m and ±0.1 rad in mixed directions."""
    way = flown.trajectory
    assert way.rest[0] > 0
    assert way.rest[1] > 0
    assert len(way.positions) == 5
    away = np.asarray(way.positions)[1:-1] - way.positions[0]
    assert np.all(np.max(np.abs(away), axis=0) >= 0.1 - 1e-12)
    assert np.all(np.min(away, axis=0) < 0)
    assert np.all(np.max(away, axis=0) > 0)


def test_run_balances_its_energy(flown):
    data = flown.result.dataset
    largest = max(float(np.max(np.abs(data[f"energy_{n}"]))) for n in ("strain", "actuators", "kinetic"))
    assert np.max(np.abs(data.energy_residual)) <= 1e-8 * largest  # rtol 1e-7


def test_deformation_is_that_of_the_paper(flown):
    """Fig. 6: at the origin the platform moves along z and turns about x and y only."""
    bend = np.abs(flown.result.dataset.origin_deformation.values)
    assert np.max(bend[:, [0, 1, 5]]) == 0
    assert np.max(bend[:, 2]) > 1e-4
    assert np.min(np.max(bend[:, 3:5], axis=0)) > 1e-6


def test_run_from_the_flat_plate_rings_and_settles():
    """Started undeformed, it vibrates, and ends in the same equilibrium."""
    run = paper.run(modes=2, undeformed=True).result.dataset
    assert np.max(np.abs(run.elastic[0])) == 0
    equilibrium = paper.run(modes=2).result.dataset.elastic
    assert np.max(np.abs(run.elastic[-1] - equilibrium[-1])) <= 1e-4 * np.max(np.abs(equilibrium))


def test_rigid_run_has_no_modes():
    run = paper.run(modes=0).result
    assert run.dataset.sizes["mode"] == 0
    assert np.max(np.abs(run.dataset.pose_error)) <= 1e-7


def test_forces_are_those_of_the_oracle(flown):
    """Stored forces at 20 instants against the tests' own equations of motion."""
    cloud = oracle.plate_cloud(source.corners(), **source.PLATE, n_modes=10, damping_ratio=0.4)
    data = flown.result.dataset
    for i in np.linspace(0, data.sizes["time"] - 1, 20).astype(int):
        at = oracle.system(flown.robot, cloud, flown.result.state(i))
        wanted = oracle.inverse_of(at, data.acceleration.values[i])
        assert relative(data.forces.values[i], wanted.forces) <= 1e-9
        assert relative(data.elastic_acceleration.values[i], wanted.elastic) <= 1e-9
        driven = oracle.direct_of(at, data.forces.values[i])
        assert relative(data.acceleration.values[i], driven.platform) <= 1e-9
        assert relative(data.contact_forces.values[i], driven.contact_forces) <= 1e-9


def test_pictures_are_drawn(flown, tmp_path):
    """All of them, none empty: each has axes with data or a table."""
    paths = paper.figures(flown, tmp_path)
    names = {path.stem for path in paths}
    assert {"fig4_actuator_forces", "fig5_accelerations", "fig6_origin_deformation"} < names
    assert {"fig7_attachment_deformation", "robot", "modes", "table2_frequencies", "energy"} < names
    for path in paths:
        pixels = imread(path)[..., :3]
        assert pixels.shape[0] > 300
        assert np.mean(np.any(pixels < 0.9, axis=-1)) > 0.01


def test_results_say_what_ten_modes_do(flown):
    notes = flown.result.dataset.attrs["notes"]
    assert "cut a degenerate pair" in notes
    assert "8-9 % below Table 2" in notes
