"""Assembly branches are entries of the flat state: x alone determines the answer, and batches mix branches.

The reference cases' 6-RUS without postures: its legs have two elbows each, and the stored joints name one. A
robot whose legs have the elbows as postures is the other route to every number.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import cases
import parflex as pf
from measures import relative
from parflex.model.core import core_of

SAME = 1e-12
BACKENDS = ("numpy", "vm", "native")
SAMPLE = cases.case("rus6", "flex")
LEGS = len(SAMPLE.robot.legs)


@cache
def bare(backend: str = "numpy") -> pf.Model:
    """The robot whose legs have no posture."""
    legs = tuple(replace(leg, posture=None) for leg in SAMPLE.robot.legs)
    return pf.Model(replace(SAMPLE.robot, legs=legs), backend)


def elbows(state: pf.State) -> tuple[tuple, tuple]:
    """Joints of the stored branch, and of the branch that legs have by themselves."""
    return state.joints, bare().joints(replace(state, joints=None, joint_rates=None)).q


def stated(joints) -> pf.Model:
    """The robot whose legs have these joints as postures."""
    legs = tuple(replace(leg, posture=q) for leg, q in zip(SAMPLE.robot.legs, joints, strict=True))
    return pf.Model(replace(SAMPLE.robot, legs=legs), "numpy")


def test_branches_come_after_all_else():
    """±1 for each leg that has two branches and no posture; other layouts are as they were."""
    N, layout = SAMPLE.robot.platform.modes, core_of(bare()).mechanism.layout
    assert layout.size == 13 + 2 * N + LEGS
    assert layout.at.branches == slice(13 + 2 * N, 13 + 2 * N + LEGS)
    assert core_of(pf.Model(SAMPLE.robot, "numpy")).mechanism.layout.size == 13 + 2 * N
    some = (*SAMPLE.robot.legs[:4], *(replace(leg, posture=None) for leg in SAMPLE.robot.legs[4:]))
    mixed = core_of(pf.Model(replace(SAMPLE.robot, legs=some), "numpy")).mechanism.layout
    assert mixed.branched == (4, 5)
    assert mixed.size == 13 + 2 * N + 2


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_flat_state_alone_determines_the_answer(backend):
    """Packing a state of another branch in between changes nothing for an older x."""
    state, forces = replace(SAMPLE.states[0], joint_rates=None), SAMPLE.forces[0].copy()
    there, here = elbows(state)
    c = bare(backend).compiled()
    first, other = c.pack(replace(state, joints=here)), c.pack(replace(state, joints=there))
    assert np.array_equal(first[:-LEGS], other[:-LEGS])
    assert set(first[-LEGS:]) | set(other[-LEGS:]) == {1.0, -1.0}
    before, after, elsewhere = (np.zeros(6 + c.modes) for _ in range(3))
    c.direct(first, forces, before)
    c.direct(other, forces, elsewhere)
    c.pack(replace(state, joints=there))
    c.direct(first, forces, after)
    assert np.array_equal(before, after)
    assert relative(before, elsewhere) > 0.1
    assert relative(c.unpack(other).joints[0], there[0]) <= 1e-9
    plain = stated(there).direct(replace(state, joints=None), forces)
    assert relative(elsewhere, np.concatenate([plain.platform, plain.elastic])) <= SAME


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_batch_mixes_branches(backend):
    """Three states, three sets of elbows: the batch, against one robot for each set."""
    states = replace(SAMPLE.states[:3], joint_rates=None)
    there, here = elbows(states)
    sets = [(1, 1, 1, 1, 1, 1), (0, 0, 0, 0, 0, 0), (1, 0, 0, 1, 0, 1)]  # 1: as stored
    joints = [np.stack([(there if sets[s][leg] else here)[leg][s] for s in range(3)]) for leg in range(LEGS)]
    mixed = replace(states, joints=tuple(joints))
    found = bare(backend).direct(mixed, SAMPLE.forces[:3])
    back = bare(backend).inverse(mixed, found.platform)
    assert relative(back.forces, SAMPLE.forces[:3]) <= 1e-9
    for s in range(3):
        one = stated([q[s] for q in joints])
        alone = one.direct(replace(states[s], joints=None), SAMPLE.forces[s])
        assert relative(found.platform[s], alone.platform) <= SAME
        assert relative(found.contact_forces[s], alone.contact_forces) <= SAME


@pytest.mark.parametrize("method", ["DOP853", "Radau"])
def test_a_run_stays_on_its_branch(method):
    """Constant under integration: the run of a robot that has the elbows as postures."""
    state, forces = replace(SAMPLE.states[0], joint_rates=None), SAMPLE.forces[0]
    there, _ = elbows(state)
    t = np.linspace(0, 0.01, 3)
    one = pf.simulate(bare("native"), forces, state, t, method=method).dataset
    two = pf.simulate(stated(there), forces, replace(state, joints=None), t, method=method).dataset
    assert relative(one.position, two.position) <= 1e-9
    assert relative(one.joint, two.joint) <= 1e-9
