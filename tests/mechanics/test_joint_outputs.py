"""Accelerations of the actuated joints as outputs of the inverse model."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import flexlegs
import parflex as pf
from flexlegs import NAMES
from measures import relative

AGREED = 5e-12  # the references and this library; what is asked is 1e-9
ROBOTS = ("gough_stewart", "delta", "rus6", "prs3", "rps3", "pus6")
ROUND_TRIP = 1e-11  # of forces recovered from accelerations


def moving(model: pf.Model) -> pf.State:
    """A state in motion near home."""
    rng, home = np.random.default_rng(0), model.robot.home
    modes = model.robot.platform.modes
    return model.project(
        replace(home, twist=0.2 * rng.normal(size=6), elastic_rate=0.01 * rng.normal(size=modes))
    )


def driven(model: pf.Model, accelerations: pf.Accelerations) -> np.ndarray:
    """q̈_a (…, m) out of the accelerations of all joints."""
    legs = zip(model.robot.legs, accelerations.leg_joints, strict=True)
    return np.concatenate([qdd[..., [j.mu == 1 for j in leg.joints]] for leg, qdd in legs], axis=-1)


@pytest.mark.parametrize("backend", ["numpy", "vm", "native"])
@pytest.mark.parametrize("name", NAMES)
def test_flexible_legs(name, backend):
    """By the independent program of `data/`: forces, and the platform's acceleration that goes with them."""
    a, model = flexlegs.arrays(name), pf.Model(flexlegs.robot(name), backend)
    found = model.inverse(flexlegs.states(name), a["joint_target"], pf.JointOutput())
    assert relative(found.forces, a["joint_forces"]) <= AGREED
    assert relative(found.platform, a["joint_platform"]) <= AGREED


@cache
def on_numpy(name: str) -> pf.Model:
    return pf.Model(getattr(pf.robots, name)(modes=3), "numpy")


@pytest.mark.parametrize("name", ROBOTS)
def test_rigid_legs(name):
    """The joints' accelerations under known forces, wanted again, ask for the same forces; as a batch."""
    model, rng = on_numpy(name), np.random.default_rng(1)
    state, forces = moving(model), 100 * rng.normal(size=(4, model.robot.n_forces))
    there = model.direct(state, forces)
    back = model.inverse(state, driven(model, there), pf.JointOutput())
    assert relative(back.forces, forces) <= ROUND_TRIP
    assert relative(back.platform, there.platform) <= ROUND_TRIP


def test_some_joints_of_a_redundant_robot():
    """Six of the octapod's eight, with the rest left to the preload; eight are tied by the platform."""
    model, rng = on_numpy("octapod"), np.random.default_rng(2)
    state, forces = moving(model), 100 * rng.normal(size=8)
    wanted = driven(model, model.direct(state, forces))
    found = model.inverse(state, wanted[:6], pf.JointOutput(range(6)), preload=forces)
    assert relative(found.forces, forces) <= ROUND_TRIP
    with pytest.raises(pf.SingularPose, match="8 actuated joints do not accelerate each for itself"):
        model.inverse(state, wanted, pf.JointOutput())


@pytest.mark.parametrize("name", NAMES)
def test_flat_calls(name):
    a, model = flexlegs.arrays(name), pf.Model(flexlegs.robot(name), "native")
    compiled, m = model.compiled(pf.JointOutput()), model.robot.n_forces
    out = np.zeros(m + compiled.modes)
    state = flexlegs.states(name)[3]
    compiled.inverse(compiled.pack(state), np.array(a["joint_target"][3]), out)
    assert relative(out[:m], a["joint_forces"][3]) <= AGREED


def test_gains_of_collocated_joints_are_positive():
    """Motor and output are in one place: bending only adds to ∂q̈_a/∂Γ, which is symmetric."""
    model = pf.Model(flexlegs.robot("gs_flexlegs"), "numpy")
    report = model.output_report(model.robot.home, pf.JointOutput())
    assert np.min(report.gain_ratio.real) >= 1.0 - 1e-9
    assert np.max(np.abs(report.gain_ratio.imag)) <= 1e-9 * np.max(report.gain_ratio.real)


def test_what_it_refuses():
    model = on_numpy("rus6")
    for rows, words in (((0, 0), "each once"), ((9,), "0 … 5"), ((), "each once")):
        with pytest.raises(pf.InputError, match=words):
            model.inverse(model.robot.home, np.zeros(6), pf.JointOutput(rows))
    with pytest.raises(pf.InputError, match="give a FrameOutput or a PointOutput"):
        model.inverse_jacobian(model.robot.home, np.zeros(6), pf.JointOutput())
