"""Soft tips, drives that give, couplings, bent legs and a bent platform on a base that moves, all at once:
against Lagrange's equations (`support/lagrange.py`), and against differences of what these have checked."""

import numpy as np
import pytest

import flexlegs
import parflex as pf
from differences import by_column, difference, moved
from floors import shifted
from gives import at
from lagrange import Lagrange, errors
from measures import relative
from parflex.kernels.motion import derivative

AGREED = 1e-10  # two solutions in 64 bits; 2e-11 is reached
SAME = 1e-12
DIFFERENCES = 1e-7  # central ones, extrapolated once or twice: of their own error
STEPS = {  # where what is left out of the differences is as large as round-off
    "position": 1e-3,
    "rotation": 1e-3,
    "velocity": 3e-3,
    "omega": 3e-3,
    "elastic": 1e-4,
    "elastic_rate": 3e-3,
    "joints": 5e-4,
    "joint_rates": 1e-3,
}


@pytest.mark.parametrize("backend", ["numpy", "vm", "native"])
@pytest.mark.parametrize("name", flexlegs.NAMES)
def test_they_obey_lagranges_equations(name, backend):
    """Accelerations, contact forces, energies, and the power of the floor."""
    robot, state, base, forces = at(name, 1)
    model, answer = pf.Model(robot, backend), Lagrange(robot)(state, forces, base)
    found = errors(answer, model, state, forces, base)
    assert max(found.values()) <= AGREED, found
    assert max(answer.gap, answer.gap_rate) <= 1e-12  # m, m/s: hard tips
    assert sum(model.energies(state, base=base)) == pytest.approx(answer.energy, rel=SAME)
    core = model._core.on(base)
    powers = core.functions(derivative).run(x=core.flat(state), forces=forces)["powers"]
    assert powers[-1] == pytest.approx(answer.floor_power, rel=AGREED)


@pytest.mark.parametrize("backend", ["numpy", "vm", "native"])
@pytest.mark.parametrize("name", flexlegs.NAMES)
def test_the_forces_that_are_found_give_the_motors_their_accelerations(name, backend):
    """θ̈ = q̈ − δ̈ where the drive gives."""
    robot, state, base, _ = at(name, 2)
    model = pf.Model(robot, backend)
    target = np.linspace(-2.0, 3.0, robot.n_forces)
    found = model.inverse(state, target, pf.JointOutput(), base=base)
    there = model.direct(state, found.forces, base=base)
    assert relative(motors(robot, there), target) <= 1e-9
    assert relative(there.platform, found.platform) <= 1e-9
    assert relative(there.contact_forces, found.contact_forces) <= 1e-9


def motors(robot, there):
    """The motors' accelerations of the direct model's answer; drives come last in what gives of a leg."""
    found = []
    for leg, q, e in zip(robot.legs, there.leg_joints, there.leg_elastic, strict=True):
        behind, own = list(e[len(e) - len(leg.drives) :]), q.copy()
        for j, joint in enumerate(leg.joints):
            if joint.drive_stiffness is not None:
                own[j] -= behind.pop(0)
        found += [own[j] for j, joint in enumerate(leg.joints) if joint.mu]
    return np.array(found)


def accelerations(core, x, forces):
    """(V̇_p, q̈_e, z̈ of legs that are carried) of a flat state by the direct model."""
    at = core.mechanism.layout.at
    load = np.zeros(6 + core.mechanism.platform.modes)
    rate = core.functions(derivative)(x=x, forces=forces, load=load)["rate"]
    twist, c = rate[at.twist].copy(), x[at.twist]
    twist[:3] += np.cross(c[3:], c[:3])
    return np.concatenate([twist, rate[at.elastic_rate], rate[at.joint_rates]])


def twice(function, size, step):
    """∂function/∂δ at 0 by central differences, extrapolated twice."""
    return (16 * difference(function, size, step / 2) - difference(function, size, step)) / 15


@pytest.mark.parametrize("name", flexlegs.NAMES)
def test_the_derivatives_are_slopes_of_the_direct_model(name):
    """By every small motion of the state, by forces, and by the base's pose, rates and accelerations."""
    robot, state, base, forces = at(name, 1)
    model = pf.Model(robot, "vm")
    core = model._core.on(base)
    x, found = core.flat(state), model.direct_jacobian(state, forces, base=base)
    by_state, motions = np.concatenate([found.state, found.carried]), core.mechanism.layout.motions
    for kind, part in zip(motions._fields, motions, strict=True):
        along = np.eye(core.mechanism.layout.motion_size)[part]
        expected = twice(
            lambda d, along=along: accelerations(core, moved(x, d @ along), forces), len(along), STEPS[kind]
        )
        assert by_column(by_state[:, part], expected) <= DIFFERENCES, kind
    by_forces = difference(lambda d: accelerations(core, x, forces + d), len(forces), 1.0)
    assert by_column(np.concatenate([found.forces, found.carried_forces]), by_forces) <= DIFFERENCES

    scale = np.repeat([1e-3, 1.0], [12, 6])  # of pose and rates, and of accelerations, which act linearly
    by_base = difference(
        lambda d: accelerations(model._core.on(shifted(base, scale * d)), x, forces), len(scale), 1.0
    )
    assert by_column(np.concatenate([found.base, found.carried_base]), by_base / scale) <= DIFFERENCES
