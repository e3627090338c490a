"""Every call of a model on short legs and posts: right values, or one of the library's own errors."""

from dataclasses import replace

import numpy as np
import pytest

import chains
import oracle
import parflex as pf
from measures import actuated, relative
from sample import with_joints

LIBRARY = 1e-9  # the accuracy the library promises
CLOSED = 1e-11  # m, of a state found by Newton's method
FORWARD = 1e-9  # m and rad: it ends at 1e-10 of the platform's size

pytestmark = [
    pytest.mark.parametrize(("kind", "count", "modes"), chains.cases(chains.some(), (2, 1), (1, 0))),
    pytest.mark.filterwarnings("ignore:.*beyond a dynamic singularity"),
]


def case(kind, count, modes, backend="numpy", **options):
    sample = chains.sample(kind, count, modes)
    return sample, pf.Model(sample.robot, backend, **options)


NO_EQUILIBRIUM = ("no actuator forces hold the platform", "it is too soft for its weight")


def answer(call, *words):
    """What a call gives; None where one of the library's own errors says one of the sentences."""
    try:
        return call()
    except pf.InputError as error:
        if not any(word in str(error) for word in words):
            raise
        return None


def test_mobility(kind, count, modes):
    """The platform's freedoms are those of the null space of the closure where it does not bend."""
    sample, model = case(kind, count, modes)
    found, at = model.mobility(sample.states[0]), sample.systems[0]
    free = len(at.K) - at.sizes[-1]
    closure = np.delete(at.K[free:, :free], slice(6, 6 + modes), axis=1)
    _, sizes, right = np.linalg.svd(closure)
    motions = right[np.sum(sizes > 1e-6) :]
    assert found.freedoms == np.linalg.matrix_rank(motions[:, :6], tol=1e-6)
    assert str(found).startswith(f"The platform has {found.freedoms} freedoms")


def test_project(kind, count, modes):
    """A state a little off comes back on the closure."""
    sample, model = case(kind, count, modes)
    state = sample.states[0]
    off = replace(state, position=state.position + 1e-3)
    found = answer(lambda: model.project(off), "cannot reach its attachment")  # of a closed form that ends
    assert found is None or max(sample.open(found, model.joints(found).q)) <= CLOSED


def test_forward(kind, count, modes):
    """From a neighbouring state to the joints of another."""
    sample, model = case(kind, count, modes)
    wanted = actuated(sample.robot, [q[1] for q in sample.q])
    guess = model.joints(sample.states[1])
    start = with_joints(sample.platform[1], guess.q, guess.qd)
    found = answer(lambda: model.forward(wanted, start), "model.forward_all")
    if found is None:
        return
    q = model.joints(found).q
    assert sample.open(found, q)[0] <= FORWARD
    assert np.max(np.abs(actuated(sample.robot, q) - wanted), initial=0.0) <= FORWARD
    assert isinstance(model.forward_all(wanted, sample.states[1], starts=1), list)


def test_equilibrium(kind, count, modes):
    """The oracle finds no acceleration there; or it is said that nothing holds the platform."""
    sample, model = case(kind, count, modes)
    found = answer(lambda: model.equilibrium(*sample.robot.home_pose), *NO_EQUILIBRIUM)
    if found is None:
        return
    state, forces = found
    q = model.joints(state).q
    found = oracle.direct(sample, sample.cloud, state, forces, start=q, rates=[0 * q_i for q_i in q])
    assert max(np.max(np.abs(part), initial=0.0) for part in (*found[:2], *found[3])) <= 1e-6


def test_cartesian(kind, count, modes):
    """A V̇_p + c = J_sys⁻ᵀ Γ where every leg has J⁻¹."""
    sample, model = case(kind, count, modes)
    if len(kind.word) != 3 * len(kind.tips):
        with pytest.raises(pf.InputError, match="use model.direct and model.inverse"):
            model.cartesian(sample.states)
        return
    form = answer(lambda: model.cartesian(sample.states), "cannot move in all directions")
    if form is None:
        return
    sides = np.einsum("sij,sj->si", form.A, sample.direct.platform) + form.c
    assert relative(np.einsum("sij,sj->si", form.Jsys_invT, sample.forces), sides) <= LIBRARY


