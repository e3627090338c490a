"""The base as an input: against closed forms, simulations, and gravity that leans."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import flexlegs
import parflex as pf
from parflex.linear.point import moved_with
from published_hexapods import cubic

K, L, M, INERTIA = 1e6, 0.4, 10.0, (0.1, 0.1, 0.2)
AXIS = np.array([0.6, 0.0, 0.8])

# the systems are compared with other routes to the same numbers, wherever they are, however they grow
pytestmark = [
    pytest.mark.filterwarnings("ignore::parflex.base.errors.BeyondBasis"),
    pytest.mark.filterwarnings("ignore::parflex.base.errors.UnstableEquilibrium"),
]


def at_rest(robot, **given):
    model = pf.Model(robot)
    state, forces = model.equilibrium(*robot.home_pose)
    return model, state, forces, model.linearise(state, forces, **given)


def test_what_arrives_at_a_cubic_hexapod():
    """Of a floor that slides: (Ω² + 2jζΩω)/(Ω² − ω² + 2jζΩω), Ω² = 2 k/m, in each direction; of one that
    turns about the centre the same with its own Ω (Preumont, Vibration Control of Active Structures)."""
    damping = 200.0
    robot, offset = cubic(1e-7, K, L, M, INERTIA, damping)
    lin = at_rest(robot)[-1]
    omega = np.geomspace(10.0, 3e3, 40)
    found = pf.transmissibility(lin, 0, offset)(omega).values
    squares = K * np.array([2, 2, 2, L**2 / 2, L**2 / 2, 2 * L**2]) / np.array([M, M, M, *INERTIA])
    spring = squares[:, None] * (1 + 1j * omega * damping / K)
    wanted = spring / (spring - omega**2)
    place = robot.home.position + robot.platform.nodes[0] + offset
    about_centre = np.einsum("orw,rs->osw", found, np.linalg.inv(moved_with(place)))
    assert np.max(np.abs(about_centre - np.eye(6)[..., None] * wanted[:, None])) <= 1e-5 * np.max(
        np.abs(wanted)
    )


def test_a_slow_floor_is_followed():
    """At ω = 0 the point goes with the base, but for what leaning gravity does: nothing without gravity."""
    robot = replace(flexlegs.robot("gs_flexlegs"), gravity=(0.0, 0.0, 0.0))
    lin = at_rest(robot, controller="locked")[-1]
    found = pf.transmissibility(lin, 3)([0.0]).values[..., 0].real
    assert np.allclose(found, moved_with(pf.NodeMotion(3).position(lin.point)), atol=1e-10)


def test_leaning_gravity_is_a_side_force():
    """The turn of a base held still at small angles: the sag of the point is that of the equilibrium under
    gravity turned back, by differences of two equilibria under the same forces (another route)."""
    robot, offset = cubic(1e-3, 1e4, L, M, INERTIA)
    robot = replace(robot, gravity=(0.0, 0.0, -9.81))
    _, state, forces, lin = at_rest(robot)
    leaned = pf.transmissibility(lin, 0, offset)([0.0]).values[..., 0].real
    moved, step = leaned - moved_with(pf.NodeMotion(0, offset).position(lin.point)), 1e-5
    found = []
    for sign in (1, -1):
        gravity = Rotation.from_rotvec([-sign * step, 0, 0]).apply(robot.gravity)
        other = pf.Model(replace(robot, gravity=gravity))
        there, _ = other.equilibrium(forces=forces, guess=state)
        found.append(there.position + there.rotation @ (robot.platform.nodes[0] + offset))
    assert np.allclose((found[0] - found[1]) / (2 * step), moved[:3, 3], rtol=1e-5, atol=1e-7)


@pytest.mark.parametrize("name", ["gs_flexlegs", "delta_flexarms_foreshortening"])
def test_the_linear_system_is_the_limit_of_simulations(name):
    """Relative to the base, under floors that move and turn less and less: the error falls with them."""
    robot = replace(flexlegs.robot(name), gravity=(0.0, 0.0, -9.81))
    model, state, forces, _ = at_rest(robot)
    law = pf.JointPD(model, state, 1e6, 2e3, forces)
    lin = model.linearise(state, forces, inputs=(pf.BaseAcceleration(),), controller=law, friction="smoothed")
    assert lin.base_states == 4  # turns about level axes, and their rates
    times, errors = np.linspace(0.0, 0.1, 21), []
    for size in (1e-4, 1e-5):
        run = pf.simulate(model, law, state, times, base=Floor(size), rtol=1e-11, atol=1e-14).dataset
        seen = run["relative_position"].values - state.position
        x = driven(lin, Floor(size), times)
        expected = (lin.C @ x)[:3].T
        errors.append(np.max(np.abs(seen - expected)) / np.max(np.abs(expected)))
    assert errors[0] <= 0.05
    assert errors[1] <= 0.15 * errors[0]


def driven(lin, floor, times):
    """The states of a linear system at rest that a floor drives."""
    slope = lambda t, x: lin.A @ x + lin.B @ floor(t).acceleration  # noqa: E731
    span = (times[0], times[-1])
    return solve_ivp(slope, span, np.zeros(len(lin.A)), "DOP853", times, rtol=1e-10, atol=1e-16).y


class Floor:
    """A floor that starts to slide and turn from rest, and comes back."""

    def __init__(self, size):
        self.size = size

    def __call__(self, t):
        w, way = 60.0, np.array([1.0, -0.5, 0.7])
        s, v, a = 1 - np.cos(w * t), w * np.sin(w * t), w * w * np.cos(w * t)
        R = Rotation.from_rotvec(self.size * s * AXIS).as_matrix()
        twist, acceleration = (self.size * np.concatenate([each * way, each * AXIS]) for each in (v, a))
        return pf.BaseMotion(self.size * s * way, R, twist, acceleration)


def test_an_accelerometer_feels_the_base():
    """On a robot whose motors are locked it reads at low frequency as on a stone that goes with the base: its
    acceleration, and gravity that leans."""
    robot, offset = cubic(1e-3, K, L, M, INERTIA)
    robot = replace(robot, gravity=(0.0, 0.0, -9.81))
    model, state, forces, _ = at_rest(robot)
    output = pf.Accelerometer(0, offset)
    given = {"inputs": (pf.BaseAcceleration(),), "outputs": (output,), "controller": "locked"}
    lin = model.linearise(state, forces, **given)
    omega = 1.0  # rad/s
    found = lin.frf([omega]).values[..., 0]
    stone = moved_with(output.position(lin.point))[:3]
    stone[:, 3:] -= np.cross(np.eye(3), robot.gravity).T / omega**2  # θ × g, with θ = −α/ω²
    assert np.allclose(found, state.rotation.T @ stone, rtol=1e-9, atol=1e-9)


def test_turns_of_the_base_are_no_modes_and_need_a_frequency():
    model, state, forces, lin = at_rest(pf.robots.gough_stewart(modes=2), inputs=(pf.BaseAcceleration(),))
    assert lin.base_states == 4
    assert len(lin.poles) == len(lin.A) - 4
    assert lin.modes().sizes["mode"] == len(model.linearise(state, forces).modes().mode)
    with pytest.raises(pf.InputError, match="omega holds 0, where an acceleration of the base leans"):
        lin.frf([0.0, 1.0])


def test_on_a_base_that_accelerates():
    """Seen from it the system is that of the robot at rest under gravity g − a, turned as the base is."""
    robot = flexlegs.mixed("gs_flexlegs")
    turn = Rotation.from_rotvec(0.3 * AXIS).as_matrix()
    base = pf.BaseMotion((0.2, 0.1, -0.3), turn, (0.5, 0.1, 0, 0, 0, 0), (2.0, -1.0, 3.0, 0, 0, 0))
    model = pf.Model(robot, "numpy")
    place = base.position + turn @ robot.home.position, turn @ robot.home.rotation
    state, forces = model.equilibrium(*place, base=base)
    lin = model.linearise(state, forces, base=base)
    felt = replace(robot, gravity=turn.T @ (robot.gravity - base.acceleration[:3]))
    other = pf.Model(felt, "numpy")
    there, holding = other.equilibrium(*robot.home_pose)
    assert np.allclose(forces, holding, rtol=1e-9)
    expected = other.linearise(there, holding)
    omega = [3.0, 30.0, 300.0]
    assert np.allclose(lin.frf(omega), expected.frf(omega), rtol=1e-7)
    with pytest.raises(pf.InputError, match="state moves relative to base, by 0.5"):
        model.linearise(replace(state, twist=np.zeros(6)), forces, base=base)


def test_effective_masses_are_the_mass():
    """Of a platform on legs without mass: what swings in all modes is its mass, and its inertia about the
    base's origin; modes of the centre hold all of the first (Preumont)."""
    robot, offset = cubic(1e-7, K, L, M, INERTIA)
    lin = at_rest(robot)[-1]
    found = lin.modes().participation
    assert np.allclose(found.sum("mode").values[:3], M, rtol=1e-5)
    centre = robot.home.position + robot.platform.nodes[0] + offset
    about = np.array(INERTIA) + M * (centre @ centre - centre**2)
    assert np.allclose(found.sum("mode").values[3:], about, rtol=1e-5)
    slides = found.values[:, :3]  # the three lowest, of one frequency, are those of the centre
    assert np.allclose(slides[:3].sum(axis=1), M, rtol=1e-4)
    assert np.allclose(slides[3:], 0.0, atol=1e-4)
