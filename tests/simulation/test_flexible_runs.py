"""Runs of robots whose links bend: energies, states, files, and the points that the legs are drawn by."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import xarray as xr

import flexlegs
import parflex as pf
from flexlegs import NAMES
from measures import relative
from parflex.mechanics.axes import axis_of
from parflex.simulation.summary import balance
from parflex.views.report.checks import checks_of
from parflex.views.sketch import sketch

BALANCED = 1e-10  # of the largest change of an energy; 2e-12 was reached
T = np.linspace(0, 0.05, 26)


def undamped(robot: pf.Robot) -> pf.Robot:
    """The robot without any damping, of platform, links and flexures."""

    def free(leg: pf.Leg) -> pf.Leg:
        joints = [
            joint
            if joint.body is None
            else replace(joint, body=replace(joint.body, damping=0 * joint.body.damping))
            for joint in leg.joints
        ]
        tips = [
            tip
            if tip.flexure is None
            else replace(tip, flexure=replace(tip.flexure, damping=np.zeros((3, 3))))
            for tip in leg.tips
        ]
        return replace(leg, joints=joints, tips=tips)

    platform = replace(robot.platform, damping=0 * robot.platform.damping)
    return pf.Robot([free(leg) for leg in robot.legs], platform, robot.gravity, robot.home_pose)


@pytest.fixture(scope="module", params=NAMES)
def name(request) -> str:
    return request.param


@pytest.fixture(scope="module")
def falls():
    """A robot's motion when it is released, bent and moving, without forces and damping; found once."""

    @cache
    def fall(name: str) -> pf.Result:
        model = pf.Model(undamped(flexlegs.robot(name)))
        start = model.project(flexlegs.states(name)[0])
        return pf.simulate(model, np.zeros(model.robot.n_forces), start, T, rtol=1e-12, atol=1e-14)

    return fall


@pytest.fixture(scope="module")
def fall(falls, name) -> pf.Result:
    return falls(name)


def test_energy_of_a_free_fall(fall):
    """Strain of links, energy of flexures and foreshortening included: nothing is lost in 0.05 s."""
    [found] = balance(fall.dataset)
    assert found.value <= BALANCED
    exchanged = {term: float(np.ptp(fall.dataset[f"energy_{term}"].values)) for term in ("kinetic", "strain")}
    assert min(exchanged.values()) > 1.0  # J: the balance is one of large terms
    assert not np.any(fall.dataset["energy_dissipated"])


@pytest.mark.parametrize(
    ("method", "backend"), [("RK45", "auto"), ("Radau", "auto"), ("DOP853", "vm"), ("Radau", "vm")]
)
def test_other_steppers_agree(fall, name, method, backend):
    """Against DOP853 at a tolerance of 1e-12, after 2 ms; on the virtual machine SciPy takes the steps."""
    model = pf.Model(undamped(flexlegs.robot(name)), backend)
    start, t = fall.state(0), T[:2]
    ended = pf.simulate(model, np.zeros(model.robot.n_forces), start, t, rtol=1e-8, atol=1e-11, method=method)
    assert relative(np.stack(ended.state(-1).leg_elastic), np.stack(fall.state(1).leg_elastic)) < 1e-5
    assert relative(ended.state(-1).twist, fall.state(1).twist) < 1e-6


def test_states_come_back(fall, name, tmp_path):
    """From a file too: the model finds the accelerations that the run had there."""
    model = pf.Model(undamped(flexlegs.robot(name)))
    loaded = pf.load_result(fall.save(tmp_path / "run.nc"))
    xr.testing.assert_identical(loaded.dataset, fall.dataset)
    for result in (fall, loaded):
        found = model.direct(result.state(7), np.zeros(model.robot.n_forces))
        assert relative(found.platform, fall.dataset["acceleration"].values[7]) <= 1e-9
        assert result.state(7).leg_elastic[0].shape == (sum(model.robot.legs[0].modes),)
    again = pf.simulate(
        model, np.zeros(model.robot.n_forces), loaded.state(10), T[:3], rtol=1e-12, atol=1e-14
    )
    end = fall.dataset.isel(time=12)
    assert relative(again.dataset["leg_elastic"].values[2], end["leg_elastic"].values) <= 1e-8


