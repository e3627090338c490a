"""The models against the oracle on every short leg there is, each by itself under a platform."""

import numpy as np
import pytest

import chains
import oracle
import parflex as pf
from measures import relative

LIBRARY = 1e-9  # the accuracy the library promises; the oracle is solved to 1e-12

pytestmark = pytest.mark.filterwarnings("ignore:.*beyond a dynamic singularity")


@pytest.mark.parametrize(
    ("kind", "count", "modes"), chains.cases(chains.kinds(), (1, 0), (2, 0), (1, 2), (2, 2))
)
def test_models(kind, count, modes):
    """Accelerations of platform, modes and joints; forces for wanted accelerations, where motors move it."""
    sample = chains.sample(kind, count, modes)
    model = pf.Model(sample.robot, "numpy")
    check_models(model, sample)
    qdd = model.joint_accelerations(sample.states, sample.forces)
    for found, wanted in zip(qdd, sample.direct.qdd, strict=True):
        assert relative(found, wanted) <= LIBRARY
    check_joints(model, sample)
    check_reactions(model, sample)
    check_energies(model, sample)


@pytest.mark.parametrize(("kind", "count", "modes"), chains.cases(chains.some(), (2, 1), (1, 0)))
@pytest.mark.parametrize("backend", ["vm", "native"])
def test_compiled_models(kind, backend, count, modes, recwarn):
    """The same from compiled code, singly, in batches and in wide ones."""
    sample = chains.sample(kind, count, modes)
    model = pf.Model(sample.robot, backend)
    check_models(model, sample)
    one = model.direct(sample.states[0], sample.forces[0])
    assert relative(one.platform, sample.direct.platform[0]) <= LIBRARY
    wide = model.direct(sample.states[np.arange(96) % 4], sample.forces[np.arange(96) % 4])
    assert relative(wide.platform[-4:], sample.direct.platform) <= LIBRARY
    assert not [w for w in recwarn if "virtual machine is used" in str(w.message)]


def check_models(model, sample):
    """The direct model; the inverse one, where there are motors."""
    direct = model.direct(sample.states, sample.forces)
    errors = {name: relative(getattr(direct, name), getattr(sample.direct, name)) for name in MOTION}
    if not any(at.repeats for at in sample.systems):
        errors["contact_forces"] = relative(direct.contact_forces, sample.direct.contact_forces)
    assert max(errors.values()) <= LIBRARY, errors
    if not sample.rows:
        return
    inverse = model.inverse(sample.states, sample.target, sample.output)
    errors = {name: relative(getattr(inverse, name), getattr(sample.inverse, name)) for name in FORCES}
    assert max(errors.values()) <= LIBRARY, errors


MOTION, FORCES = ("platform", "elastic"), ("forces", "platform", "elastic")


def check_joints(model, sample):
    """Positions, but for full turns, and rates."""
    found = model.joints(sample.states)
    for leg, q, qd, wanted, rate in zip(sample.legs, *found, sample.q, sample.qd, strict=True):
        turns = np.array([1 - joint.sigma for joint in leg.joints])
        apart = q - wanted
        assert np.max(np.abs(apart - turns * 2 * np.pi * np.round(apart / (2 * np.pi))), initial=0) <= LIBRARY
        assert relative(qd, rate) <= LIBRARY


def check_reactions(model, sample):
    """Along each joint's axis a link receives its motor's force, less friction, spring and rotor."""
    force, moment = model.reactions(sample.states, sample.forces)
    motor = 0
    for number, leg in enumerate(sample.legs):
        assert force[number].shape == moment[number].shape == (len(sample.forces), len(leg.joints), 3)
        loads = np.array(
            [oracle.joint_loads(leg, *at) for at in zip(sample.q[number], sample.qd[number], strict=True)]
        )
        for j, joint in enumerate(leg.joints):
            axial = (moment, force)[joint.sigma][number][:, j, 2]
            wanted = -loads[:, j] - joint.IA * sample.direct.qdd[number][:, j]
            if joint.mu:
                wanted, motor = wanted + sample.forces[:, motor], motor + 1
            assert relative(axial, wanted) <= LIBRARY


def check_energies(model, sample):
    """½ vᵀ M v by the oracle's mass matrix."""
    found = model.energies(sample.states).kinetic
    for s, at in enumerate(sample.systems):
        state, free = sample.platform[s], len(at.K) - at.sizes[-1]
        world = (np.reshape(state.twist, (2, 3)) @ at.R.T).ravel()
        v = np.concatenate([world, state.elastic_rate, *(qd[s] for qd in sample.qd)])
        assert relative(found[s], 0.5 * v @ at.K[:free, :free] @ v) <= LIBRARY
