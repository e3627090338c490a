"""The legs' servos: feed-forward, gains, the integral, what they refuse, and how well they fly."""

import re
from dataclasses import replace

import numpy as np
import pytest

import parflex as pf
from heavy_disc import disc, on_struts
from measures import relative
from parflex.analysis.small_motions import about
from parflex.kernels import models
from parflex.model.core import core_of
from parflex.simulation.laws.choice import default_control
from parflex.simulation.laws.servo_gains import sampled_radius

SERVOED = ("rus6", "pus6", "delta", "rps3", "prs3", "octapod")


def lift(robot: pf.Robot, height: float = 0.01) -> pf.Trajectory:
    """Up along z, which all of these robots can, and down again."""
    start = robot.home
    up = pf.MoveTo(start.position + (0, 0, height), duration=0.1)
    return pf.Trajectory.of(
        start, [pf.Hold(0.05), up, pf.MoveTo(start.position, duration=0.1), pf.Hold(0.05)]
    )


@pytest.mark.parametrize("name", SERVOED)
def test_frozen_forces_at_rest_are_those_of_the_equilibrium(name):
    """A body that is frozen in the bend of its equilibrium needs the same forces to rest."""
    model = pf.Model(getattr(pf.robots, name)(modes=5), "numpy")
    state, forces = model.equilibrium(*model.robot.home_pose)
    core = core_of(model)
    found = core.functions(models.frozen_inverse)(x=core.flat(state), platform=np.zeros(6))["forces"]
    assert relative(found, forces) <= 1e-9


@pytest.mark.parametrize("name", ["rus6", "octapod"])
def test_frozen_forces_in_motion_are_those_of_the_rigid_robot(name):
    """Of more actuators than freedoms both are the shortest."""
    model = pf.Model(getattr(pf.robots, name)(modes=0), "numpy")
    rng, home = np.random.default_rng(0), model.robot.home
    state = pf.State(home.position, home.rotation, 0.3 * rng.standard_normal((5, 6)))
    target, core = rng.standard_normal((5, 6)), core_of(model)
    found = core.functions(models.frozen_inverse)(x=core.flat(state), platform=target)["forces"]
    assert relative(found, model.inverse(state, target).forces) <= 1e-10


def test_frozen_forces_of_fewer_actuators(model_of):
    """A Delta's three motors, against the inverse model of its translation."""
    model = pf.Model(pf.robots.delta(modes=0), "numpy")
    state, target = model.robot.home, np.array([1.0, -2.0, 3.0])
    core = core_of(model)
    wanted = np.concatenate([target, np.zeros(3)])
    found = core.functions(models.frozen_inverse)(x=core.flat(state), platform=wanted)["forces"]
    assert relative(found, model.inverse(state, target, pf.FrameOutput((0, 1, 2))).forces) <= 1e-9


@pytest.mark.parametrize("backend", ["vm", "native"])
@pytest.mark.parametrize("name", SERVOED)
def test_default_servos_fly(name, backend):
    """Within a fifth of a millimetre (or 0.2 mrad), at forces near those of a rigid platform."""
    model = pf.Model(getattr(pf.robots, name)(modes=5), backend)
    way = lift(model.robot)
    control, why = default_control(model, way)
    assert isinstance(control, pf.Servo)
    assert not why
    assert control.verdict().stable
    start = model.equilibrium(*model.robot.home_pose)[0]
    data = pf.simulate(model, control, start, np.linspace(0, way.duration, 61)).dataset
    assert float(np.sqrt(np.mean(data["joint_error"] ** 2))) <= 2e-4
    assert float(np.abs(data["forces"]).max()) <= 2 * float(np.abs(data["rigid_forces"]).max())
    assert data.attrs["control"] == "servo"


