"""Control laws of robots whose legs bend: they stay on their path, and energy balances."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import flexlegs
import parflex as pf
from measures import relative
from parflex.simulation.laws.choice import default_control, held_frame

BALANCED = 1e-9  # of the energy that the actuators exchange
STEEL = {"young": 205e9, "density": 7850.0, "bending": 1}


@cache
def hexapod(axial: int, damping: float = 0.0) -> pf.Model:
    """Six steel struts that bend, and stretch or not, under 5 kg."""
    steel = STEEL | {"axial": axial, "damping_ratio": damping}
    strut = pf.Strut(
        pf.Bar(outer=0.03, inner=0.024, length=0.2, **steel), pf.Bar(outer=0.016, length=0.2, **steel)
    )
    sizes = {"base_radius": 0.25, "platform_radius": 0.15, "height": 0.3}
    spreads = {"base_spread": np.radians(20), "platform_spread": np.radians(20)}
    payload = pf.Payload(5.0, inertia=0.03 * np.eye(3))
    return pf.Model(pf.robots.hexapod(**sizes, **spreads, strut=strut, payload=payload), "native")


@cache
def reference() -> pf.Model:
    """The robot of `data/`, everything of which bends."""
    return pf.Model(flexlegs.robot("gs_flexlegs"), "native")


def way(model: pf.Model) -> pf.Trajectory:
    """Held, moved, and held again: 2 s."""
    home = model.robot.home
    there = np.asarray(home.position) + (0.01, 0.0, 0.02)
    return pf.Trajectory.of(home, [pf.Hold(0.5), pf.MoveTo(there, duration=1.0), pf.Hold(0.5)])


def flown(model: pf.Model, law: pf.Controller) -> pf.Result:
    start, _ = model.equilibrium(*model.robot.home_pose)
    return pf.simulate(model, law, start, np.linspace(0, 2, 41), rtol=1e-9, atol=1e-11)


def check_balance(run: pf.Result) -> None:
    exchanged = np.max(np.abs(run.dataset.energy_actuators))
    assert exchanged > 0.5
    assert np.max(np.abs(run.dataset.energy_residual)) <= BALANCED * exchanged


def test_the_default_law_of_the_reference():
    """Servos follow the bent legs' lengths; the platform of this robot is so soft (1.5 Hz on locked legs)
    that its path is kept to half a millimetre and half a milliradian."""
    model = reference()
    law, why = default_control(model, way(model))
    assert isinstance(law, pf.Servo)
    assert not why
    assert law.verdict().stable
    run = flown(model, law)
    assert np.max(np.abs(run.dataset.pose_error)) <= 5e-4
    check_balance(run)


@pytest.mark.parametrize("axial", [0, 1])
def test_the_default_law_of_a_hexapod(axial):
    """Without any damping, for 2 s: to a micrometre of its path."""
    model = hexapod(axial)
    law, why = default_control(model, way(model))
    assert isinstance(law, pf.Servo)
    assert not why
    run = flown(model, law)
    assert np.max(np.abs(run.dataset.pose_error)) <= 1e-6
    check_balance(run)


def test_servos_at_rest_hold_the_equilibrium():
    """In the stored equilibrium of `data/` they give its forces, and nothing accelerates."""
    a, model = flexlegs.arrays("gs_flexlegs"), reference()
    bend = {"elastic": a["static_elastic"], "leg_elastic": tuple(a["static_leg_elastic"])}
    state = pf.State(a["static_position"], a["static_rotation"], **bend)
    stay = pf.Trajectory.of(model.robot.home, [pf.Hold(1.0)])
    forces = pf.Servo(model, stay)(0.5, state)
    assert relative(forces, a["static_forces"]) <= 1e-9


def test_computed_torque_of_moving_legs():
    """Legs that bend only are commanded at once; those that stretch are refused, with advice that works where
    they have the least damping, of half a percent. Without any no law of the platform's pose can hold them:
    their motors are not where the pose is seen."""
    model = hexapod(0)
    run = flown(model, pf.ComputedTorque(model, way(model), 400.0, 40.0))
    assert np.max(np.abs(run.dataset.pose_error)) <= 1e-9
    check_balance(run)
    model = hexapod(1, 0.005)
    with pytest.raises(pf.InputError, match=r'use Servo, or ComputedTorque\(…, legs="static"\)'):
        pf.ComputedTorque(model, way(model), 400.0, 40.0)
    assert isinstance(pf.Servo(model, way(model)), pf.Controller)
    run = flown(model, pf.ComputedTorque(model, way(model), 400.0, 40.0, legs="static"))
    assert np.max(np.abs(run.dataset.pose_error)) <= 1e-6
    check_balance(run)


def test_the_frame_is_held_by_legs_that_do_not_swing():
    """Where servos cannot be had, computed torque stands in, as it can for these legs."""
    assert held_frame(hexapod(0), way(hexapod(0))).legs == "moving"
    law = held_frame(hexapod(1), way(hexapod(1)))
    assert law.legs == "static"
    assert law.verdict() is None


def test_leg_motion_of_bent_legs():
    """Positions and rates of the joints by inverse geometry at the trajectory's states with that bend;
    accelerations by central differences of the rates over 20 µs, good to 1e-7."""
    model, step = reference(), 1e-5
    rng = np.random.default_rng(0)
    bend = tuple(1e-3 * rng.normal(size=7) for _ in range(6))
    rates = tuple(rng.normal(size=7) for _ in range(6))
    state = replace(model.robot.home, leg_elastic=bend, leg_elastic_rate=rates)
    path, t = way(model), np.array([0.7, 0.9, 1.2])
    found = pf.leg_motion(model, path, t, state=state)

    def joints(times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        sample = path.sample(times)
        legs = model.joints(pf.State(sample.position, sample.rotation, sample.twist, leg_elastic=bend))
        return tuple(np.stack([leg[:, 2] for leg in part], axis=-1) for part in legs)

    q, qd = joints(t)
    assert relative(found.positions, q) <= 1e-12
    assert relative(found.rates, qd) <= 1e-12
    slopes = (joints(t + step)[1] - joints(t - step)[1]) / (2 * step)
    assert relative(found.accelerations, slopes) <= 1e-7


def test_rigid_forces_are_recorded():
    """The forces of a robot that cannot bend, along the way: at its start the weight, carried by six legs."""
    model = hexapod(1)
    run = pf.simulate(model, pf.Servo(model, way(model)), model.robot.home, [0.0, 0.01])
    forces = run.dataset.rigid_forces.values[0]
    assert relative(forces, model.equilibrium(*model.robot.home_pose)[1]) <= 1e-4
