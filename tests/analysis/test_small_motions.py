"""Small motions about an equilibrium: poles of servos, of locked legs, and of a frame that is held."""

from dataclasses import replace

import numpy as np
import pytest

import parflex as pf
from heavy_disc import disc, flat_shapes, on_struts
from parflex.analysis.small_motions import about
from parflex.compiled import choose
from parflex.compiled.functions import Functions
from parflex.mechanics.contact import legs_at_tips
from parflex.mechanics.legs import ALL_LEG_TYPES
from parflex.mechanics.mechanism import mechanism_of
from parflex.model.core import core_of
from parflex.robot.parameters import Parameters
from parflex.simulation.laws.bound import BoundLaw
from parflex.simulation.laws.controller import Controller
from parflex.simulation.loads import Loads

DIFFERENCES = 1e-5  # of poles by central differences of a step of 1e-6, against exact derivatives
SIX = ("rus6", "pus6", "gough_stewart")


def motions_of(model: pf.Model):
    return about(core_of(model).readable, model.robot.home)


def of_the_whole(model: pf.Model, controller: Controller, state: pf.State) -> np.ndarray:
    """Eigenvalues of the exact, compiled ∂ẋ/∂x of the closed loop in the flat state."""
    law: BoundLaw = controller.bind(model, Loads(model, ()))
    return np.linalg.eigvals(law.jacobian(0.0, core_of(model).flat(state)))


def found_among(poles: np.ndarray, others: np.ndarray) -> float:
    """The largest distance of a pole from the nearest of the others, of its own size."""
    away = np.abs(poles[:, None] - others[None])
    return float(np.max(np.min(away, axis=1) / np.maximum(1.0, np.abs(poles))))


@pytest.mark.parametrize("name", SIX)
def test_servo_poles_against_the_exact_derivative(name):
    model = pf.Model(getattr(pf.robots, name)(modes=5), "vm")
    state, forces = model.equilibrium(*model.robot.home_pose)
    hold = pf.JointPD(model, state, kp=4e4, kd=300.0, forces=forces)
    m = model.robot.n_forces
    poles = motions_of(model).servo_poles(np.full(m, 4e4), np.full(m, 300.0), np.zeros(m))
    assert len(poles) == 2 * (6 + 5)
    assert found_among(poles, of_the_whole(model, hold, state)) <= DIFFERENCES


def test_legs_are_locked_by_gains_without_end(model_of):
    """The locked robot's poles are those of stiff servos, and nearer as 1/kp as they stiffen."""
    motions = motions_of(model_of(5))
    locked = motions.locked_poles()
    assert len(locked) == 2 * 5

    def apart(kp: float) -> float:
        gains = np.full(6, kp)
        return found_among(locked, motions.servo_poles(gains, 1e-2 * gains, 0 * gains))

    near, nearer = apart(1e7), apart(1e9)
    assert 80 < near / nearer < 120, (near, nearer)


def test_the_papers_plate_buckles_on_locked_legs(model_of):
    """A real pole of +2.4 … 3.2 1/s, which an independent linear analysis of the paper's robot gives."""
    growth = [motions_of(model_of(n)).locked_poles().real.max() for n in (9, 11)]
    assert all(2.4 < rate < 3.2 for rate in growth), growth


@pytest.mark.parametrize("name", ["rus6", "delta", "prs3", "octapod"])
def test_effective_masses_against_the_rigid_robot(name):
    """∂q̈_a/∂Γ by the direct model of the robot whose platform is rigid; it is symmetric."""
    flexible, rigid = (getattr(pf.robots, name)(modes=n) for n in (3, 0))
    model = pf.Model(rigid)
    state, hold = model.equilibrium(*rigid.home_pose)
    driven = [np.flatnonzero([joint.mu for joint in leg.joints]) for leg in rigid.legs]

    def accelerations(forces: np.ndarray) -> np.ndarray:
        qdd = model.joint_accelerations(state, forces)
        return np.concatenate([q[which] for q, which in zip(qdd, driven, strict=True)])

    by_model = np.stack([accelerations(hold + push) - accelerations(hold) for push in np.eye(len(hold))], -1)
    for robot in (rigid, flexible):
        motions = motions_of(pf.Model(robot, "numpy"))
        sag = 1e-3 if robot is flexible else 1e-9
        assert np.max(np.abs(motions.joint_mobility() - by_model)) <= sag * np.max(np.abs(by_model))
    exact = motions_of(pf.Model(rigid, "numpy")).joint_mobility()
    assert np.max(np.abs(exact - exact.T)) <= 1e-9 * np.max(np.abs(exact))


