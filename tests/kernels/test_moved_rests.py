"""Springs whose rest moves, against robots that are built with the rest, and against forces of the motors."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import parflex as pf
from measures import random_forces, random_states, relative
from parflex.compiled import choose
from parflex.kernels import motion
from parflex.kernels.kernel import kernel
from parflex.kernels.models import direct
from parflex.kernels.moved_rests import moved_rests
from parflex.mechanics.energy import energies, rests_power
from parflex.mechanics.redundancy import solvable
from parflex.mechanics.spring_rests import own_rests, springs
from parflex.mechanics.system import assembled

SAME = 1e-12  # the same numbers on another way
BACKENDS = ("numpy", "vm", "native")
FIELDS = ("position", "rotation", "twist", "elastic", "elastic_rate")


@cache
def sprung():
    """The paper's robot with springs and friction on its motors, and springs on two turning joints."""
    robot = pf.robots.gough_stewart(2)
    legs = []
    for i, leg in enumerate(robot.legs):
        joints = [*leg.joints[:2], replace(leg.joints[2], k=4e3, q_0=0.9, Fv=30.0, Fs=4.0, v_s=0.1)]
        if i in (1, 4):
            joints[1] = replace(joints[1], k=25.0, q_0=0.3, Fv=0.5)
        legs.append(replace(leg, joints=tuple(joints)))
    return replace(robot, legs=tuple(legs))


@cache
def compiled(backend):
    return choose(backend).compile(moved_rests(solvable(sprung()), direct))


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_rest_that_moves_is_that_of_another_robot(backend):
    """Rests without rates: the robot is built anew with each of them."""
    mechanism, rng = solvable(sprung()), np.random.default_rng(0)
    model = pf.Model(sprung(), "numpy")
    states, forces = random_states(sprung(), 4, 1), random_forces(model, 4, 2)
    rest = own_rests(mechanism) + rng.uniform(-0.1, 0.1, (4, len(own_rests(mechanism))))
    count = rest.shape[-1] // 2
    rest[:, count:] = 0.0
    x = model._core.flat(pf.State(*(np.stack([getattr(s, f) for s in states]) for f in FIELDS)))
    found = compiled(backend).run(x=x, forces=forces, rest=rest)["platform"]
    for i, state in enumerate(states):
        other = with_rests(sprung(), rest[i, :count])
        expected = pf.Model(other, "numpy").direct(state, forces[i]).platform
        assert relative(found[i], expected) <= SAME


def with_rests(robot, rests):
    """The robot with these q_0 of its springs."""
    legs = [list(leg.joints) for leg in robot.legs]
    for (i, j), q_0 in zip(springs(robot), rests, strict=True):
        legs[i][j] = replace(legs[i][j], q_0=float(q_0))
    pairs = zip(robot.legs, legs, strict=True)
    return replace(robot, legs=tuple(replace(leg, joints=tuple(joints)) for leg, joints in pairs))


@pytest.mark.parametrize("backend", BACKENDS)
def test_beside_a_motor_it_acts_as_a_force(backend):
    """Γ = k r + Fv ṙ on the same joint (the springs of motors are every third number or so)."""
    robot, rng = sprung(), np.random.default_rng(3)
    model, mechanism = pf.Model(robot, "numpy"), solvable(robot)
    state, forces = random_states(robot, 1, 1)[0], random_forces(model, 1, 2)[0]
    own = own_rests(mechanism)
    count = len(own) // 2
    motors = [n for n, (_, j) in enumerate(springs(robot)) if j == 2]
    r, rd = np.zeros(count), np.zeros(count)
    r[motors], rd[motors] = rng.uniform(-0.1, 0.1, 6), rng.uniform(-1, 1, 6)
    x = model._core.flat(state)
    found = compiled(backend).run(x=x, forces=forces, rest=own + np.concatenate([r, rd]))["platform"]
    pushed = forces + 4e3 * r[motors] + 30.0 * rd[motors]
    assert relative(found, model.direct(state, pushed).platform) <= SAME


def test_the_work_of_rests_that_move_closes_the_balance():
    """d(kinetic + potential)/dt = Γ q̇ − lost − Σ (k (q − r) + Fv (q̇ − ṙ)) ṙ, by differences of the energy."""
    robot = sprung()
    mechanism, rng = solvable(robot), np.random.default_rng(5)
    model = pf.Model(robot, "numpy")
    state, forces = random_states(robot, 1, 1)[0], random_forces(model, 1, 2)[0]
    own = own_rests(mechanism)
    count = len(own) // 2
    rest = own + rng.uniform(-0.1, 0.1, len(own))
    x, rd = model._core.flat(state), rest[count:]
    run = choose("numpy").compile(moved_rests(mechanism, motion.derivative))
    found = run.run(x=x, forces=forces, rest=rest)
    energy = choose("numpy").compile(moved_rests(mechanism, stored))

    def stored_at(t):
        there = np.concatenate([rest[:count] + t * rd, rd])
        return energy.run(x=x + t * found["rate"], rest=there)["energy"][0]

    h = 1e-5
    slope = (8 * (stored_at(h) - stored_at(-h)) - (stored_at(2 * h) - stored_at(-2 * h))) / (12 * h)
    joints = model.joints(state)
    work = 0.0
    for n, (i, j) in enumerate(springs(robot)):
        joint, q, qd = robot.legs[i].joints[j], joints.q[i][j], joints.qd[i][j]
        work -= (joint.k * (q - rest[n]) + joint.Fv * (qd - rd[n])) * rd[n]
    motors, _, lost, moving = found["powers"]
    given = energy.run(x=x, rest=rest)["given"][0]
    assert abs(given - work) <= 1e-12 * abs(work)
    assert abs(moving - work) <= 1e-12 * abs(work)
    assert abs(slope - (motors - lost + given)) <= 1e-8 * abs(slope)


def stored(mechanism):
    """The energy, and the power of the rests, as a kernel."""

    def function(x):
        system = assembled(mechanism, x)
        return {"energy": sum(energies(system))[..., None], "given": rests_power(system)[..., None]}

    return kernel("stored", function, mechanism, ("energy", "given"), energy=1, given=1)


@pytest.mark.parametrize("backend", BACKENDS)
def test_parameters_and_rests_are_inputs_together(backend):
    """The stiffness of the motors' springs as a parameter, and their rests."""
    robot = sprung()
    model = pf.Model(robot, backend, parameters=["legs[*].joints[2].k"])
    state, forces = random_states(robot, 1, 1)[0], random_forces(model, 1, 2)[0]
    rest = own_rests(solvable(robot)) + 0.05
    rest[len(rest) // 2 :] = 0.0
    theta = np.array([7e3])
    function = model._core.functions(moved_rests, direct, theta=theta)
    found = function.run(x=model._core.flat(state), forces=forces, rest=rest)["platform"]
    legs = [[*leg.joints[:2], replace(leg.joints[2], k=7e3)] for leg in robot.legs]
    pairs = zip(robot.legs, legs, strict=True)
    other = replace(robot, legs=tuple(replace(leg, joints=tuple(own)) for leg, own in pairs))
    other = with_rests(other, rest[: len(rest) // 2])
    assert relative(found, pf.Model(other, "numpy").direct(state, forces).platform) <= SAME
