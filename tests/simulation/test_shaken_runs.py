"""Runs of robots on a base that moves: against robots at rest, by the balance of energy, as they are told."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from scipy.spatial.transform import Rotation

import flexlegs
import parflex as pf
from measures import relative
from parflex.simulation.laws import controller_of
from parflex.simulation.laws.bound import differences
from parflex.simulation.loads import Loads
from parflex.simulation.summary import balance
from parflex.views.report.checks import legs_closed
from parflex.views.viewer.parts import legs_of, parts_of

BALANCED = 1e-9  # of the largest change of an energy
SAME = 1e-9  # of runs whose steps end elsewhere
CLOSED = 1e-10  # m
FINE = {"rtol": 1e-11, "atol": 1e-13}
AXIS = np.array([0.6, 0.0, 0.8])
T = np.linspace(0, 0.1, 21)


def shaking(t):
    """Three sines, and one of the angle about a slanted axis."""
    amplitude, rate = np.array([8e-3, 5e-3, 4e-3]), np.array([20.0, 13.0, 31.0])
    p, v = amplitude * np.sin(rate * t), amplitude * rate * np.cos(rate * t)
    angles = 0.05 * np.array([np.sin(9 * t), 9 * np.cos(9 * t), -81 * np.sin(9 * t)])
    R = Rotation.from_rotvec(angles[0] * AXIS).as_matrix()
    twist, acceleration = np.append(v, angles[1] * AXIS), np.append(-(rate**2) * p, angles[2] * AXIS)
    return pf.BaseMotion(p, R, twist, acceleration)


ROBOTS = {
    "hexapod that bends": lambda: flexlegs.robot("gs_flexlegs"),
    "Delta that bends": lambda: flexlegs.robot("delta_flexarms_foreshortening"),
    "carried joints": lambda: flexlegs.mixed("gs_flexlegs"),
    "Delta": pf.robots.delta,
    "3-RPS": pf.robots.rps3,
}


def held(model, **gains):
    """Springs on the motors about the equilibrium at home, and the state there."""
    state, forces = model.equilibrium(*model.robot.home_pose)
    return pf.JointPD(model, state, gains.get("kp", 1e5), gains.get("kd", 1e3), forces), state


@pytest.fixture(scope="module", params=ROBOTS)
def shaken(request):
    model = pf.Model(ROBOTS[request.param]())
    law, state = held(model)
    return pf.simulate(model, law, shaking(0.0).carried(state), T, base=shaking, **FINE)


def test_the_works_of_base_and_motors_are_the_energy(shaken):
    (found,) = balance(shaken.dataset)
    assert np.ptp(shaken.dataset["energy_base"].values) > 0.01  # J
    assert found.value <= BALANCED


def test_the_legs_hold_the_platform(shaken):
    assert legs_closed(shaken.dataset).found <= CLOSED


@pytest.mark.slow
def test_two_seconds_of_shaking():
    """Platform and legs that bend."""
    model = pf.Model(ROBOTS["hexapod that bends"]())
    law, state = held(model)
    times = np.linspace(0, 2, 201)
    run = pf.simulate(model, law, shaking(0.0).carried(state), times, base=shaking, rtol=1e-10, atol=1e-12)
    assert not run.partial
    assert next(balance(run.dataset)).value <= BALANCED


def seen(run):
    """What is seen from the base: pose, twist, bend."""
    data = run.dataset
    names = ("relative_position", "relative_rotation", "relative_twist")
    names = names if "base_position" in data else ("position", "rotation", "twist")
    bend = [data[name].values for name in ("elastic", "leg_elastic") if name in data]
    return [*(data[name].values for name in names), *bend]


@pytest.mark.parametrize("name", ["hexapod that bends", "Delta"])
def test_a_steady_acceleration_is_gravity(name):
    """g − a on a robot whose base is at rest, released from the same place."""
    robot, a = ROBOTS[name](), np.array([1.0, -2.0, 3.0])

    def accelerated(t):
        return pf.BaseMotion(0.5 * a * t * t, twist=np.append(a * t, [0, 0, 0]), acceleration=[*a, 0, 0, 0])

    model, other = pf.Model(robot), pf.Model(replace(robot, gravity=np.asarray(robot.gravity) - a))
    law, state = held(model)
    same = pf.JointPD(other, state, law.kp, law.kd, law.forces)
    run = pf.simulate(model, law, state, T, base=accelerated, **FINE)
    wanted = pf.simulate(other, same, state, T, **FINE)
    assert all(relative(a, b) <= SAME for a, b in zip(seen(run), seen(wanted), strict=True))


@pytest.mark.parametrize("name", ["hexapod that bends", "3-RPS"])
def test_a_base_at_rest_elsewhere_is_a_robot_with_gravity_turned(name):
    robot, R = ROBOTS[name](), Rotation.from_rotvec([0.3, -0.2, 0.5]).as_matrix()
    there = pf.BaseMotion([1.0, -2.0, 0.5], R)
    model, other = pf.Model(robot), pf.Model(replace(robot, gravity=R.T @ robot.gravity))
    law, state = held(model)
    same = pf.JointPD(other, state, law.kp, law.kd, law.forces)
    run = pf.simulate(model, law, there.carried(state), T, base=lambda t: there, **FINE)
    wanted = pf.simulate(other, same, state, T, **FINE)
    assert all(relative(a, b) <= SAME for a, b in zip(seen(run), seen(wanted), strict=True))
    points = wanted.dataset["leg_path"].values @ R.T + [1.0, -2.0, 0.5]
    assert relative(run.dataset["leg_path"].values, points) <= SAME
    assert relative(run.dataset["leg_axis"].values, wanted.dataset["leg_axis"].values @ R.T) <= SAME


def way_up(model):
    up = model.robot.home.position + (0, 0, 0.01)
    return pf.Trajectory.of(model.robot.home, [pf.MoveTo(up, duration=0.08)])


def test_servos_track_what_is_seen_from_the_base(model_of):
    """On a base of constant velocity nothing is different (Galilei)."""
    model, v = model_of(0, "native"), np.array([0.5, -0.3, 0.2, 0, 0, 0])
    servo = pf.Servo(model, way_up(model))
    state = model.robot.home
    gliding = lambda t: pf.BaseMotion(t * v[:3], twist=v)  # noqa: E731
    run = pf.simulate(model, servo, gliding(0.0).carried(state), T, base=gliding, **FINE)
    wanted = pf.simulate(model, servo, state, T, **FINE)
    assert all(relative(a, b) <= SAME for a, b in zip(seen(run), seen(wanted), strict=True))
    for name in ("pose_error", "joint_error", "rigid_forces"):
        assert relative(run.dataset[name].values, wanted.dataset[name].values) <= SAME
    ahead = run.dataset["desired_position"].values - wanted.dataset["desired_position"].values
    assert relative(ahead, np.outer(T, v[:3])) <= SAME


def test_the_desired_motion_of_servos_is_one_in_the_world(model_of):
    """V̇ of the desired pose, by differences of the desired position."""
    model, h = model_of(0, "native"), 1e-4
    times = np.array([0.0, 0.04 - h, 0.04, 0.04 + h])
    servo = pf.Servo(model, way_up(model))
    run = pf.simulate(model, servo, shaking(0.0).carried(model.robot.home), times, base=shaking)
    place, R = (run.dataset[f"desired_{name}"].values for name in ("position", "rotation"))
    actual = run.dataset["rotation"].values[2]
    second = (place[3] - 2 * place[2] + place[1]) / h**2
    found = actual @ run.dataset["desired_acceleration"].values[2, :3]
    assert np.allclose(found, second, rtol=0, atol=1e-4)
    assert np.allclose(R[2].T @ R[2], np.eye(3), rtol=0, atol=1e-12)


def test_computed_torque_tracks_in_the_world(model_of):
    """From a start that is wanted in the world, a rigid robot stays on the way whatever its base does."""
    model = model_of(0, "native")
    run = pf.simulate(
        model, pf.ComputedTorque(model, way_up(model)), model.robot.home, T, base=shaking, **FINE
    )
    assert np.max(np.abs(run.dataset["pose_error"].values)) <= 1e-9
    assert np.ptp(run.dataset["energy_base"].values) > 0.1


@pytest.mark.parametrize("kind", ["forces", "pd", "servo", "torque"])
def test_implicit_integrators_have_the_slopes_of_the_base(kind):
    model = pf.Model(pf.robots.gough_stewart(2), "numpy")
    law, state = held(model)
    laws = {
        "forces": lambda: law.forces,
        "pd": lambda: law,
        "servo": lambda: pf.Servo(model, way_up(model)),
        "torque": lambda: pf.ComputedTorque(model, way_up(model), 400, 40),
    }
    bound = controller_of(model, laws[kind]()).bind(model, Loads(model, (), shaking))
    x = bound.loads.flat(0.03, shaking(0.03).carried(state))
    x[7:13] += 0.1
    assert bound.differentiable
    found, wanted = bound.jacobian(0.03, x), differences(lambda x: bound.rate(0.03, x)[0].copy(), x)
    assert relative(found, wanted) <= 1e-6


@pytest.mark.parametrize("method", ["RK45", "Radau"])
def test_other_methods_come_to_the_same_end(method):
    model = pf.Model(pf.robots.rps3())
    law, state = held(model)
    start = shaking(0.0).carried(state)
    ends = [
        pf.simulate(model, law, start, T, base=shaking, method=each, rtol=1e-9, atol=1e-11).state(-1)
        for each in ("DOP853", method)
    ]
    assert relative(ends[1].position, ends[0].position) <= 1e-7


def test_functions_are_given_states_in_the_world(model_of):
    model, met = model_of(0, "native"), []

    def forces(t, state):
        met.append(shaking(t).seen(state).position)
        return law(t, shaking(t).seen(state))

    law, state = held(model)
    run = pf.simulate(model, forces, shaking(0.0).carried(state), T[:5], base=shaking, **FINE)
    wanted = pf.simulate(model, law, shaking(0.0).carried(state), T[:5], base=shaking, **FINE)
    assert relative(run.dataset["position"].values, wanted.dataset["position"].values) <= SAME
    assert np.allclose(met, state.position, rtol=0, atol=0.02)


def test_samples_are_a_motion_of_the_base(model_of):
    """Samples of the same motion, a thousand a second; no step is longer than five of them."""
    t = np.linspace(0, 0.2, 201)
    each = [shaking(time) for time in t]
    vectors = Rotation.from_matrix([motion.rotation for motion in each]).as_rotvec()
    samples = pf.BaseSamples(t, [motion.position for motion in each], vectors)
    model = model_of(0, "native")
    law, state = held(model)
    start = shaking(0.0).carried(state)
    run, wanted = (pf.simulate(model, law, start, T, base=base, **FINE) for base in (samples, shaking))
    assert relative(run.dataset["position"].values, wanted.dataset["position"].values) <= 1e-8
    assert run.dataset.attrs["max_step"] == pytest.approx(2e-3)
    beyond = np.linspace(0, 0.3, 4)
    with pytest.raises(
        pf.InputError, match=r"base samples go from t = 0 to 0.2 s, and t = 0.3 s is asked for"
    ):
        pf.simulate(model, law, start, beyond, base=samples)


@pytest.mark.parametrize(
    ("base", "words"),
    [
        (pf.BaseMotion(), r"base is BaseMotion; give a function of time, base\(t\)"),
        (lambda t: None, r"base\(t\) gave NoneType; give a BaseMotion"),
        (
            lambda t: pf.BaseMotion(np.zeros((2, 3))),
            r"base\(t\) gave a batch \(2,\) of motions; give a single one",
        ),
    ],
)
def test_what_is_no_motion_of_a_base_is_refused(model_of, base, words):
    model = model_of(0)
    with pytest.raises(pf.InputError, match=words):
        pf.simulate(model, np.zeros(6), model.robot.home, T, base=base)


def test_the_start_is_one_on_the_base():
    """A Delta that stands beside its base is off its closure."""
    model = pf.Model(pf.robots.delta(), "numpy")
    law, state = held(model)
    with pytest.raises(pf.InputError, match="off the closure: a gap velocity"):
        pf.simulate(model, law, state, T, base=shaking)


def test_an_error_of_the_function_keeps_what_was_reached(model_of):
    model = model_of(0)

    def breaking(t):
        if t > 0.05:
            raise KeyError("sensor")
        return shaking(t)

    law, state = held(model)
    with pytest.raises(pf.RunStopped) as caught:
        pf.simulate(model, law, shaking(0.0).carried(state), T, base=breaking)
    assert caught.value.result.dataset["time"].values[-1] <= 0.05
    assert isinstance(caught.value.__cause__, KeyError)


def test_results_tell_of_the_base(shaken, tmp_path):
    data = shaken.dataset
    for k in (0, 7):
        motion, state = shaking(T[k]), shaken.state(k)
        assert np.allclose(data["base_position"].values[k], motion.position, rtol=0, atol=1e-15)
        assert np.allclose(data["base_rotation"].values[k], motion.rotation, rtol=0, atol=1e-14)
        assert np.allclose(data["base_twist"].values[k], motion.twist, rtol=0, atol=1e-15)
        assert np.allclose(data["base_acceleration"].values[k], motion.acceleration, rtol=0, atol=1e-13)
        assert np.allclose(
            data["relative_position"].values[k], motion.seen(state).position, rtol=0, atol=1e-14
        )
        assert np.allclose(
            data["relative_rotation"].values[k], motion.seen(state).rotation, rtol=0, atol=1e-14
        )
    loaded = pf.load_result(shaken.save(tmp_path / "run.nc"))
    xr.testing.assert_identical(loaded.dataset, data)
    assert "Base and platform" in pf.plot.over_time(loaded)


def test_a_base_at_rest_is_not_told_of(model_of):
    run = pf.simulate(model_of(0), np.zeros(6), model_of(0).robot.home, [0, 1e-3])
    assert not [name for name in run.dataset.variables if "base" in str(name) or "relative" in str(name)]


def test_feet_move_with_the_base(shaken):
    """The solids at the feet stand, by the page's formula, as far from the feet as at the start."""
    data = shaken.dataset
    feet = [part for part in parts_of(legs_of(data)) if part.moves["kind"] == "carried"]
    assert len(feet) >= 3
    place = np.reshape(feet[0].moves["place"], (3, 4))
    for k in (0, 9):
        R, p = (data[f"base_{name}"].values[k] for name in ("rotation", "position"))
        foot = R.T @ (data["leg_path"].values[k, 0, 0] - p)
        assert np.allclose(foot[:2], place[:2, 3], rtol=0, atol=1e-12)
    start = np.eye(4)
    start[:3, :3], start[:3, 3] = (data[f"base_{name}"].values[0] for name in ("rotation", "position"))
    assert np.allclose(feet[0].still, start @ np.vstack([place, [0, 0, 0, 1]]), rtol=0, atol=1e-12)
