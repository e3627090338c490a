"""The oracle, the stored cases and the library against Pinocchio's constrained dynamics, for rigid platforms.

Pinocchio knows neither modes nor grouped parameters. At its default settings (μ = 0, one iteration) its
answers are exact to round-off.
"""

from functools import cache

import numpy as np
import pinocchio as pin
import pytest

import cases
import parflex as pf
import zoo
from measures import relative
from pin_robot import Motion, PinRobot

ORACLE = 1e-11  # two solutions in 64 bits: round-off leaves 1e-13
LIBRARY = 1e-9  # the accuracy the library promises
# Repeated rows need μ > 0, and iterations that take its effect away again.
PROXIMAL = {"accuracy": 1e-14, "mu": 1e-6, "max_iter": 50}
BACKENDS = ("numpy", "vm")

CASES = {name: lambda name=name: cases.case(name, "rigid") for name in cases.NAMES}
ODD = {f"odd{seed}": lambda seed=seed: zoo.odd(seed, 0) for seed in range(3)}
LIMBER = {"limber": lambda: zoo.ups(6, 0, limber=True)}
UPS = {"paper": zoo.paper, "eight legs": lambda: zoo.ups(8, 0), "loads": lambda: zoo.ups(6, 0, loads=True)}
THREE_RODS = {"three rods": zoo.three_rods}
ALL = CASES | UPS | ODD | LIMBER | THREE_RODS


@cache
def pinocchio(name: str) -> Motion:
    settings = pin.ProximalSettings(*PROXIMAL.values()) if name in THREE_RODS else None
    return PinRobot(ALL[name]()).direct(settings)


@pytest.mark.parametrize("name", ALL)
def test_oracle_agrees(name):
    sample, wanted = ALL[name](), pinocchio(name)
    found = sample.direct
    assert relative(found.platform, wanted.platform) <= ORACLE
    assert relative(np.concatenate(found.qdd, axis=-1), wanted.qdd) <= ORACLE
    if name not in THREE_RODS:
        assert relative(found.contact_forces, wanted.contact_forces) <= ORACLE


@pytest.mark.parametrize("name", CASES)
def test_stored_cases_agree(name):
    stored, wanted = cases.arrays(name, "rigid"), pinocchio(name)
    assert relative(stored["direct_platform"], wanted.platform) <= ORACLE
    assert relative(stored["direct_qdd"].reshape(wanted.qdd.shape), wanted.qdd) <= ORACLE
    assert relative(stored["direct_contact_platform"], wanted.contact_forces) <= ORACLE


@pytest.mark.parametrize("grouped", [False, True])
@pytest.mark.parametrize("backend", BACKENDS)
def test_the_papers_robot(backend, grouped):
    """With physical links, and with those of Table 3, which move the same."""
    sample, wanted = zoo.paper(), pinocchio("paper")
    legs = pf.robots.gough_stewart(0).legs if grouped else sample.legs
    robot = pf.Robot(legs, sample.body, sample.gravity, sample.home_pose)
    found = pf.Model(robot, backend).direct(sample.platform, sample.forces)
    assert relative(found.platform, wanted.platform) <= LIBRARY
    assert relative(found.contact_forces, wanted.contact_forces) <= LIBRARY


@pytest.mark.parametrize("name", ALL)
def test_library_agrees(name):
    """Accelerations of platform and joints, and contact forces where they are unique."""
    sample, wanted = ALL[name](), pinocchio(name)
    model = pf.Model(sample.robot, "numpy")
    found = model.direct(sample.states, sample.forces)
    qdd = model.joint_accelerations(sample.states, sample.forces)
    assert relative(found.platform, wanted.platform) <= LIBRARY
    assert relative(np.concatenate(qdd, axis=-1), wanted.qdd) <= LIBRARY
    if name not in THREE_RODS:
        assert relative(found.contact_forces, wanted.contact_forces) <= LIBRARY
