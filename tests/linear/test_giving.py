"""Linear systems of robots with drives that give and soft tips: energies, motors, and what holds them."""

from dataclasses import replace

import numpy as np
import pytest

import parflex as pf
from compliant import compliant
from parflex.base.array import mv
from parflex.mechanics.closure import displaced
from parflex.model.core import core_of

# the systems are compared with other routes to the same numbers, wherever they are, however they grow
pytestmark = [
    pytest.mark.filterwarnings("ignore::parflex.base.errors.BeyondBasis"),
    pytest.mark.filterwarnings("ignore::parflex.base.errors.UnstableEquilibrium"),
]


def at_rest(robot):
    model = pf.Model(robot, "numpy")
    return model, *model.equilibrium(*robot.home_pose)


def test_energy_is_shared_out():
    """The shares are those of the energies that `model.energies` counts of a small displacement: springs of
    motors and drives, links, platform. The nano-hexapod without weight, whose springs start at rest."""
    robot = replace(pf.robots.nano_hexapod(modes=4), gravity=(0.0, 0.0, 0.0))
    model = pf.Model(robot, "numpy")
    state, forces = model.equilibrium(*robot.home_pose)
    lin = model.linearise(state, forces)
    modes, core, step = lin.modes(), core_of(model), 1e-7
    assert np.allclose(modes.share.sum("part"), 1.0, atol=1e-9)
    assert np.all(modes.share.sel(part="legs") == 0.0)  # rigid links
    shapes = modes["shape"].values[:6] + 1j * modes["shape_imag"].values[:6]
    for n, shape in enumerate(shapes):
        stored = []
        for part in (shape.real, shape.imag):
            moved = core.state(displaced(core.mechanism, lin.point.x, step * part))
            bent = 0.5 * moved.elastic**2 @ robot.platform.stiffness
            drives = [0.5 * 1.5e6 * delta[0] ** 2 for delta in moved.leg_elastic]
            motors = [
                0.5 * 43e6 * (q[2] - delta[0] - leg.joints[2].q_0) ** 2
                for q, delta, leg in zip(moved.joints, moved.leg_elastic, robot.legs, strict=True)
            ]
            given = model.energies(moved)
            whole = given.strain + given.springs
            stored.append([bent, sum(drives) + sum(motors), whole])
        bent, drives, whole = np.sum(stored, axis=0)
        share = modes.share[n]
        assert abs(bent / whole - share.sel(part="platform")) <= 1e-4
        assert abs(drives / whole - share.sel(part="drives")) <= 1e-4


def test_motors_are_seen_and_pushed_where_they_are():
    """A slow push on a motor moves it by what spring and drive give in series with what it moves: with the
    motors' references, springs of motors of 1e9 N/m, the motors follow at once."""
    robot = compliant(pf.robots.gough_stewart(2), k=1e9, Fs=0.0, Fv=0.0)
    model, state, forces = at_rest(robot)
    lin = model.linearise(state, forces, inputs=(pf.Reference(),), outputs=(pf.JointMotion(),))
    still = lin.frf([0.0]).values[..., 0].real
    assert np.allclose(still, np.eye(6), atol=1e-3)


def test_locked_motors_leave_the_drives():
    """Locked they are those of a robot whose drives are springs of joints without a motor (another model)."""
    robot = compliant(pf.robots.gough_stewart(3), k=0.0, Fs=0.0, Fv=0.0)
    model, state, forces = at_rest(robot)
    locked = model.linearise(state, forces, controller="locked").modes()
    q = model.joints(state).q
    legs = []
    for leg, joints, delta in zip(robot.legs, q, state.leg_elastic, strict=True):
        slide = leg.joints[2]
        spring = {"k": slide.drive_stiffness, "Fv": slide.drive_damping, "q_0": joints[2] - delta[0]}
        free = replace(slide, drive_stiffness=None, drive_damping=0.0, IA=0.0, **spring)
        legs.append(replace(leg, joints=(*leg.joints[:2], free)))
    other = pf.Model(replace(robot, legs=tuple(legs)), "numpy")
    there = replace(state, leg_elastic=None, leg_elastic_rate=None, joints=None, joint_rates=None)
    free = other.linearise(there, np.zeros(6)).modes()
    assert np.allclose(locked.frequency, free.frequency, rtol=1e-8)
    assert np.allclose(locked.damping, free.damping, rtol=1e-6, atol=1e-12)


def test_friction_that_sticks_holds_the_motor_not_the_link():
    """All motors stuck is all motors locked."""
    robot = compliant(pf.robots.gough_stewart(3), Fs=5.0, v_s=1e-3)
    model, state, forces = at_rest(robot)
    stuck = model.linearise(state, forces, friction="stuck")
    locked = model.linearise(state, forces, controller="locked")
    assert np.allclose(stuck.modes().frequency, locked.modes().frequency, rtol=1e-9)


def test_a_force_at_the_motor_accelerates_the_motor_alone():
    """At high frequency θ̈ = Γ / IA, and the platform rests: no path without inertia (closed form)."""
    robot = compliant(pf.robots.gough_stewart(0), Fs=0.0)
    model, state, forces = at_rest(robot)
    lin = model.linearise(state, forces, outputs=(pf.JointMotion(), pf.FramePose()))
    omega = 1e5
    found = -(omega**2) * lin.frf([omega]).values[..., 0]
    inertia = np.array([joint.IA for joint in robot.actuated])
    assert np.allclose(found[:6], np.diag(1 / inertia), atol=1e-4)
    assert np.max(np.abs(found[6:])) <= 1e-3
    assert np.allclose(mv(lin.D[:6], np.ones(6)), 0.0)
