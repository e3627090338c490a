"""Gravity sag over elevation: first order, energy, robots that stand on the tilted base, closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import parflex as pf
from parflex.mechanics.system import actuated_positions
from parflex.model.core import core_of
from published_hexapods import cubic

K, L, M, INERTIA = 1e7, 0.4, 10.0, (0.1, 0.1, 0.2)
G = np.array([0.0, 0.0, -9.81])
UP = np.radians([-30.0, 0.0, 20.0, 60.0, 90.0])


def sprung():
    """A cubic hexapod under its weight, on springs along its struts, which weigh 1e-7 kg; where its centre
    is."""
    robot, centre = cubic(1e-7, K, L, M, INERTIA)
    return replace(robot, gravity=G), centre


def plated():
    """The nano-hexapod: a plate on flexures and piezo stacks that give."""
    return pf.robots.nano_hexapod()


def test_compliance_times_change_of_weight():
    """δ = C (Rᵀg − g) m, C from a force at the centre of mass to the tool, at the equilibrium at home; legs
    weigh 1e-6 kg of 65, and what is left is of second order, the sag of 0.1 mm to a strut's 0.6 m."""
    bar = pf.Bar(mass=1e-6, outer=0.03, length=0.35)
    sizes = dict(base_radius=0.5, platform_radius=0.3, height=0.6, base_spread=0.35, platform_spread=0.35)
    load, strut = pf.Payload(40.0, (0.05, 0.0, 0.2)), pf.Strut(bar, bar, stiffness=2e7)
    robot = pf.robots.hexapod(**sizes, strut=strut, payload=load)
    moments, tool = robot.platform.moments, (0.05, -0.1, 0.3)
    centre = tuple(moments.MS0 / moments.m - robot.platform.nodes[0])
    model, axis = pf.Model(robot, "numpy"), (0.3, 1.0, 0.0)
    state, forces = model.equilibrium(*robot.home_pose)
    given = dict(inputs=(pf.NodeWrench(0, centre),), outputs=(pf.NodeMotion(0, tool),))
    C = model.linearise(state, forces, **given).frf([0.0]).values[:, :3, 0].real
    found = pf.sag(model, UP, 0, tool, axis=axis)
    turn = Rotation.from_rotvec(UP[:, None] * np.array(axis) / np.linalg.norm(axis))
    change = moments.m * (turn.inv().apply(G) - G)
    expected = change @ C.T
    for name, part in (("displacement", expected[:, :3]), ("rotation", expected[:, 3:])):
        assert np.max(np.abs(found[name].values - part)) <= 3e-4 * np.max(np.abs(part))
    assert np.allclose(found.gravity, turn.inv().apply(G))
    assert np.all(found.forces == forces)
    assert found.attrs["motors"] == "springs"
    assert np.all(found.displacement.sel(elevation=0.0) == 0.0)


def test_the_centre_of_a_cubic_hexapod():
    """m g / 2k along each axis (Preumont), whatever the axis of elevation: down by 1 − cos, aside by sin."""
    robot, centre = sprung()
    found = pf.sag(pf.Model(robot, "numpy"), UP, 0, centre)
    one = M * 9.81 / (2 * K)
    expected = one * np.stack([0 * UP, -np.sin(UP), 1 - np.cos(UP)], axis=1)
    assert np.all(np.abs(found.displacement - expected) <= 5e-5 * one)


def there(robot, angle, joints, guess):
    """The state of the robot under gravity that is turned, by a model of its own, and that model."""
    felt = replace(robot, gravity=Rotation.from_rotvec([-angle, 0, 0]).apply(robot.gravity))
    model = pf.Model(felt, "numpy")
    return model, model.forward(joints, guess, sag=True)


def test_energy_of_a_plate_on_locked_motors():
    """Potential, strain and weight, falls by half the work of the change of weight, ½ ΔF·δ: for another
    robot, whose gravity is turned, whose motors stand where they stood."""
    robot = pf.robots.pus6(modes=3)
    model = pf.Model(robot, "numpy")
    home, _ = model.equilibrium(*robot.home_pose)
    joints = np.array([q[0] for q in model.joints(home).q])
    assert np.allclose([leg.joints[0].mu for leg in robot.legs], 1)
    angle = 0.5
    turned, state = there(robot, angle, joints, home)
    found = pf.sag(model, [angle], 5)
    assert found.attrs["motors"] == "locked"
    assert np.allclose(
        found.displacement[0], place(robot, 5, state) - place(robot, 5, home), rtol=1e-6, atol=1e-12
    )
    total = [sum_of(turned.energies(each)) for each in (home, state)]
    change = [weight(turned, each) - weight(model, each) for each in (home, state)]
    assert total[0] > total[1]
    assert total[0] - total[1] == pytest.approx((change[0] - change[1]) / 2, rel=1e-3)


