"""Closed forms of bent legs against the same legs with all their coordinates carried, which need none."""

from dataclasses import replace

import numpy as np
import pytest

import parflex as pf
from bent import MODES, bent_leg
from measures import relative
from parflex.mechanics import dynamics
from parflex.mechanics.legs.carried import Carried
from parflex.mechanics.mechanism import mechanism_of
from parflex.mechanics.ordering import joints_of
from parflex.mechanics.redundancy import with_rows
from parflex.mechanics.system import assemble, assembled, examined
from parflex.robot.layout import coordinates, pack

CASES = {  # robot and its flexible links, from 1
    "UPS cylinder": (lambda: pf.robots.gough_stewart(modes=3), [2]),
    "UPS rod": (lambda: pf.robots.gough_stewart(modes=3), [3]),
    "UPS": (lambda: pf.robots.gough_stewart(modes=3), [2, 3]),
    "RPS": (pf.robots.rps3, [1, 2]),
    "RUS": (pf.robots.rus6, [1, 3]),
    "PUS": (pf.robots.pus6, [1, 3]),
    "PRS": (pf.robots.prs3, [1, 2]),
    "Delta": (pf.robots.delta, [1, 3, 5]),
}


def bent(name: str, flexures: bool) -> pf.Robot:
    make, links = CASES[name]
    robot, rng = make(), np.random.default_rng(7)
    legs = [bent_leg(leg, np.random.default_rng(3), links, flexures) for leg in robot.legs]
    legs[-1] = bent_leg(robot.legs[-1], rng, links, flexures)  # one unlike the others
    return replace(robot, legs=tuple(legs))


def state_on_closure(robot: pf.Robot) -> pf.State:
    """Pose and rates of the platform near home that bent legs allow, with bend and rates of everything."""
    rng, home, N = np.random.default_rng(5), robot.home, robot.platform.modes
    size = [MODES * sum(n > 0 for n in leg.modes) for leg in robot.legs]
    state = pf.State(
        home.position + 0.01 * rng.normal(size=3),
        home.rotation,
        0.2 * rng.normal(size=6),
        2e-4 * rng.normal(size=N),
        0.05 * rng.normal(size=N),
        leg_elastic=tuple(1e-3 * rng.normal(size=n) for n in size),
        leg_elastic_rate=tuple(0.05 * rng.normal(size=n) for n in size),
    )
    return pf.Model(robot, "numpy").project(state)


@pytest.mark.parametrize("flexures", [False, True], ids=["", "flexures"])
@pytest.mark.parametrize("name", CASES)
def test_closed_form_is_that_of_carried_legs(name, flexures):
    robot = bent(name, flexures)
    own, state = with_rows(mechanism_of(robot)), state_on_closure(robot)
    assert sum(own.layout.joints) == 0
    x = pf.Model(robot, "numpy").compiled().pack(state)
    system, _ = examined(own, x)
    found = joints_of(system)
    every = replace(state, joints=found.q, joint_rates=found.qd)
    other = replace(mechanism_of(robot, (Carried(),)), rows=own.rows, rows_unbent=own.rows_unbent)
    carried = assemble(other, coordinates(pack(every, other.layout), other.layout))
    for leg in carried.legs:
        assert np.max(np.abs(leg.gap)) <= 1e-10
        assert np.max(np.abs(leg.gap_rate)) <= 1e-9
    forces = np.random.default_rng(1).normal(size=robot.n_forces) * 10
    none = np.zeros(6 + robot.platform.modes)
    ours, theirs = (dynamics.direct_of(at, forces, none) for at in (assembled(own, x), carried))
    assert relative(ours.platform, theirs.platform) <= 1e-9
    assert relative(ours.elastic, theirs.elastic) <= 1e-9
