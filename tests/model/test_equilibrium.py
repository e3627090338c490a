"""Equilibria: bending legs against stored answers of an independent program, springs against closed forms;
what is refused, and the remedy."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import brentq

import flexlegs
import parflex as pf
from measures import relative

AGREED = 1e-9  # what is asked of the stored equilibrium
STILL = 1e-8  # m/s², rad/s², of a robot at rest
LENGTH, OUTER, INNER, YOUNG = 0.62, 0.032, 0.026, 205e9
BUCKLING = np.pi**2 * YOUNG * np.pi / 64 * (OUTER**4 - INNER**4) / LENGTH**2  # Euler's load, N


def still(model: pf.Model, state: pf.State, forces, wrenches=(), limit: float = STILL) -> bool:
    """True where the direct model has no accelerations, of platform, modes, joints and links."""
    found = model.direct(state, forces, wrenches)
    parts = [found.platform, found.elastic, *found.leg_joints, *found.leg_elastic]
    return all(np.max(np.abs(part), initial=0.0) <= limit for part in parts)


@pytest.fixture(scope="module")
def hexapod() -> pf.Model:
    return pf.Model(flexlegs.robot("gs_flexlegs"), "numpy")


def test_bending_legs_and_flexures_against_the_stored_equilibrium(hexapod):
    a = flexlegs.arrays("gs_flexlegs")
    state, forces = hexapod.equilibrium(a["static_position"], a["static_rotation"])
    assert relative(state.elastic, a["static_elastic"]) <= AGREED
    assert relative(np.array(state.leg_elastic), a["static_leg_elastic"]) <= AGREED
    assert relative(np.array(hexapod.joints(state).q), a["static_joints"]) <= AGREED
    assert relative(forces, a["static_forces"]) <= AGREED
    contact = hexapod.direct(state, forces).contact_forces
    assert relative(contact, a["static_contact"]) <= AGREED


def test_forces_given_instead_of_the_pose(hexapod):
    """The forces of an equilibrium, from a guess beside it, lead back to its pose."""
    model = hexapod
    state, forces = model.equilibrium(*model.robot.home_pose)
    guess = pf.State(state.position + (1e-4, -2e-4, 1e-4), state.rotation)
    found, same = model.equilibrium(forces=forces, guess=guess)
    assert np.array_equal(same, forces)
    assert relative(found.position, state.position) <= AGREED
    assert relative(found.elastic, state.elastic) <= AGREED
    assert relative(np.array(found.leg_elastic), np.array(state.leg_elastic)) <= AGREED


def test_wrenches_and_parameters():
    """A load on a node, and gravity of the moon: what the direct model has at rest under them."""
    robot = flexlegs.robot("gs_flexlegs")
    model = pf.Model(robot, "numpy", parameters=["gravity"])
    loads = [pf.Wrench(7, (200.0, -50.0, -400.0)), pf.Wrench(3, (0, 0, 30.0), (5.0, 0, 0), frame="platform")]
    moon = {"gravity": (0.0, 0.0, -1.62)}
    state, forces = model.equilibrium(*robot.home_pose, wrenches=loads, parameters=moon)
    assert still(model.with_parameters(moon), state, forces, loads)
    weight = np.array([0, 0, -1.62]) * total_mass(robot)
    assert not np.allclose(forces, model.equilibrium(*robot.home_pose)[1], rtol=0, atol=1.0)
    assert np.linalg.norm(weight) > 0


def total_mass(robot: pf.Robot) -> float:
    """The mass of platform and legs, kg."""
    legs = [j.M if j.body is None else j.body.moments.m for leg in robot.legs for j in leg.joints]
    return float(robot.platform.moments.m + sum(legs))


@pytest.mark.parametrize("name", flexlegs.NAMES)
def test_legs_that_carry_their_joints_and_rigid_ones_beside(name):
    """Without the flexures, whose rest is far from home."""
    mixed = flexlegs.mixed(name)
    legs = tuple(replace(leg, tips=tuple(replace(t, flexure=None) for t in leg.tips)) for leg in mixed.legs)
    model = pf.Model(replace(mixed, legs=legs), "numpy")
    state, forces = model.equilibrium(*mixed.home_pose)
    assert still(model, state, forces)
    assert np.max(np.abs(state.position - mixed.home_pose[0])) <= 1e-5


def spring_under_a_motor(stiffness: float) -> pf.Robot:
    """A platform on a rail: a motor, and in series a spring, lift it."""
    rail = (
        pf.Joint(0, 1, 1, M=2.0),
        pf.Joint(1, 1, M=1.0, k=stiffness),
    )
    lift = pf.Leg(
        np.eye(3),
        (0, 0, 0),
        rail,
        (pf.Tip(2, (0, 0, 0), 0), pf.Tip(2, (0.1, 0, 0), 1), pf.Tip(2, (0, 0.1, 0), 2)),
        (0.0, 0.0),
    )
    body = pf.FlexibleBody.rigid(5.0, (0, 0, 0), 0.1 * np.eye(3), [(0, 0, 0), (0.1, 0, 0), (0, 0.1, 0)])
    return pf.Robot([lift], body, (0, 0, -9.81), ((0, 0, 0), np.eye(3)))


def test_a_motor_behind_a_spring():
    """The spring bears what is above it, m g / k; the motor all: 5 kg, 1 kg and 2 kg."""
    model = pf.Model(spring_under_a_motor(1e4), "numpy")
    state, forces = model.equilibrium((0, 0, 0), np.eye(3))
    q = model.joints(state).q[0]
    assert q[1] == pytest.approx(-6.0 * 9.81 / 1e4, rel=1e-12)
    assert q[0] == pytest.approx(-q[1], rel=1e-12)
    assert forces == pytest.approx([8.0 * 9.81], rel=1e-12)
    assert still(model, state, forces)


def strut(push: float, n: int = 1) -> pf.Robot:
    """A strut on a universal joint under a plate of a weight that pushes on it; posts at its sides slide."""
    beam = pf.beam((0, 0, LENGTH), OUTER, INNER, young=YOUNG, poisson=0.29, density=7850, bending=n)
    quarter = np.pi / 2
    turning = (pf.Joint(0, 0, alpha=-quarter), pf.Joint(1, 0, alpha=quarter))
    leg = pf.Leg(
        np.eye(3),
        (0, 0, 0),
        (*turning, pf.Joint(2, 1, 1, alpha=quarter, body=beam)),
        (pf.Tip(3, (0, 0, LENGTH), 0),),
    )
    slide = (pf.Joint(0, 1, M=1e-6),)
    corners = [(0.2, 0, LENGTH), (-0.1, 0.2, LENGTH), (-0.1, -0.2, LENGTH)]
    tips = [pf.Tip(1, np.subtract(p, corners[0]), i) for i, p in enumerate(corners, start=1)]
    rail = pf.Leg(np.eye(3), corners[0], slide, tips, (0.0,))
    places = [(0.0, 0.0, 0.0), *(np.subtract(p, (0, 0, LENGTH)) for p in corners)]
    platform = pf.FlexibleBody.rigid(push / 9.81, (0, 0, 0), np.eye(3), places)
    return pf.Robot([leg, rail], platform, (0, 0, -9.81), ((0, 0, LENGTH), np.eye(3)))


def test_a_strut_is_refused_beyond_its_buckling_load():
    """Euler's load, to what one shape tells; below it the strut stays straight and carries the weight."""
    state, forces = pf.Model(strut(0.95 * BUCKLING), "numpy").equilibrium((0, 0, LENGTH), np.eye(3))
    assert forces == pytest.approx([0.95 * BUCKLING], rel=1e-3)
    assert np.max(np.abs(state.leg_elastic[0])) <= 1e-9
    with pytest.raises(
        pf.NotConverged, match=r"leg 1 is loaded with .* N and buckles from .* N on"
    ) as refused:
        pf.Model(strut(1.05 * BUCKLING), "numpy").equilibrium((0, 0, LENGTH), np.eye(3))
    words = str(refused.value).split()
    numbers = [float(word) for word, unit in pairwise(words) if unit == "N"]
    assert numbers == pytest.approx([1.05 * BUCKLING, BUCKLING], rel=2e-3)