def weight(model, state):
    return float(model.energies(state).gravity)


def sum_of(energies):
    return float(energies.gravity + energies.strain)


@pytest.mark.parametrize("motors", ["springs", "locked"])
def test_on_the_tilted_base(motors):
    """The forces that are told hold the robot, platform and soft tips bent, on a base that leans in the
    world; seen from the base it stands as much away."""
    robot, axis, home = plated(), np.array([1.0, 0.0, 0.0]), 0.2
    model = pf.Model(robot, "numpy")
    found = pf.sag(model, [home, 0.9], 2, axis=axis, home=home, motors=motors)
    places = []
    for k, angle in enumerate((home, 0.9)):
        base = pf.BaseMotion(rotation=Rotation.from_rotvec(angle * axis).as_matrix())
        start = base.carried(robot.home)
        state, _ = model.equilibrium(forces=found.forces.values[k], guess=start, base=base)
        seen = base.seen(state)
        places.append(place(robot, 2, seen))
    assert np.allclose(found.displacement[1], places[1] - places[0], rtol=1e-6, atol=1e-13)
    assert np.allclose(found.displacement[0], 0, atol=1e-13)
    stiff = float(np.max(np.abs(found.displacement)))
    assert 1e-6 < stiff < 2e-5  # m: a plate of 3.9 kg on six struts of 1 N/µm and more


def place(robot, node, state):
    """Where a node is, bent."""
    body = robot.platform
    return state.position + state.rotation @ (body.nodes[node] + body.shapes_at(node)[0] @ state.elastic)


def test_forward_geometry_sags_on_soft_tips():
    """Under other weights at the same motors, the platform moves on its tips; the pose of the equilibrium
    whose motors stand there is found."""
    robot = plated()
    heavy = replace(robot, gravity=3 * np.asarray(robot.gravity))
    model = pf.Model(heavy, "numpy")
    state, _ = model.equilibrium(*robot.home_pose)
    motors = actuated_positions(core_of(model).system(state))  # behind the drives, which give
    found = model.forward(motors, robot.home, sag=True)
    assert np.allclose(found.position, state.position, rtol=0, atol=1e-12)
    assert np.allclose(found.rotation, state.rotation, rtol=0, atol=1e-10)


def test_a_rigid_robot_on_locked_motors_does_not_sag():
    model = pf.Model(pf.robots.gough_stewart(modes=0), "numpy")
    found = pf.sag(model, UP, 0, motors="locked")
    assert np.all(found.displacement == 0)
    assert np.ptp(found.forces.values[:, 0]) > 1.0  # but its motors carry other shares


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (dict(elevations=0.3), r"elevations have shape \(\)"),
        (dict(elevations=[]), "elevations have shape"),
        (dict(axis=(0, 0, 0)), "axis is"),
        (dict(node=99), "the platform has nodes"),
        (dict(motors="loose"), "motors is 'loose'; choose one of auto, locked, springs"),
        (dict(motors="springs"), 'motors is "springs", but not all actuated joints have one'),
    ],
)
def test_what_cannot_sag_is_said(given, words):
    with pytest.raises(pf.InputError, match=words):
        pf.sag(pf.Model(pf.robots.gough_stewart(modes=0), "numpy"), **dict(elevations=UP, node=0) | given)


def test_a_plate_too_soft_is_told_with_its_elevation():
    """The paper's plate on locked motors, which does not stand upright, either of Sec. 6."""
    model = pf.Model(pf.robots.gough_stewart(modes=3), "numpy")
    with pytest.raises(pf.NotConverged, match="elevation 60 deg: "):
        pf.sag(model, np.radians([60.0]), 0)


def test_the_picture_has_the_numbers():
    robot, centre = sprung()
    found = pf.sag(pf.Model(robot, "numpy"), UP, 0, centre)
    fig = pf.plot.sag(found)
    upper, lower = fig.axes
    x, y = upper.lines[1].get_data()
    assert np.allclose(x, np.degrees(UP))
    assert np.allclose(y, 1e6 * found.displacement.values[:, 1])
    assert upper.get_ylabel() == "displacement (µm)"
    assert lower.get_xlabel() == "elevation: turn of the base (deg)"
    assert len(pf.plot.sag({"a": found, "b": found}).axes[0].lines) == 7
    with pytest.raises(pf.InputError, match="data holds no sag"):
        pf.plot.sag({"a": 1})
