"""Lengths and angles of the legs along a trajectory, with their rates and accelerations."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import parflex as pf
import zoo
from measures import actuated, relative
from parflex.model.core import core_of

ENTRIES = {entry.name: entry for entry in pf.robots.ALL_ROBOTS if entry.output}
UP = (((0.0, 0.0, 0.05), (0.0, 0.0, 0.0)), ((0.0, 0.0, -0.03), (0.0, 0.0, 0.0)))
HEAVE = {"3-RPS": UP, "3-PRS": UP}  # they turn where they move aside, but not where they rise
STEP = 1e-5  # s, of central differences: their error is STEP² times a third derivative of some 1e3
RATES, ACCELERATIONS = 1e-6, 1e-6
SAME = 1e-11  # two orders of the same operations

robots = pytest.mark.parametrize("name", ENTRIES)


@cache
def robot(name: str, modes: int = 0) -> pf.Robot:
    return ENTRIES[name].build(modes=modes)


@cache
def model(name: str, modes: int = 0, backend: str = "numpy") -> pf.Model:
    return pf.Model(robot(name, modes), backend)


def way(name: str) -> pf.Trajectory:
    """A trajectory that the legs allow: the gallery's moves, and a circle where the robot can go round."""
    home, moves = robot(name).home, HEAVE.get(name, ENTRIES[name].moves)
    there = pf.Trajectory.through(home, moves, 0.4, rest=(0.1, 0.0))
    round_about = () if name in HEAVE else (pf.Circle(0.03, 2.0, 1, normal=(1, 1, 2), centre=(1, 0, 0)),)
    return pf.Trajectory.of(home, [*there.moves, *round_about], rest=(0.1, 0.1))


def inside(name: str, count: int) -> np.ndarray:
    """Instants of the trajectory, in order."""
    return np.sort(np.random.default_rng(0).uniform(0, way(name).duration, count))


def bent(name: str, modes: int) -> pf.State | None:
    """A state with a bend, of a robot whose legs allow any."""
    if robot(name).n_forces < 6:
        return None
    body = robot(name, modes).platform
    softer = body.stiffness[:1] / body.stiffness
    return replace(
        robot(name, modes).home, elastic=0.003 * softer * np.random.default_rng(1).normal(size=modes)
    )


@robots
@pytest.mark.parametrize("modes", [0, 3])
def test_rates_and_accelerations_are_derivatives(name, modes):
    """Central differences of the positions, and of the rates."""
    t = inside(name, 60)
    before, now, after = (
        pf.leg_motion(model(name, modes), way(name), t + s, state=bent(name, modes)) for s in (-STEP, 0, STEP)
    )
    slopes = [(b - a) / (2 * STEP) for a, b in zip(before[:2], after[:2], strict=True)]
    assert relative(now.rates, slopes[0]) <= RATES
    assert relative(now.accelerations, slopes[1]) <= ACCELERATIONS
    assert np.max(np.abs(now.accelerations)) > 0.1


@robots
def test_joints_are_those_of_the_models(name):
    """Positions and rates as `joints` has them at the states of the trajectory; accelerations as the forces
    cause them that the inverse model finds for it, on a rigid platform."""
    m, t = model(name), inside(name, 40)
    found, sample = pf.leg_motion(m, way(name), t), way(name).sample(t)
    states = sample.state(np.zeros(0))
    legs = m.joints(states)
    turned = (found.positions - actuated(m.robot, legs.q)) / (2 * np.pi)
    slides = np.array([joint.sigma for leg in m.robot.legs for joint in leg.joints if joint.mu], dtype=bool)
    assert np.max(np.abs(turned - np.where(slides, 0, np.round(turned)))) <= SAME
    assert relative(found.rates, actuated(m.robot, legs.qd)) <= SAME
    rows = list(ENTRIES[name].output)
    forces = m.inverse(states, sample.acceleration[:, rows], pf.FrameOutput(ENTRIES[name].output)).forces
    assert relative(found.accelerations, actuated(m.robot, m.joint_accelerations(states, forces))) <= 1e-9


@robots
@pytest.mark.parametrize("backend", ["vm", "native"])
def test_backends_agree(name, backend):
    """In batches of which eight share an instruction, and one by one; in any order and shape of the times."""
    t = np.random.default_rng(2).permutation(inside(name, 100))
    expected = pf.leg_motion(model(name, 3), way(name), t, state=bent(name, 3))
    for times, part in ((t, slice(None)), (t.reshape(4, 25), (slice(None),)), (t[:3], slice(3))):
        found = pf.leg_motion(model(name, 3, backend), way(name), times, state=bent(name, 3))
        for a, b in zip(found, expected, strict=True):
            assert a.shape == (*times.shape, robot(name).n_forces)
            assert relative(a.reshape(-1, a.shape[-1]), b[part]) <= SAME


