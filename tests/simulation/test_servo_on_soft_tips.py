"""Servos of legs whose tips are soft: the references are where the robot rests, not where hard tips would."""

from dataclasses import replace
from functools import cache
from math import radians

import numpy as np

import parflex as pf
from measures import relative
from parflex.model.core import core_of

STIFFNESS = np.diag([2e6, 3e6, 1e6])  # N/m, of each tip
DAMPING = 200.0 * np.eye(3)  # N s/m
AT_REST = 1e-10  # m and rad: equilibria are found to round-off
LIMIT = 10.0  # what softness changes falls as one over the stiffness


def softened(robot: pf.Robot, factor: float = 1.0) -> pf.Robot:
    """The robot on soft tips, so many times as stiff."""
    flexure = pf.Flexure(translation=factor * STIFFNESS, translation_damping=factor * DAMPING)
    legs = [replace(leg, tips=[replace(tip, flexure=flexure) for tip in leg.tips]) for leg in robot.legs]
    return replace(robot, legs=legs)


def hexapod() -> pf.Robot:
    """On struts of some mass, with 10 kg off its centre."""
    sizes = {"base_radius": 0.25, "platform_radius": 0.15, "height": 0.3}
    spreads = {"base_spread": radians(20), "platform_spread": radians(30)}
    load = pf.Payload(10.0, (0.02, 0.01, 0.05), 0.02 * np.eye(3))
    return pf.robots.hexapod(**sizes, **spreads, payload=load)


@cache
def model(factor: float = 1.0) -> pf.Model:
    return pf.Model(softened(hexapod(), factor), "vm")


def way(of: pf.Model) -> pf.Trajectory:
    """Up and round, with rests at both ends."""
    start, _ = of.equilibrium(*of.robot.home_pose)
    there = [((0.01, -0.005, 0.012), (0.02, -0.03, 0.05))]
    return pf.Trajectory.through(start, there, 0.2, rest=(0.02, 0.02))


def test_they_hold_the_robot_where_it_rests():
    """Γ_r are the forces of the equilibrium, found by another route, and q_r its joints."""
    m = model()
    start, forces = m.equilibrium(*m.robot.home_pose)
    servo = pf.Servo(m, way(m))
    run = pf.simulate(m, servo, start, np.linspace(0, 0.02, 5), rtol=1e-10, atol=1e-13)
    assert relative(run.dataset["forces"].values, np.tile(forces, (5, 1))) <= 1e-9
    assert np.max(np.abs(run.dataset["pose_error"].values)) <= AT_REST


def test_they_arrive():
    """At the end the platform is at the pose that was asked for, to what swings on."""
    m = model()
    start, _ = m.equilibrium(*m.robot.home_pose)
    path = way(m)
    run = pf.simulate(
        m, pf.Servo(m, path), start, np.linspace(0, path.duration + 1.0, 50), rtol=1e-9, atol=1e-12
    )
    errors = np.max(np.abs(run.dataset["pose_error"].values), axis=-1)
    assert np.max(np.linalg.norm(run.dataset["position"].values - start.position, axis=-1)) > 0.01
    assert errors[-1] <= 1e-7
    assert np.max(errors) <= 1e-4


def test_stiff_tips_are_hard_ones():
    """The reference joints tend to those of the robot on hard tips as one over the stiffness."""
    hard = pf.Model(hexapod(), "numpy")
    t = np.linspace(0.0, 0.2, 7)
    wanted = pf.Servo(hard, way(hard)).wanted_joints(t)
    off = [
        np.max(
            np.abs(pf.Servo(pf.Model(softened(hexapod(), k), "numpy"), way(hard)).wanted_joints(t) - wanted)
        )
        for k in (1.0, 10.0, 100.0)
    ]
    assert off[0] > 1e-6  # m
    ratios = np.array(off[:-1]) / off[1:]
    assert np.all(np.abs(ratios / LIMIT - 1) <= 0.05)


def test_the_default_control_of_soft_legs_is_their_servos():
    from parflex.simulation.laws.choice import default_control

    m = model()
    choice = default_control(m, way(m))
    assert isinstance(choice.controller, pf.Servo)
    assert not choice.why
    assert any(core_of(m).mechanism.layout.joints)  # whose joints are carried all the same
