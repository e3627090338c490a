"""Flexible legs against stored answers of an independent program.

It has the positions of all nodes by 4 × 4 matrices, their derivatives by automatic differentiation, sums over
nodes and a dense system with multipliers: no recursion, no moment tensors, no elimination (data/README.md).
"""

from dataclasses import replace

import numpy as np
import pytest

import flexlegs
import parflex as pf
from flexlegs import NAMES
from measures import relative
from parflex.model.core import core_of

AGREED = 5e-12  # 1e-12 was reached by the prototype of the formulas; what is asked is 1e-9

pytestmark = pytest.mark.filterwarnings("ignore::parflex.DynamicSingularity")


@pytest.fixture(scope="module", params=NAMES)
def name(request) -> str:
    return request.param


@pytest.fixture(scope="module", params=["numpy", "vm", "native"])
def model(request, name) -> pf.Model:
    return pf.Model(flexlegs.robot(name), request.param)


def by_leg(values) -> np.ndarray:
    """One (S, n_i) per leg as (S, legs, n)."""
    return np.stack(values, axis=1)


def test_closed_forms_stay_closed(name):
    """Only the elastic coordinates of the legs are entries of the state."""
    layout = core_of(pf.Model(flexlegs.robot(name), "numpy")).mechanism.layout
    assert sum(layout.joints) == 0
    assert sum(layout.elastic) == flexlegs.arrays(name)["leg_elastic"][0].size


def test_inverse_geometry(model, name):
    a = flexlegs.arrays(name)
    found = model.joints(flexlegs.states(name))
    assert relative(by_leg(found.q), a["joints"]) <= AGREED
    assert relative(by_leg(found.qd), a["joint_rates"]) <= AGREED


def test_direct(model, name):
    a = flexlegs.arrays(name)
    found = model.direct(flexlegs.states(name), a["forces"])
    assert relative(found.platform, a["direct_platform"]) <= AGREED
    assert relative(found.elastic, a["direct_elastic"]) <= AGREED
    assert relative(found.contact_forces, a["direct_contact"]) <= AGREED
    assert relative(by_leg(found.leg_joints), a["direct_joint_accelerations"]) <= AGREED
    assert relative(by_leg(found.leg_elastic), a["direct_leg_elastic"]) <= AGREED


def test_energies(model, name):
    a = flexlegs.arrays(name)
    found = model.energies(flexlegs.states(name))
    assert relative(found.kinetic, a["kinetic_energy"]) <= AGREED
    assert relative(found.gravity + found.strain + found.springs, a["potential_energy"]) <= AGREED


def test_reactions_along_the_joints_are_those_of_motors_and_springs(name):
    """Along the axis of a joint its link receives the motor's force less spring and rotor, and nothing else;
    the reactions come by the backward recursion, the accelerations by the contact system."""
    a, model = flexlegs.arrays(name), pf.Model(flexlegs.robot(name), "numpy")
    state, forces = flexlegs.states(name), a["forces"]
    found, moved = model.reactions(state, forces), model.direct(state, forces)
    q, driven = model.joints(state).q, 0
    for leg, force, moment, q_i, qdd in zip(
        model.robot.legs, found.force, found.moment, q, moved.leg_joints, strict=True
    ):
        scale = np.max(np.abs(force))
        for j, joint in enumerate(leg.joints):
            motor = forces[:, driven] if joint.mu else 0.0
            driven += joint.mu
            expected = motor - joint.k * (q_i[:, j] - joint.q_0) - joint.IA * qdd[:, j]
            axial = (force if joint.sigma else moment)[:, j, 2]
            assert np.max(np.abs(axial - expected)) <= 1e-9 * scale


def test_elastic_coordinates_of_another_number_are_refused():
    model = pf.Model(flexlegs.robot(NAMES[0]), "numpy")
    bad = replace(model.robot.home, leg_elastic=(np.zeros(3),) * 6)
    with pytest.raises(pf.InputError, match="this leg has 7 elastic coordinates"):
        model.direct(bad, np.zeros(6))


def test_forward_geometry_keeps_the_bend_of_the_guess():
    """The actuated joints of a bent robot lead back to its pose, from its bend; one of all poses is that."""
    name = NAMES[0]
    model = pf.Model(flexlegs.robot(name), "numpy")
    home, bend = model.robot.home, flexlegs.arrays(name)["leg_elastic"][0]
    state = replace(home, leg_elastic=tuple(bend))
    driven = [[joint.mu for joint in leg.joints].index(1) for leg in model.robot.legs]
    joints = [q[j] for q, j in zip(model.joints(state).q, driven, strict=True)]
    found = model.forward(joints, replace(state, position=home.position + (0.002, -0.001, 0.001)))
    poses = model.forward_all(joints, state, starts=3)
    for there in (found, poses[0]):
        assert np.max(np.abs(there.position - home.position)) <= 1e-10
        assert np.array_equal(np.stack(there.leg_elastic), bend)


def test_links_bent_beyond_reach_are_told_of():
    """Bent by metres, where no pose helps."""
    model = pf.Model(flexlegs.robot(NAMES[0]), "numpy")
    bad = replace(model.robot.home, leg_elastic=(np.full(7, 10.0),) * 6)
    with pytest.raises(pf.OutOfReach, match="leg 1 cannot reach its attachment.*or bend its links less"):
        model.direct(bad, np.zeros(6))
