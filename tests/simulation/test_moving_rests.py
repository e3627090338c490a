"""Runs with springs whose rest moves: against forces of motors, and by the balance of energy."""

from dataclasses import replace

import numpy as np
import pytest

import parflex as pf
from measures import relative
from parflex.simulation.summary import balance

T = np.linspace(0, 0.1, 21)
FINE = {"rtol": 1e-11, "atol": 1e-13}
SAME = 1e-9  # of runs by the same steps, nearly
K, FV = 2e5, 40.0


@pytest.fixture(scope="module")
def model():
    """The paper's robot with springs and friction on its motors, which rest where they stand at home."""
    robot = pf.robots.gough_stewart(2)
    lengths = [q[2] for q in pf.Model(robot, "numpy").joints(robot.home).q]
    legs = [
        replace(leg, joints=(*leg.joints[:2], replace(leg.joints[2], k=K, q_0=float(q), Fv=FV)))
        for leg, q in zip(robot.legs, lengths, strict=True)
    ]
    return pf.Model(replace(robot, legs=tuple(legs)))


def moved(model):
    """Rests 0.2 mm to and fro from home, each leg at its own time."""
    own = np.array([leg.joints[2].q_0 for leg in model.robot.legs])
    phase = np.arange(6)
    return lambda t: (own + 2e-4 * np.sin(60 * t + phase), 0.012 * np.cos(60 * t + phase))


def test_springs_are_named_in_their_order(model):
    assert model.robot.springs == tuple(f"leg {i}, joint 3" for i in range(1, 7))
    assert pf.robots.rps3().springs == ()


def test_a_rest_beside_a_motor_is_a_force(model):
    """Γ = k (r − q_0) + Fv ṙ."""
    rest, own = moved(model), np.array([leg.joints[2].q_0 for leg in model.robot.legs])

    def forces(t, state):
        r, rd = rest(t)
        return K * (r - own) + FV * rd

    home = model.robot.home
    run = pf.simulate(model, np.zeros(6), home, T, rest=rest, **FINE)
    wanted = pf.simulate(model, forces, home, T, **FINE)
    assert relative(run.dataset["position"].values, wanted.dataset["position"].values) <= SAME
    assert relative(run.dataset["elastic"].values, wanted.dataset["elastic"].values) <= SAME
    assert np.allclose(run.dataset["spring_rest"].values, [rest(t)[0] for t in T], rtol=0, atol=1e-15)


@pytest.mark.parametrize("based", [False, True])
def test_the_work_of_rests_closes_the_balance(model, based):
    def base(t):
        return pf.BaseMotion([0.01 * np.sin(30 * t), 0, 0], twist=[0.3 * np.cos(30 * t), 0, 0, 0, 0, 0],
                             acceleration=[-9 * np.sin(30 * t), 0, 0, 0, 0, 0])  # fmt: skip

    start = base(0.0).carried(model.robot.home) if based else model.robot.home
    run = pf.simulate(model, np.zeros(6), start, T, rest=moved(model), base=base if based else None, **FINE)
    assert np.ptp(run.dataset["energy_rests"].values) > 0.01
    assert ("energy_base" in run.dataset) == based
    assert next(balance(run.dataset)).value <= 1e-9


def test_rests_that_stay_change_nothing(model):
    own = np.array([leg.joints[2].q_0 for leg in model.robot.legs])
    run = pf.simulate(model, np.zeros(6), model.robot.home, T, rest=lambda t: (own, 0 * own), **FINE)
    wanted = pf.simulate(model, np.zeros(6), model.robot.home, T, **FINE)
    assert relative(run.dataset["position"].values, wanted.dataset["position"].values) <= SAME
    assert "spring_rest" not in wanted.dataset


@pytest.mark.parametrize(
    ("rest", "words"),
    [
        (np.zeros(6), r"rest is ndarray; give a function of time, rest\(t\)"),
        (lambda t: np.zeros(6), r"rest\(t\) gave ndarray; give a pair, rests \(6,\) and"),
        (
            lambda t: (np.zeros(6), 0.0),
            r"rest\(t\)\[1\] has shape \(\); give \(6,\), one for each spring of the robot",
        ),
        (
            lambda t: (np.zeros(6), np.full(6, np.nan)),
            r"rest\(t\)\[1\] is nan at index \(0,\); all values must be",
        ),
    ],
)
def test_what_is_no_rest_is_refused(model, rest, words):
    with pytest.raises(pf.InputError, match=words):
        pf.simulate(model, np.zeros(6), model.robot.home, T, rest=rest)


def test_a_robot_without_springs_has_no_rests(model_of):
    with pytest.raises(pf.InputError, match=r"no joint of the robot has a spring \(k > 0\); leave it out"):
        pf.simulate(model_of(0), np.zeros(6), model_of(0).robot.home, T, rest=lambda t: ([], []))