def shifted(by: float) -> pf.Robot:
    """The 6-RUS whose cranks are measured from elsewhere."""
    legs = []
    for leg in robot("6-RUS").legs:
        first, *rest = leg.joints
        posture = None if leg.posture is None else leg.posture + np.eye(len(leg.joints))[0] * by
        legs.append(replace(leg, joints=(replace(first, theta=first.theta - by), *rest), posture=posture))
    return replace(robot("6-RUS"), legs=tuple(legs))


def test_angles_do_not_jump():
    """Cranks that pass half a turn go on; they differ from those measured elsewhere by a constant."""
    t = inside("6-RUS", 400)
    plain = pf.leg_motion(model("6-RUS"), way("6-RUS"), t).positions
    by = np.pi - np.mean(plain[:, 0])
    beyond = pf.leg_motion(pf.Model(shifted(by), "numpy"), way("6-RUS"), t).positions
    assert np.max(beyond[:, 0]) > np.pi or np.min(beyond[:, 0]) < -np.pi
    constant = beyond[0] - plain[0]
    assert relative(beyond, plain + constant) <= SAME
    assert relative(np.cos(constant - by), np.ones(6)) <= SAME


@pytest.mark.parametrize("branch", [-1.0, 1.0])
def test_branches_that_a_state_names(branch):
    """Cranks without a posture start where the state has them, and go on from there."""
    legs = tuple(replace(leg, posture=None) for leg in robot("6-RUS").legs)
    m = pf.Model(replace(robot("6-RUS"), legs=legs), "numpy")
    core = core_of(m)
    x = core.flat(robot("6-RUS").home)
    start = core.state(np.append(x[: core.mechanism.layout.at.branches.start], branch * np.ones(6)))
    found = pf.leg_motion(m, way("6-RUS"), [0.0, 0.2], state=start)
    assert relative(found.positions[0], actuated(m.robot, start.joints)) <= SAME
    assert np.max(np.abs(found.positions[1] - found.positions[0])) > 1e-3


def crooked(alpha: float) -> pf.Robot:
    """The paper's robot with universal joints askew, whose inverse geometry has no closed form."""
    straight, legs = robot("Gough-Stewart"), []
    postures = model("Gough-Stewart").joints(straight.home).q
    for leg, posture in zip(straight.legs, postures, strict=True):
        first, second, third = leg.joints
        joints = (first, replace(second, alpha=second.alpha + alpha), third)
        legs.append(replace(leg, joints=joints, posture=posture))
    return replace(straight, legs=tuple(legs))


def test_joints_that_are_carried():
    """Legs solved by Newton's method: the slider is as long as the straight one, whatever leads to it."""
    t, m = inside("Gough-Stewart", 12), pf.Model(crooked(0.2), "numpy")
    assert core_of(m).mechanism.layout.carried == 18
    expected = pf.leg_motion(model("Gough-Stewart"), way("Gough-Stewart"), t)
    home = replace(m.robot.home, joints=m.joints(m.robot.home).q)
    for state in (None, home):
        for a, b in zip(pf.leg_motion(m, way("Gough-Stewart"), t, state=state), expected, strict=True):
            assert relative(a, b) <= 1e-9


def test_no_instants():
    for part in pf.leg_motion(model("3-RPS"), way("3-RPS"), []):
        assert part.shape == (0, 3)


def moved(name: str, displacement, duration=1.0) -> pf.Trajectory:
    home = robot(name).home
    return pf.Trajectory.of(home, [pf.MoveTo(home.position + displacement, duration=duration)])


BAD = {
    "out of reach": (
        lambda: pf.leg_motion(model("6-RUS"), moved("6-RUS", (0, 0, 5)), np.linspace(0, 1, 11)),
        pf.OutOfReach,
        r"trajectory at t = 0\.\d s: pose: leg \d cannot reach its attachment",
    ),
    "off the closure": (
        lambda: pf.leg_motion(model("3-RPS"), moved("3-RPS", (0.1, 0, 0)), [0.0, 0.5]),
        pf.InputError,
        r"trajectory at t = 0.5 s: state is off the closure: a gap of .* m between leg",
    ),
    "states": (
        lambda: pf.leg_motion(
            model("6-RUS"), way("6-RUS"), 0.0, state=way("6-RUS").sample([0.0, 1.0]).state(np.zeros(0))
        ),
        pf.InputError,
        r"state is a batch \(2,\); give one state",
    ),
    "times": (
        lambda: pf.leg_motion(model("6-RUS"), way("6-RUS"), [np.nan]),
        pf.InputError,
        "t is nan at ind",
    ),
    "a state for a way": (
        lambda: pf.leg_motion(model("6-RUS"), robot("6-RUS").home, 0.0),
        pf.InputError,
        "trajectory is State; expected a Trajectory",
    ),
    "a leg with freedoms of its own": (
        lambda: pf.leg_motion(pf.Model(zoo.ups(6, 0, limber=True).robot, "numpy"), way("6-RUS"), 0.0),
        pf.InputError,
        "leg 6 has 5 joints, and its tips have 3 coordinates: a trajectory does not determine how they move",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_told(name):
    ask, error, words = BAD[name]
    with pytest.raises(error, match=words) as caught:
        ask()
    assert caught.type is error