def test_the_gains_are_those_of_20_hz_on_the_effective_mass():
    """Of the rigid robot, whose closed loop has that mean square frequency, and half of its damping."""
    model = pf.Model(pf.robots.rus6(modes=0), "numpy")
    servo = pf.Servo(model, lift(model.robot))
    motions = about(core_of(model).readable, model.robot.home)
    poles = motions.servo_poles(servo.kp, 0 * servo.kd, servo.ki)
    assert np.mean(np.abs(poles) ** 2) == pytest.approx((2 * np.pi * 20) ** 2, rel=2e-3)  # gravity's part
    assert np.allclose(servo.kd, 2 * 0.7 * servo.kp / (2 * np.pi * 20), rtol=1e-12)


def test_a_soft_platform_slows_its_servos():
    """Half the lowest frequency on locked legs, where that is below 20 Hz."""
    model = pf.Model(pf.robots.octapod(modes=5), "numpy")
    locked = about(core_of(model).readable, model.robot.home).locked_poles()
    slow = 0.5 * np.min(np.abs(locked))
    assert slow < 2 * np.pi * 20
    servo = pf.Servo(model, lift(model.robot))
    assert np.allclose(servo.kp / servo.kd, slow / 1.4, rtol=1e-9)


def test_a_platform_that_buckles_is_left_to_computed_torque(model_of):
    model = model_of(9)
    control, why = default_control(model, lift(model.robot))
    assert isinstance(control, pf.ComputedTorque)
    assert "buckles on its locked legs" in why
    assert "buckles" in str(pf.Servo(model, lift(model.robot)).verdict())


def test_legs_without_closed_form_are_left_to_computed_torque():
    """Rods that are offset by a millimetre, which Newton's method solves."""
    robot = pf.robots.rus6(modes=3)
    q = pf.Model(robot, "numpy").joints(robot.home).q
    legs = [
        replace(leg, joints=(*leg.joints[:2], replace(leg.joints[2], d=1e-3)), posture=joints)
        for leg, joints in zip(robot.legs, q, strict=True)
    ]
    model = pf.Model(replace(robot, legs=tuple(legs)), "numpy")
    control, why = default_control(model, lift(robot))
    assert isinstance(control, pf.ComputedTorque)
    assert "closed-form" in why
    assert control.verdict() is not None
    with pytest.raises(pf.InputError, match="closed form"):
        pf.Servo(model, lift(robot))


def test_the_integral_takes_what_a_load_leaves():
    """A wrench that nobody knows of leaves joints off by J⁻ᵀ w / kp, and with an integral by nothing."""
    model = pf.Model(pf.robots.rus6(modes=3), "vm")
    way = pf.Trajectory.of(model.robot.home, [pf.Hold(1.5)])
    start = model.equilibrium(*model.robot.home_pose)[0]
    load = [pf.Wrench(0, (3.0, 0.0, -20.0))]
    plain = pf.Servo(model, way)
    gains = {"kp": plain.kp, "kd": plain.kd}
    found = {
        ki: pf.simulate(
            model, pf.Servo(model, way, **gains, ki=ki), start, np.linspace(0, 1.5, 31), wrenches=load
        ).dataset
        for ki in (0.0, 10 * float(plain.kp[0]))
    }
    off, none = (np.max(np.abs(data["joint_error"].values[-1])) for data in found.values())
    push = found[0.0]["forces"].values[-1] - found[0.0]["forces"].values[0]
    assert off == pytest.approx(np.max(np.abs(push)) / plain.kp[0], rel=1e-2)
    assert none < 1e-3 * off


def test_the_integral_is_the_same_in_machine_code():
    robot = pf.robots.rus6(modes=3)
    found = []
    for backend in ("vm", "native"):
        model = pf.Model(robot, backend)
        way = lift(robot)
        servo = pf.Servo(model, way, ki=500.0)
        found.append(pf.simulate(model, servo, robot.home, np.linspace(0, way.duration, 31)).dataset)
    assert np.max(np.abs(found[0].position - found[1].position)) <= 1e-8
    assert relative(found[0].forces, found[1].forces) <= 1e-5


