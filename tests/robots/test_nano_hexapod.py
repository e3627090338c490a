"""The nano-hexapod: its stiffness and frequencies by hand, its motion by Lagrange's equations."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import parflex as pf
from lagrange import Lagrange, errors
from parflex.files.flexure_tables import turn_of
from parflex.model.core import core_of
from parflex.robots.nano_hexapod import (
    AXIAL,
    BENDING,
    HALF,
    HEIGHT,
    LEVER,
    SHELL,
    STACK,
    TORSION,
    feet,
    heads,
    nano_hexapod,
)

AGREED = 1e-9  # two solutions in 64 bits, of a robot whose stiffest spring swings at some kilohertz
BY_HAND = 1e-3  # what inertia along the springs in series and the load of the weight change


@cache
def model(modes: int, backend: str = "numpy") -> pf.Model:
    return pf.Model(nano_hexapod(modes), backend)


def cross(a: np.ndarray) -> np.ndarray:
    return np.cross(np.eye(3), a)  # a × b = −cross(a) b


def by_hand(robot: pf.Robot) -> np.ndarray:
    """Six frequencies in Hz of a rigid platform on struts whose springs have no mass.

    Along a strut: the shell beside stack and lever, both flexures in series with them, between which the
    upper half moves by a part of what the platform does. Across it: bending of either flexure. The halves are
    bars that turn about the foot.
    """
    actuator = SHELL + STACK * LEVER / (STACK + LEVER)
    k = 1 / (1 / actuator + 2 / AXIAL)
    part = k / actuator
    m, half = HALF.mass, 0.5 * HALF.length
    inertia = m * (3 * 0.005**2 + (2 * half) ** 2) / 12
    moments = robot.platform.moments
    K, M = np.zeros((6, 6)), np.zeros((6, 6))
    M[:3, :3] = moments.m * np.eye(3)
    M[3:, 3:] = np.trace(moments.P0) * np.eye(3) - moments.P0
    for head, foot in zip(heads(), feet(), strict=True):
        strut = head + (0, 0, HEIGHT) - foot
        length = np.linalg.norm(strut)
        u = strut / length
        along, across = np.outer(u, u), np.eye(3) - np.outer(u, u)
        head_moves = np.hstack([np.eye(3), cross(head)])
        turns = np.hstack([np.zeros((3, 3)), np.eye(3)])
        strut_turns = -cross(u) @ head_moves / length
        swung = m * (1 - half / length) ** 2 + m * (half / length) ** 2 + 2 * inertia / length**2
        M += head_moves.T @ (m * part**2 * along + swung * across) @ head_moves
        bent = across @ turns - strut_turns
        K += k * head_moves.T @ along @ head_moves + TORSION / 2 * turns.T @ along @ turns
        K += BENDING * (strut_turns.T @ strut_turns + bent.T @ bent)
    return np.sort(np.sqrt(np.linalg.eigvals(np.linalg.solve(M, K)).real)) / (2 * np.pi)


def frequencies(model: pf.Model) -> np.ndarray:
    poles = core_of(model).at_home.free_poles()
    return np.sort(np.abs(poles[poles.imag > 0])) / (2 * np.pi)


def test_frequencies_by_hand():
    found = frequencies(model(0))
    assert np.allclose(found[:6], by_hand(model(0).robot), rtol=BY_HAND)


def moved() -> pf.State:
    """A state whose tips, joints, levers and disc are some micrometres off, and move."""
    robot, rng = nano_hexapod(9), np.random.default_rng(3)
    legs = model(9).joints(robot.home)
    state = replace(
        robot.home,
        position=robot.home.position + 3e-5,
        twist=1e-3 * rng.normal(size=6),
        elastic=1e-6 * rng.normal(size=9),
        elastic_rate=1e-3 * rng.normal(size=9),
        joints=tuple(q + 1e-5 * rng.normal(size=q.shape) for q in legs.q),
        joint_rates=tuple(1e-3 * rng.normal(size=q.shape) for q in legs.q),
        leg_elastic=tuple(1e-6 * rng.normal(size=1) for _ in legs.q),
        leg_elastic_rate=tuple(1e-3 * rng.normal(size=1) for _ in legs.q),
    )
    return model(9).project(state)


@pytest.mark.parametrize("shaken", [False, True])
def test_it_obeys_lagranges_equations(shaken):
    """On a floor at rest, and on one that shakes."""
    rng = np.random.default_rng(4)
    base = pf.BaseMotion((1e-4, 2e-4, 0), np.eye(3), *1e-2 * rng.normal(size=(2, 6))) if shaken else None
    robot, state, forces = rests_given(nano_hexapod(9)), moved(), rng.normal(size=6)
    found = errors(Lagrange(robot)(state, forces, base), pf.Model(robot, "numpy"), state, forces, base)
    assert max(found.values()) <= AGREED, found


def rests_given(robot: pf.Robot) -> pf.Robot:
    """The robot whose flexures are told that they rest as they are at home, as the oracle wants it."""
    legs, q = list(robot.legs), pf.Model(robot, "numpy").joints(robot.home).q
    for number, leg in enumerate(legs):
        (tip,) = leg.tips
        assert tip.flexure is not None
        rest = np.asarray(leg.rotation) @ turn_of(leg, tip.frame, q[number])
        legs[number] = replace(leg, tips=[replace(tip, flexure=replace(tip.flexure, rest=rest))])
    return replace(robot, legs=legs)


def test_what_the_floor_does_is_in_the_balance():
    """A shaken floor's work is what the robot has and what the dampers took, over fifty milliseconds."""
    robot, t = nano_hexapod(0), np.linspace(0, 0.05, 251)
    m = pf.Model(robot)
    state, forces = m.equilibrium(*robot.home_pose)
    floor = pf.BaseSamples(t, np.outer(1e-5 * np.sin(2 * np.pi * 50 * t) * (t / 0.05) ** 3, (1, 0, 1)))
    run = pf.simulate(m, forces, state, t, base=floor, rtol=1e-10, atol=1e-13).dataset
    given = float(np.max(np.abs(run["energy_base"])))
    assert given > 1e-6
    assert float(np.max(np.abs(run["energy_residual"]))) <= 1e-7 * given
