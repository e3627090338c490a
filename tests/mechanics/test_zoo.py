"""The library against the oracle on robots of any kind; joints with friction and springs."""

from functools import cache

import numpy as np
import pytest
from scipy.linalg import qr

import cases
import oracle
import parflex as pf
import zoo
from measures import relative
from parflex.mechanics.imposed import imposed_accelerations
from parflex.mechanics.ordering import by_leg
from parflex.model.core import core_of

ORACLE = 1e-10  # two solutions in 64 bits at conditions of 1e4: round-off leaves 1e-12
LIBRARY = 1e-9  # the accuracy the library promises

# Soft platforms have states in which they accelerate against their actuators; the library says so.
pytestmark = pytest.mark.filterwarnings("ignore:.*beyond a dynamic singularity")

# Legs with a closed form: the platform's state is all there is.
CLOSED_FORM = {
    "paper": zoo.paper,
    "8 legs": lambda: zoo.ups(8, 0),
    "8 legs, 3 modes": lambda: zoo.ups(8, 3),
    "24 legs, 40 modes": lambda: zoo.ups(24, 40),
    "loads, 0 modes": lambda: zoo.ups(6, 0, loads=True),
    "loads, 3 modes": lambda: zoo.ups(6, 3, loads=True),
}
ODD = {
    f"odd{seed}, {modes} modes": lambda seed=seed, modes=modes: zoo.odd(seed, modes)
    for seed, modes in ((0, 0), (1, 0), (2, 0), (0, 3), (1, 3), (3, 3), (4, 3))
}
LOADED_CASES = {
    f"{name}-{kind} with loads": lambda name=name, kind=kind: zoo.with_loads(cases.case(name, kind))
    for name in cases.NAMES
    for kind in ("rigid", "flex")
}
THREE_RODS = {"three rods": zoo.three_rods}
LIMBER = {f"limber, {modes} modes": lambda modes=modes: zoo.ups(6, modes, limber=True) for modes in (0, 3)}
ALL = CLOSED_FORM | ODD | LOADED_CASES | THREE_RODS | LIMBER


@cache
def model(name: str, backend: str) -> pf.Model:
    return pf.Model(ALL[name]().robot, backend)


# --- the oracle on them ---


@pytest.mark.parametrize("name", ALL)
def test_states_are_on_the_closure(name):
    sample = ALL[name]()
    for s, q in enumerate(zip(*sample.q, strict=True)):
        assert max(sample.open(sample.platform[s], q)) <= 1e-13


@pytest.mark.parametrize("name", ALL)
def test_oracle_inverse_after_direct(name):
    """The accelerations come back, by the same forces or, with spare actuators, by shorter ones."""
    sample, direct = ALL[name](), ALL[name]().direct
    spare = sample.forces.shape[1] > len(sample.rows)
    for s, at in enumerate(sample.systems):
        back = oracle.inverse_of(at, direct.platform[s][list(sample.rows)], sample.rows)
        assert relative(back.platform[list(sample.rows)], direct.platform[s][list(sample.rows)]) <= ORACLE
        if spare:
            assert np.linalg.norm(back.forces) < np.linalg.norm(sample.forces[s])
            again = oracle.direct_of(at, back.forces)
            assert relative(again.elastic, back.elastic) <= ORACLE
        else:
            assert relative(back.forces, sample.forces[s]) <= ORACLE
            assert relative(back.elastic, direct.elastic[s]) <= ORACLE


def test_accelerations_are_unique_where_forces_are_not():
    """27 rows of rank 24: without the three that repeat others K is regular, and the motion the same."""
    sample = zoo.three_rods()
    for s, at in enumerate(sample.systems):
        free = len(at.K) - at.sizes[-1]
        closure = at.K[free:, :free]
        assert at.repeats
        assert np.linalg.matrix_rank(closure, rtol=1e-9) == 24
        kept = np.sort(qr(closure.T, pivoting=True)[2][:24])
        chosen = np.concatenate([np.arange(free), free + kept])
        rhs = (at.rhs + at.S @ sample.forces[s])[chosen]
        short = oracle.balanced_solve(at.K[np.ix_(chosen, chosen)], rhs)[:free]
        qdd = np.concatenate([leg[s] for leg in sample.direct.qdd])
        assert relative(short[6:], qdd) <= ORACLE


@pytest.mark.parametrize("name", LOADED_CASES)
def test_loads_matter(name):
    """Without friction and springs the answers differ: the comparisons below do see them."""
    plain = cases.case(*name.split()[0].split("-"))
    assert relative(ALL[name]().direct.platform, plain.direct.platform) > 1e-4


# --- the library on them ---


def check(name, backend):
    """Direct and inverse model: Γ of least norm where there is a choice, and what goes with it.

    Of three rods per arm accelerations and actuator forces are unique, contact forces are not. Joints of legs
    with a closed form come from the platform alone.
    """
    sample, tried = ALL[name](), model(name, backend)
    state = sample.platform if name in CLOSED_FORM else sample.states
    compare(name, tried.direct(state, sample.forces), sample.direct)
    compare(name, tried.inverse(state, sample.target, sample.output), sample.inverse)


def compare(name, found, wanted):
    fields = [field for field in found._fields if field != "contact_forces" or name not in THREE_RODS]
    errors = {field: relative(getattr(found, field), getattr(wanted, field)) for field in fields}
    assert max(errors.values()) <= LIBRARY, errors


@pytest.mark.parametrize("name", ALL)
def test_models(name):
    """Many legs, spare actuators, friction and springs, random trees, repeated rows, legs with freedoms of
    their own."""
    check(name, "numpy")


@pytest.mark.parametrize(
    "name", ["8 legs", "loads, 3 modes", "delta3-flex with loads", "three rods", "limber, 0 modes"]
)
def test_compiled_models(name):
    """On the virtual machine, one robot of a kind: tracing takes its time, for 24 legs most of a minute."""
    check(name, "vm")


@pytest.mark.parametrize("name", ALL)
def test_joints(name):
    """Positions, rates and accelerations of all joints: those that forces cause, which the platform's motion
    imposes on legs without freedoms of their own."""
    sample, numpy_model = ALL[name](), model(name, "numpy")
    legs = numpy_model.joints(sample.states)
    qdd = numpy_model.joint_accelerations(sample.states, sample.forces)
    system, moved = core_of(numpy_model).system(sample.states), sample.direct
    imposed = by_leg(system.mechanism, imposed_accelerations(system, moved.platform, moved.elastic))
    for i in range(len(sample.legs)):
        found = legs.q[i], legs.qd[i], qdd[i]
        wanted = sample.q[i], sample.qd[i], sample.direct.qdd[i]
        errors = [relative(a, b) for a, b in zip(found, wanted, strict=True)]
        assert max(errors) <= LIBRARY, (i, errors)
        if len(sample.legs[i].joints) <= 3 * len(sample.legs[i].tips):
            assert relative(imposed[i], moved.qdd[i]) <= LIBRARY, i
