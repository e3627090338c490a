"""Robots whose tips are soft: equilibria, inverse models, backends, motions, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

import flexlegs
import parflex as pf
from parflex.analysis.small_motions import allowed
from parflex.mechanics.closure import displaced
from parflex.model.core import core_of
from soft import CASES, pulled_off, softened

SPRING = 10.0 * np.eye(3)


def stewart(translation: np.ndarray | None, modes: int = 4) -> pf.Robot:
    """The paper's robot on six flexures, which are soft where a translational stiffness is given."""
    robot = pf.robots.gough_stewart(modes=modes)
    damping = None if translation is None else 1e-4 * translation
    flexure = pf.Flexure(SPRING, translation=translation, translation_damping=damping)
    legs = [replace(leg, tips=[replace(tip, flexure=flexure) for tip in leg.tips]) for leg in robot.legs]
    return replace(robot, legs=legs)


def test_stiffened_tips_come_to_hold_the_platform():
    """The forces of the equilibrium at home, whose error falls with the stiffness."""
    ideal = stewart(None)
    _, expected = pf.Model(ideal, "numpy").equilibrium(*ideal.home_pose)
    off = []
    for times in (1e2, 1e4, 1e6):
        robot = stewart(5e4 * times * np.eye(3))
        _, forces = pf.Model(robot, "numpy").equilibrium(*robot.home_pose)
        off.append(np.max(np.abs(forces - expected)))
    assert off[0] / off[1] == pytest.approx(100, rel=0.05)
    assert off[1] / off[2] == pytest.approx(100, rel=0.05)


@pytest.mark.parametrize(
    "robot",
    [softened(flexlegs.mixed("gs_flexlegs"), CASES[1][1]), softened(pf.robots.delta(), [(0, 0), (1, 1)])],
    ids=["flexible legs", "Delta"],
)
def test_the_energy_is_least_at_an_equilibrium(robot):
    """Energy less the work of forces that stay, along every motion: differences of the energies alone."""
    model = pf.Model(robot, "numpy")
    core = core_of(model)
    state, forces = model.equilibrium(*robot.home_pose)
    x = core.flat(state)
    T = allowed(core.mechanism, x)
    driven = core.mechanism.driven
    S = np.eye(len(driven))[driven][core.mechanism.force_order]
    first = 6 + robot.platform.modes
    again, _ = model.equilibrium(forces=forces, guess=state)
    assert np.allclose(again.position, state.position, atol=1e-9)

    def energy(step: np.ndarray) -> float:
        there = core.state(displaced(core.mechanism, x, step))
        return sum(model.energies(model.project(there)))

    h, slopes = 1e-6, []
    for motion in T.T:
        slope = (energy(h * motion) - energy(-h * motion)) / (2 * h)
        slopes.append(slope - forces @ S @ motion[first:])
    assert np.max(np.abs(slopes)) <= 1e-4 * np.max(np.abs(forces))  # differences of 200 J in 64 bits


@pytest.mark.parametrize("backend", ["vm", "native"])
@pytest.mark.parametrize(("name", "which"), [CASES[0], CASES[2]])
def test_backends_agree(name, which, backend):
    robot = softened(flexlegs.mixed(name), which)
    state, forces = pulled_off(robot, 2), np.linspace(-50.0, 80.0, robot.n_forces)
    one, other = (pf.Model(robot, b).direct(state, forces) for b in ("numpy", backend))
    for a, b in zip(one, other, strict=True):
        assert np.max(np.abs(a - b)) <= 1e-12 * np.max(np.abs(a))


def test_joints_that_are_given_stay_and_others_close_the_tips():
    robot = stewart(5e6 * np.eye(3))
    model, home = pf.Model(robot, "numpy"), robot.home
    core = core_of(model)
    legs = model.joints(home)
    assert np.allclose(
        np.concatenate(legs.q), np.concatenate(pf.Model(stewart(None), "numpy").joints(home).q)
    )
    assert model.energies(home).springs == pytest.approx(0.0, abs=1e-12)
    pulled = replace(home, joints=tuple(q + 1e-3 for q in legs.q), joint_rates=tuple(q + 0.1 for q in legs.q))
    again = core.state(core.flat(pulled))
    assert all(np.array_equal(a, b) for a, b in zip(again.joints, pulled.joints, strict=True))
    assert all(np.array_equal(a, b) for a, b in zip(again.joint_rates, pulled.joint_rates, strict=True))
    assert model.energies(pulled).springs > 0


def test_inverse_models_through_soft_tips():
    """None for the platform; the motors' own accelerations, which the direct model gives back."""
    robot = stewart(5e6 * np.eye(3))
    model = pf.Model(robot, "numpy")
    state, _ = model.equilibrium(*robot.home_pose)
    for given in ({}, {"allow_ill_posed": True}, {"legs": "static"}):
        with pytest.raises(pf.InputError, match="soft tips give.*JointOutput"):
            model.inverse(state, np.zeros(6), **given)
    for asked in (lambda: model.inverse_jacobian(state, np.zeros(6)), lambda: model.output_report(state)):
        with pytest.raises(pf.InputError, match="soft tips give.*JointOutput"):
            asked()
    target = np.arange(6.0)
    found = model.inverse(state, target, output=pf.JointOutput())
    moved = model.direct(state, found.forces).leg_joints
    assert [q[2] for q in moved] == pytest.approx(target, abs=1e-8)
    mixed = replace(robot, legs=(*stewart(None).legs[:1], *robot.legs[1:]))
    model = pf.Model(mixed, "numpy")
    with pytest.raises(pf.InputError, match="soft tips give between motors and platform"):
        model.inverse(mixed.home, np.zeros(6))
    with pytest.raises(pf.InputError, match="soft tips give between motors and platform"):
        model.inverse_jacobian(mixed.home, np.zeros(6))
    with pytest.raises(pf.InputError, match="leave it out"):
        model.inverse(mixed.home, np.zeros(6), output=pf.JointOutput(), legs="static")


def test_a_run_keeps_the_energy():
    robot = stewart(5e6 * np.eye(3))
    model = pf.Model(robot)
    run = pf.simulate(model, np.zeros(6), robot.home, np.linspace(0, 0.05, 11), rtol=1e-11, atol=1e-13)
    ledger = run.dataset
    largest = float(np.max(np.abs(ledger["energy_kinetic"])))
    assert float(np.max(np.abs(ledger["energy_residual"]))) <= 1e-9 * largest
    assert float(ledger["energy_dissipated"][-1]) > 0
    assert float(np.max(ledger["energy_springs"])) > 0


def test_tips_that_carry_nothing_are_named():
    robot = stewart(np.diag([5e6, 5e6, 0.0]))
    free = stewart(np.zeros((3, 3)))
    with pytest.raises(pf.NotConverged, match="soft tips carry nothing along the twist"):
        pf.Model(free, "numpy").equilibrium(*free.home_pose)
    with pytest.raises(pf.NotConverged, match="soft tips carry nothing along the twist"):
        pf.Model(robot, "numpy").equilibrium(*robot.home_pose)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"translation": [[1, 2, 0], [0, 1, 0], [0, 0, 1]]}, "translation differs from its transpose by 2"),
        ({"translation": -np.eye(3)}, "translation has the principal value -1"),
        ({"translation_damping": np.eye(3)}, "translation_damping is given without translation"),
        (
            {"translation": np.eye(3), "translation_damping": -np.eye(3)},
            "translation_damping has the principal value -1",
        ),
    ],
)
def test_what_a_soft_tip_cannot_be(given, words):
    with pytest.raises(pf.InputError, match=words):
        pf.Flexure(**given)