def test_sampled_loops_against_their_characteristic_polynomial():
    """One mass m under held forces: z² − (2 − b − a) z + (1 − b + a), a = kp T²/2m, b = kd T/m."""
    rng = np.random.default_rng(0)
    for kp, kd, m in rng.uniform([0, 0, 1], [4e7, 2e4, 3], (50, 3)):
        T = 1 / 4000
        a, b = kp * T**2 / (2 * m), kd * T / m
        roots = np.abs(np.roots([1.0, -(2 - b - a), 1 - b + a]))
        found = sampled_radius(np.array([[1 / m]]), *(np.array([k]) for k in (kp, kd, 0.0)), T)
        assert found == pytest.approx(np.max(roots), rel=1e-6)


def test_the_advice_on_gains_is_accepted():
    model = pf.Model(pf.robots.rus6(modes=0), "numpy")
    way = lift(model.robot)
    with pytest.raises(pf.InputError, match="4000 samples a second") as caught:
        pf.Servo(model, way, kp=1e8, kd=1e5)
    p, d = map(float, re.search(r"take (\S+) times kp and (\S+) times kd", str(caught.value)).groups())
    assert pf.Servo(model, way, kp=1e8 * p, kd=1e5 * d).kp[0] == pytest.approx(1e8 * p)
    assert pf.Servo(model, way, kp=1e8, kd=1e5, rate=1e9).rate == 1e9


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"kp": [1.0, 2.0]}, r"Servo.kp has shape \(2,\); give one value, or \(6,\)"),
        ({"kd": -1.0}, "Servo.kd is -1.0"),
        ({"ki": np.nan}, "Servo.ki is nan"),
        ({"rate": 0.0}, "Servo.rate is 0.0; it must be positive"),
        ({"kp": 100.0, "kd": 0.0, "ki": 0.0}, "kd is too low beside kp and ki"),
    ],
)
def test_what_servos_refuse(options, words):
    model = pf.Model(pf.robots.rus6(modes=0), "numpy")
    with pytest.raises(pf.InputError, match=words):
        pf.Servo(model, lift(model.robot), **options)


def test_a_trajectory_out_of_reach_is_refused_with_its_time():
    model = pf.Model(pf.robots.rus6(modes=0), "numpy")
    with pytest.raises(pf.OutOfReach, match=r"trajectory at t = 0\.\d+ s: .*leg \d cannot reach"):
        pf.Servo(model, lift(model.robot, 3.0))


@pytest.mark.slow
def test_heavy_struts_under_a_stiff_disc():
    """Computed torque diverges at rest, told by its cause and nothing else; the servos fly all the same."""
    model = pf.Model(on_struts(disc()))
    robot = model.robot
    start = model.equilibrium(*robot.home_pose)[0]
    there = pf.MoveTo(robot.home.position + (0.01, 0, 0), duration=0.05)
    way = pf.Trajectory.of(robot.home, [pf.Hold(0.1), there, pf.Circle(radius=0.01, frequency=5, turns=2)])
    times = np.linspace(0, way.duration, 401)

    torque = pf.ComputedTorque(model, way, kp=400, kd=40)
    assert not torque.verdict().stable
    with pytest.warns(pf.PartialRun, match="the motion diverges") as told:
        stopped = pf.simulate(model, torque, start, times)
    assert len(told) == 1
    assert "elastic energy has grown" in stopped.stopped
    assert "largest actuator force" in stopped.stopped
    assert "reach" not in stopped.stopped

    servo = pf.Servo(model, way)
    assert servo.verdict().stable
    data = pf.simulate(model, servo, start, times).dataset
    late = data.sel(time=slice(0.05, None))
    assert float(np.sqrt(np.mean(late["joint_error"] ** 2))) <= 2e-4
    assert float(np.abs(data["forces"]).max()) <= 2 * float(np.abs(data["rigid_forces"]).max())
