"""The direct model against Lagrange's equations, differentiated automatically (`support/lagrange.py`)."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import flexlegs
import parflex as pf
from lagrange import Lagrange, errors
from soft import CASES, pulled_off, softened

AGREED = 1e-10  # two solutions in 64 bits; 4e-12 is reached


@cache
def named(name):
    """A robot of bent legs, some rigid and some that carry their joints, with flexures; the rests given."""
    robot = flexlegs.mixed(name)
    joint = {"Fv": 3.0, "Fs": 2.0, "v_s": 0.1}
    legs = [replace(leg, joints=[replace(j, **joint) for j in leg.joints]) for leg in robot.legs]
    return replace(robot, legs=legs)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", flexlegs.NAMES)
def test_bent_legs_obey_lagranges_equations(name, seed):
    robot = named(name)
    model, state = pf.Model(robot, "numpy"), flexlegs.moving(robot, seed)
    legs = model.joints(state)
    state = replace(state, joints=legs.q, joint_rates=legs.qd)
    forces = 100.0 * np.random.default_rng(seed).normal(size=robot.n_forces)
    answer = Lagrange(robot)(state, forces)
    found = errors(answer, model, state, forces)
    assert max(found.values()) <= AGREED, found
    assert max(answer.gap, answer.gap_rate) <= 1e-10  # the oracle's own closure holds at the library's joints


@pytest.mark.parametrize(("name", "which"), CASES)
def test_soft_tips_obey_lagranges_equations(name, which):
    robot = softened(named(name), which)
    model, state = pf.Model(robot, "numpy"), pulled_off(robot, 1)
    legs = model.joints(state)
    state = replace(state, joints=legs.q, joint_rates=legs.qd)
    forces = 100.0 * np.random.default_rng(1).normal(size=robot.n_forces)
    answer = Lagrange(robot)(state, forces)
    found = errors(answer, model, state, forces)
    assert max(found.values()) <= AGREED, found
    assert max(answer.gap, answer.gap_rate) <= 1e-10
    assert sum(model.energies(state)) == pytest.approx(answer.energy, rel=1e-12)


@pytest.mark.parametrize("name", flexlegs.NAMES)
def test_the_energies_are_those_of_lagranges_function(name):
    robot = named(name)
    model, state = pf.Model(robot, "numpy"), flexlegs.moving(robot, 5)
    legs = model.joints(state)
    state = replace(state, joints=legs.q, joint_rates=legs.qd)
    answer = Lagrange(robot)(state, np.zeros(robot.n_forces))
    assert sum(model.energies(state)) == pytest.approx(answer.energy, rel=1e-12)
    assert answer.floor_power == pytest.approx(0.0, abs=1e-7 * abs(answer.energy))  # the base rests