def test_jacobians(kind, count, modes):
    """By forces, in which accelerations are linear; their shape and finiteness by all else."""
    sample, model = case(kind, count, modes)
    state, forces = sample.states[0], sample.forces[0]
    found = model.direct_jacobian(state, forces)
    assert np.all(np.isfinite(found.state))
    more = np.arange(1.0, 1 + len(forces))
    change = model.direct(state, forces + more).platform - model.direct(state, forces).platform
    assert relative(found.forces[:6] @ more, change) <= LIBRARY
    if not sample.rows:
        return
    back = model.inverse_jacobian(state, sample.target[0], sample.output)
    ahead = model.inverse(state, sample.target[0] + more[: len(sample.rows)], sample.output).forces
    change = ahead - model.inverse(state, sample.target[0], sample.output).forces
    assert relative(back.target @ more[: len(sample.rows)], change) <= 1e-7


def test_compiled(kind, count, modes):
    """The flat calls, which give what the oracle does."""
    sample, model = case(kind, count, modes, "vm")
    flat = model.compiled(sample.output) if sample.rows else model.compiled()
    x, out = flat.pack(sample.states[0]), np.zeros(6 + modes)
    flat.direct(x, sample.forces[0].copy(), out)
    assert relative(out[:6], sample.direct.platform[0]) <= LIBRARY
    forces = np.zeros(len(sample.rows) + modes)
    if not sample.rows:
        with pytest.raises(pf.InputError, match="prescribes 6 accelerations, but the robot has 0"):
            flat.inverse(x, np.zeros(6), forces)
        return
    flat.inverse(x, sample.target[0].copy(), forces)
    assert relative(forces[: len(sample.rows)], sample.inverse.forces[0]) <= LIBRARY


def test_too_few_motors(kind, count, modes):
    """All six accelerations of the platform are more than short legs command."""
    sample, model = case(kind, count, modes)
    if len(sample.rows) < 6:
        with pytest.raises(pf.InputError, match=f"the robot has {len(sample.rows)} actuators"):
            model.inverse(sample.states, np.zeros(6))
    if sample.rows:
        words = (*NO_EQUILIBRIUM, "singularity")
        report = answer(lambda: model.output_report(sample.robot.home, sample.output), *words)
        assert report is None or np.all(np.isfinite(report.poles))


@pytest.mark.parametrize("backend", ["numpy", "vm"])
def test_parameters(kind, count, modes, backend):
    """Other gravity and another mass at run time are those of a robot built so."""
    names = ["gravity", *(["legs[0].joints[0].M"] if kind.word else [])]
    sample, model = case(kind, count, modes, backend, parameters=names)
    values = {"gravity": (1.0, 2.0, 3.0)} | {name: 0.7 for name in names[1:]}
    first, *others = sample.robot.legs
    joints = [replace(joint, M=0.7) if i == 0 else joint for i, joint in enumerate(first.joints)]
    built = replace(sample.robot, legs=(replace(first, joints=joints), *others), gravity=(1.0, 2.0, 3.0))
    found = model.direct(sample.states, sample.forces, parameters=values)
    wanted = pf.Model(built, "numpy").direct(sample.states, sample.forces)
    assert relative(found.platform, wanted.platform) <= LIBRARY
    jacobian = model.direct_jacobian(sample.states[0], sample.forces[0])
    assert jacobian.parameters.shape == (6 + modes, 3 + len(names) - 1)
    assert np.all(np.isfinite(jacobian.parameters))


def test_simulate(kind, count, modes):
    """A few milliseconds, in which no energy is lost and the platform moves as its acceleration says."""
    sample, model = case(kind, count, modes, "vm")
    t = np.linspace(0, 4e-3, 5)
    result = pf.simulate(model, sample.forces[0], sample.states[0], t, max_step=1.0)
    assert not result.partial
    data = result.dataset
    assert np.max(np.abs(data.energy_residual)) <= 1e-7 * max(1.0, np.max(np.abs(data.energy_kinetic)))
    assert relative(data.acceleration.values[0], sample.direct.platform[0]) <= LIBRARY
    assert data.joint.sizes["leg"] == count