def test_legs_of_fewer_modes_are_padded():
    """One leg of six has stiffer struts: its coordinates stand first, and the rest is no number."""
    robot = flexlegs.robot("gs_flexlegs")
    leg = robot.legs[3]
    rigid = replace(leg.joints[1], body=leg.joints[1].body.with_modes(()))
    legs = (*robot.legs[:3], replace(leg, joints=(leg.joints[0], rigid, leg.joints[2])), *robot.legs[4:])
    model = pf.Model(pf.Robot(legs, robot.platform, robot.gravity, robot.home_pose))
    run = pf.simulate(model, np.zeros(6), model.robot.home, [0, 1e-3], rtol=1e-6)
    data = run.dataset
    assert data["leg_elastic"].dims == ("time", "leg", "leg_mode")
    assert data["leg_elastic"].attrs["units"] == "kg0.5 m"
    assert np.all(np.isnan(data["leg_elastic"].values[:, 3, 4:]))
    assert np.all(np.isfinite(data["leg_elastic"].values[:, [0, 1, 2, 4, 5]]))
    assert data["leg_mode_link"].values[0].tolist() == [2, 2, 2, 3, 3, 3, 3]
    assert data["leg_mode_link"].values[3].tolist() == [3, 3, 3, 3, 0, 0, 0]
    omega = robot.legs[0].joints[1].body.frequencies
    assert data["leg_frequency"].values[0, :3].tolist() == omega.tolist()
    assert not np.any(data["leg_frequency"].values[3, 4:])
    assert [len(e) for e in run.state(1).leg_elastic] == [7, 7, 7, 4, 7, 7]


def test_rigid_legs_have_none_of_it(model_of):
    run = pf.simulate(model_of(0), np.zeros(6), model_of(0).robot.home, [0, 1e-3], rtol=1e-6)
    assert not {each for each in run.dataset.variables if "leg_elastic" in str(each)}
    assert "leg_deformation" not in run.dataset
    assert run.state(0).leg_elastic is None


def test_legs_are_drawn_through_their_nodes(falls):
    """Points of links against shapes times coordinates at the middles of their sections, of four nodes each:
    as far from the link's frame, and as far along the joint's axis."""
    data = falls("gs_flexlegs").dataset.isel(time=9)
    for p, leg in enumerate(flexlegs.robot("gs_flexlegs").legs):
        for joint, station in ((1, 2), (2, 12)):
            body = leg.joints[joint].body
            q = data["leg_elastic"].values[p, data["leg_mode_link"].values[p] == joint + 1]
            moved = body.nodes + np.einsum("n,nka->ka", q, body.shapes)
            middles = moved[:32].reshape(8, 4, 3).mean(axis=1)
            points = data["leg_path"].values[p, station : station + 9]
            points = points[1:] - points[0]
            across = np.abs(np.linalg.norm(points, axis=1)[:, None] - np.linalg.norm(middles, axis=1))
            along = np.abs((points @ data["leg_axis"].values[p, station])[:, None] - middles[:, 2])
            assert np.max(np.min(across + along, axis=1)) < 1e-12


def test_deformation_of_the_legs_is_against_straight_ones(falls):
    """The points less their displacement are those of the same pose with nothing bent; the tips go with the
    platform, the bases stay."""
    result = falls("gs_flexlegs")
    data, state = result.dataset.isel(time=9), result.state(9)
    model = pf.Model(flexlegs.robot("gs_flexlegs"), "numpy")
    straight = sketch(model, pf.State(state.position, state.rotation), scale=1.0)
    moved = data["leg_deformation"].values
    assert relative(data["leg_path"].values - moved, straight.lines) < 1e-12
    assert not np.any(moved[:, 0])
    held = data["attachment_deformation"].values @ data["rotation"].values.T
    assert relative(moved[:, -1], held[data["path_attachment"].values - 1]) < 1e-12


def test_report_checks_of_flexible_legs(falls):
    for name in NAMES:
        assert [check.what for check in checks_of(falls(name).dataset) if not check.passed] == []


def test_axis_of_a_body_without_nodes_between():
    """Clamped at its frame, moved and turned at its end: a cantilever's cubic, exact for a force there."""
    nodes, xi = [(0, 0, 0), (2.0, 0, 0)], np.arange(1, 9) / 9
    shape = np.array([[(0, 0, 0), (0, 1.0, 0)]])  # w = 1 at the end, with the slope 3 / (2 L)
    turn = np.array([[(0, 0, 0), (0, 0, 0.75)]])
    body = pf.FlexibleBody.from_nodes(nodes, [1.0, 1.0], shape, [1.0], 0.0, [1], turn)
    axis = axis_of(body, 0)
    assert np.allclose(axis.places, 2 * xi[:, None] * [1, 0, 0], rtol=0, atol=1e-15)
    assert np.allclose(axis.shapes[:, 1, 0], (3 * xi**2 - xi**3) / 2, rtol=0, atol=1e-15)
    assert not np.any(axis.shapes[:, [0, 2]])