def test_carried_joints_have_poles_too():
    """The same legs, in closed form and with their joints in the state."""
    robot = pf.robots.rus6(modes=3)
    functions = [
        Functions(mechanism_of(robot, types), choose("numpy"), Parameters(robot, ()))
        for types in (ALL_LEG_TYPES, ALL_LEG_TYPES[-1:])
    ]
    assert functions[1].mechanism.layout.carried == 18
    q = pf.Model(robot, "numpy").joints(robot.home).q
    found = [about(each, replace(robot.home, joints=q)) for each in functions]
    gains = np.full(6, 50.0)
    closed, carried = (motions.servo_poles(gains, 0.1 * gains, 0 * gains) for motions in found)
    assert found_among(closed, carried) <= DIFFERENCES
    assert found_among(*(motions.locked_poles() for motions in found)) <= DIFFERENCES


def held_frame(robot: pf.Robot) -> np.ndarray:
    """M of the theory: K e = ω² M e are the motions of the modes while forces of the actuators hold Σp.

    M = m_ee + W_e (1 − a (W_p a)⁻¹ W_p) M_t W_eᵀ − W_e a (W_p a)⁻¹ A_re, with M_t = (J A⁻¹ Jᵀ)⁻¹ the mass of
    the legs at their tips and a = M_t J A⁻¹ S the directions in which they push: what holds the frame comes
    along the struts, what it holds has inertia across them.
    """
    core = core_of(pf.Model(robot, "numpy"))
    system = core.system(robot.home)
    legs = legs_at_tips(system)
    M_t, W_p, W_e = np.linalg.inv(legs.compliance), system.W_p, system.W_e
    a = M_t @ legs.driven
    hold = a @ np.linalg.inv(W_p @ a)
    return robot.platform.m_ee + W_e @ (M_t - hold @ W_p @ M_t) @ W_e.T - W_e @ hold @ system.platform.A_re


def test_a_held_frame_has_an_unsymmetric_mass():
    """The poles of the zero dynamics are the eigenvalues of K e = ω² M e, whose M is not symmetric."""
    robot = replace(on_struts(disc(0.0)), gravity=np.zeros(3))
    poles = pf.Model(robot, "numpy").output_report(robot.home).poles
    M = held_frame(robot)
    omega = np.sqrt(np.linalg.eigvals(np.linalg.solve(M, np.diag(robot.platform.stiffness))).astype(complex))
    assert found_among(poles, np.concatenate([1j * omega, -1j * omega])) <= DIFFERENCES
    assert np.max(np.abs(M - M.T)) > 0.1
    assert np.max(poles.real) > 1000


def test_what_makes_a_held_frame_stable():
    """Without the shapes along the plane, and on struts with next to no inertia across them, nothing grows.

    The legs' servos, which push where they measure, leave every shape stable on the heavy struts.
    """
    body = disc()

    def growth(robot: pf.Robot) -> float:
        return float(np.max(pf.Model(robot, "numpy").output_report(robot.home).poles.real))

    heavy = on_struts(body)
    assert growth(heavy) > 1000
    assert growth(on_struts(body.with_modes(flat_shapes(body)))) < 0
    assert growth(on_struts(body, mass=0.02)) < 0
    motions = motions_of(pf.Model(heavy, "numpy"))
    mass = 1 / np.diag(motions.joint_mobility())
    for hertz in (5, 20, 80):
        omega = 2 * np.pi * hertz
        poles = motions.servo_poles(mass * omega**2, 1.4 * omega * mass, 0 * mass)
        assert np.max(poles.real) < 0
