"""The nano-hexapod: its stiffness and frequencies by hand, its motion by Lagrange's equations."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import parflex as pf
from lagrange import Lagrange, errors
from measures import relative
from parflex.model.core import core_of
from parflex.robots import nano_hexapod as built
from parflex.robots.nano_hexapod import nano_hexapod

AGREED = 1e-9  # two solutions in 64 bits, of a robot whose stiffest spring swings at some kilohertz
BY_HAND = 1e-3  # what inertia along the springs in series and the load of the weight change


@cache
def model(modes: int, backend: str = "numpy") -> pf.Model:
    return pf.Model(nano_hexapod(modes), backend)


def cross(a: np.ndarray) -> np.ndarray:
    return np.cross(np.eye(3), a)  # a × b = −cross(a) b


def by_hand(robot: pf.Robot) -> np.ndarray:
    """Six frequencies in Hz of a rigid platform on struts whose springs have no mass.

    Along a strut: the shell beside stack and lever, both flexures in series with them. Across it: bending of
    either flexure. The halves are bars that turn about the foot.
    """
    actuator = built.SHELL + built.STACK * built.LEVER / (built.STACK + built.LEVER)
    k = 1 / (1 / actuator + 2 / built.AXIAL)
    m, half = built.HALF.mass, 0.5 * built.HALF.length
    inertia = m * (3 * 0.005**2 + (2 * half) ** 2) / 12
    moments = robot.platform.moments
    K, M = np.zeros((6, 6)), np.zeros((6, 6))
    M[:3, :3] = moments.m * np.eye(3)
    M[3:, 3:] = np.trace(moments.P0) * np.eye(3) - moments.P0
    for head, foot in zip(built.heads(), built.feet(), strict=True):
        strut = head + (0, 0, built.HEIGHT) - foot
        length = np.linalg.norm(strut)
        u = strut / length
        along, across = np.outer(u, u), np.eye(3) - np.outer(u, u)
        head_moves = np.hstack([np.eye(3), cross(head)])
        turns = np.hstack([np.zeros((3, 3)), np.eye(3)])
        strut_turns = -cross(u) @ head_moves / length
        swung = m * (1 - half / length) ** 2 + m * (half / length) ** 2 + 2 * inertia / length**2
        M += head_moves.T @ (m * along + swung * across) @ head_moves
        bent = across @ turns - strut_turns
        K += k * head_moves.T @ along @ head_moves + built.TORSION / 2 * turns.T @ along @ turns
        K += built.BENDING * (strut_turns.T @ strut_turns + bent.T @ bent)
    return np.sort(np.sqrt(np.linalg.eigvals(np.linalg.solve(M, K)).real)) / (2 * np.pi)


def frequencies(model: pf.Model) -> np.ndarray:
    poles = core_of(model).at_home.free_poles()
    return np.sort(np.abs(poles[poles.imag > 0])) / (2 * np.pi)


def test_frequencies_by_hand():
    found = frequencies(model(0))
    print(found[:8], by_hand(model(0).robot))
    assert np.allclose(found[:6], by_hand(model(0).robot), rtol=BY_HAND)