def test_struts_far_beyond_their_buckling_load_are_named():
    """A wire in a cylinder that is rigid and reaches a beyond it; at u = ℓ √(P/EI) their slopes meet where
    tan u = −u a/ℓ. It is told of the straight strut, though Newton's method ends elsewhere."""
    wire, thickness, young = 0.2, 5e-4, 205e9
    cylinder = pf.Bar(mass=1e-4, length=0.22, outer=0.03)
    rod = pf.Bar(outer=thickness, length=wire, density=7850, young=young, static=True)
    sizes = {"base_radius": 0.25, "platform_radius": 0.15, "height": 0.3}
    spreads = {"base_spread": np.radians(20), "platform_spread": np.radians(20)}
    model = pf.Model(pf.robots.hexapod(**sizes, **spreads, strut=pf.Strut(cylinder, rod)), "numpy")
    lengths = [q[2] for q in model.joints(model.robot.home).q]
    a = lengths[0] - wire
    u = brentq(lambda u: np.sin(u) + u * a / wire * np.cos(u), np.pi / 2, np.pi)
    expected = young * np.pi / 64 * thickness**4 * (u / wire) ** 2
    for call in (lambda: model.equilibrium(*model.robot.home_pose), lambda: model.forward(lengths, sag=True)):
        with pytest.raises(pf.NotConverged, match="leg 1 is loaded with .* N and buckles from") as refused:
            call()
        words = str(refused.value).split()
        numbers = [float(word) for word, unit in pairwise(words) if unit == "N"]
        assert numbers[1] == pytest.approx(expected, rel=2e-3)


def test_what_is_refused(hexapod):
    place, turn = hexapod.robot.home_pose
    with pytest.raises(pf.InputError, match="takes a pose, position and rotation, or else forces"):
        hexapod.equilibrium()
    with pytest.raises(pf.InputError, match="takes a pose"):
        hexapod.equilibrium(place, turn, forces=np.zeros(6))
    with pytest.raises(pf.InputError, match="guess is given with a pose"):
        hexapod.equilibrium(place, turn, guess=hexapod.robot.home)
    with pytest.raises(pf.InputError, match=r"forces has shape \(5,\)"):
        hexapod.equilibrium(forces=np.zeros(5))
    with pytest.raises(pf.InputError, match=r"axes are \(3,\) of forces, \(2,\) of wrenches"):
        hexapod.equilibrium(forces=np.zeros((3, 6)), wrenches=[pf.Wrench(0, np.zeros((2, 3)))])
    with pytest.raises(pf.NotConverged, match="no equilibrium under these forces was found from the guess"):
        hexapod.equilibrium(forces=np.full(6, 1e7))
