"""Flexures rest as they stand at home where nobody says how."""

from dataclasses import replace

import numpy as np
import pytest

import flexlegs
import parflex as pf
from measures import relative
from parflex.mechanics.legs import ALL_LEG_TYPES
from parflex.mechanics.rests import rested
from parflex.model.core import core_of

NAME = "gs_flexlegs"


def unsaid(robot: pf.Robot) -> pf.Robot:
    """The robot whose flexures do not say how they rest."""
    legs = tuple(
        replace(leg, tips=tuple(replace(tip, flexure=replace(tip.flexure, rest=None)) for tip in leg.tips))
        for leg in robot.legs
    )
    return replace(robot, legs=legs)


@pytest.mark.parametrize("types", [ALL_LEG_TYPES, ALL_LEG_TYPES[-1:]], ids=["closed", "carried"])
def test_the_rest_is_that_at_home(types):
    """The stored rests, which the program of `data/` took at this home; legs of Newton's method too, to what
    it leaves open."""
    robot = flexlegs.robot(NAME)
    posed = tuple(replace(leg, posture=q) for leg, q in zip(robot.legs, home_joints(robot), strict=True))
    given = unsaid(replace(robot, legs=posed))
    groups = rested(given, types).groups
    found = np.concatenate([group.flexures.rest for group in groups])[:, 0]
    numbers = [number for group in groups for number in group.legs]
    assert relative(found, flexlegs.arrays(NAME)["tip_rest"][numbers]) <= (1e-14 if len(types) > 1 else 1e-11)


def home_joints(robot: pf.Robot) -> tuple[np.ndarray, ...]:
    return pf.Model(robot, "numpy").joints(robot.home).q


def test_no_moment_and_no_energy_at_home():
    """Through every door: a model, and one of other parameters; accelerations are those of the given rest."""
    robot = flexlegs.robot(NAME)
    model = pf.Model(unsaid(robot), "numpy", ["gravity"])
    for each in (model, model.with_parameters({"gravity": [0.0, 0.0, -5.0]})):
        legs = core_of(each).system(robot.home).legs
        assert max(np.max(np.abs(leg.flexed.bending)) for leg in legs) <= 1e-14
        assert max(np.max(np.abs(leg.flexed.moment)) for leg in legs) <= 1e-12
    a, states = flexlegs.arrays(NAME), flexlegs.states(NAME)
    for backend in ("numpy", "vm", "native"):
        found = pf.Model(unsaid(robot), backend).direct(states, a["forces"])
        assert relative(found.platform, a["direct_platform"]) <= 5e-12


def test_rests_that_are_given_stay():
    """A rest turned by 0.1 rad makes a moment at home."""
    robot = flexlegs.robot(NAME)
    c, s = np.cos(0.1), np.sin(0.1)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    tip = robot.legs[0].tips[0]
    other = replace(tip, flexure=replace(tip.flexure, rest=turn @ tip.flexure.rest))
    model = pf.Model(replace(robot, legs=(replace(robot.legs[0], tips=(other,)), *robot.legs[1:])), "numpy")
    legs = core_of(model).system(robot.home).legs
    assert max(np.max(np.abs(leg.flexed.bending)) for leg in legs) == pytest.approx(
        2 * np.tan(0.05), rel=1e-9
    )
