"""Sections of beams and flexures as parameters, against robots that are built with the numbers."""

from dataclasses import replace

import numpy as np
import pytest

import parflex as pf
from measures import relative
from parflex.kernels.motion import derivative
from parflex.model.core import core_of
from parflex.robot.beam import beam

STEEL = {"young": 205e9, "poisson": 0.29, "density": 7850.0}
NONE = {"M": 0.0, "MS": np.zeros(3), "I": np.zeros((3, 3))}
SPRING = np.diag([5.0, 4.0, 260.0])
OUTER, STIFFNESS = "legs[*].joints[2].body.beam.outer", "legs[*].tips[0].flexure.stiffness"
ONE = "legs[1].joints[1].body.beam.young"


def robot(outer: float = 0.032, young: float = STEEL["young"], stiffness: np.ndarray = SPRING) -> pf.Robot:
    """The paper's robot on struts: one bending and one axial shape in a rod, two of bending in a cylinder."""
    rigid = pf.robots.gough_stewart(modes=3)
    legs = []
    for i, leg in enumerate(rigid.legs):
        first, second, third = leg.joints
        material = STEEL | ({"young": young} if i == 1 else {})
        cylinder = beam((0, -0.7, 0), 0.08, 0.068, **material, bending=2, damping_ratio=0.01)
        rod = beam((0, 0, 0.62), outer, **STEEL, bending=1, axial=1, damping_ratio=0.005)
        joints = (first, replace(second, **NONE, body=cylinder), replace(third, **NONE, body=rod))
        spring = pf.Flexure(stiffness, 0.1 * np.eye(3), rest=np.eye(3))
        legs.append(replace(leg, joints=joints, tips=(pf.Tip(3, (0, 0, 0.62), i, spring),), posture=None))
    return replace(rigid, legs=tuple(legs))


def at_rest_in_shape(model: pf.Model) -> pf.State:
    """At home with nothing bent: there the amplitudes of shapes, whose size a basis chooses, do not count."""
    return replace(model.robot.home, twist=(0.1, -0.2, 0.1, 0.3, 0.1, -0.2))


@pytest.mark.parametrize("backend", ["numpy", "vm", "native"])
def test_a_section_is_that_of_a_robot_built_with_it(backend):
    """The platform's accelerations and the contact forces, which no basis of the shapes changes."""
    model = pf.Model(robot(), backend, [OUTER, ONE, STIFFNESS])
    state, forces = at_rest_in_shape(model), np.arange(6.0)
    values = {OUTER: 0.04, ONE: 150e9, STIFFNESS: 2 * SPRING}
    built = pf.Model(robot(0.04, 150e9, 2 * SPRING), "numpy").direct(state, forces)
    for found in (
        model.direct(state, forces, parameters=values),
        model.with_parameters(values).direct(state, forces),
    ):
        assert relative(found.platform, built.platform) <= 1e-10
        assert relative(found.elastic, built.elastic) <= 1e-10
        assert relative(found.contact_forces, built.contact_forces) <= 1e-10


def test_the_same_numbers_change_nothing():
    """Bent and in motion, where stiffness and damping of every shape count."""
    rng, plain, model = (
        np.random.default_rng(2),
        pf.Model(robot(), "numpy"),
        pf.Model(robot(), "numpy", [OUTER, ONE]),
    )
    sizes = [leg.size - len(leg.joints) for leg in plain.robot.legs]
    state = replace(
        at_rest_in_shape(model),
        leg_elastic=tuple(1e-3 * rng.normal(size=n) for n in sizes),
        leg_elastic_rate=tuple(0.1 * rng.normal(size=n) for n in sizes),
    )
    a, b = (m.direct(state, np.arange(6.0)) for m in (plain, model))
    assert relative(a.platform, b.platform) <= 1e-10
    assert relative(np.concatenate(a.leg_elastic), np.concatenate(b.leg_elastic)) <= 1e-10


def test_a_model_with_another_section_keeps_its_shapes():
    """Its robot's body is in the shapes of the first, so that states mean the same; frequencies follow."""
    model = pf.Model(robot(), "numpy", [OUTER])
    body = model.with_parameters({OUTER: 0.04}).robot.legs[0].joints[2].body
    first = model.robot.legs[0].joints[2].body
    assert np.array_equal(body.shapes, first.shapes)
    fresh = beam((0, 0, 0.62), 0.04, **STEEL, bending=1, axial=1)
    assert body.frequencies == pytest.approx(fresh.frequencies, rel=1e-12)
    assert body.moments.m == pytest.approx(fresh.moments.m, rel=1e-14)


def with_step(model: pf.Model, name: str, part: float) -> dict[str, np.ndarray]:
    """Another value of a parameter, by a part of it."""
    return {name: np.asarray(model.parameters[name]) * (1 + part)}


@pytest.mark.parametrize("backend", ["numpy", pytest.param("vm", marks=pytest.mark.slow)])
def test_derivatives_by_sections_and_flexures(backend):
    """Bent and in motion, rows of the legs too, against central differences of the direct model, extrapolated
    once; of a stiffness along its own way."""
    rng, names = np.random.default_rng(3), [OUTER, ONE, STIFFNESS]
    model, reference = pf.Model(robot(), backend, names), pf.Model(robot(), "numpy", names)
    soft = [np.concatenate([j.body.frequencies for j in leg.joints[1:]]) for leg in model.robot.legs]
    bent = tuple(20.0 / omega**2 * rng.normal(size=omega.shape) for omega in soft)
    state, forces = replace(at_rest_in_shape(model), leg_elastic=bent), np.arange(6.0)
    found = model.direct_jacobian(state, forces)
    rows = np.concatenate([found.parameters, found.carried_parameters])

    def answer(name, part):
        core = core_of(reference.with_parameters(with_step(reference, name, part)))
        rate, at = (
            core.functions(derivative)(x=core.flat(state), forces=forces)["rate"],
            core.mechanism.layout.at,
        )
        return np.concatenate([rate[at.twist], rate[at.elastic_rate], rate[at.joint_rates]])

    start = 0
    for name in names:
        own = np.asarray(model.parameters[name]).reshape(-1)
        along = rows[:, start : start + own.size] @ own
        whole, half = ((answer(name, h) - answer(name, -h)) / (2 * h) for h in (1e-3, 5e-4))
        expected = (4 * half - whole) / 3
        assert np.max(np.abs(along - expected)) <= 1e-7 * max(1.0, np.max(np.abs(expected)))
        start += own.size


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("legs[0].joints[2].M", "no parameter"),
        ("legs[0].joints[2].body.beam.end", "no parameter"),
        ("legs[0].tips[0].flexure.rest", "no parameter"),
    ],
)
def test_what_is_none(name, words):
    with pytest.raises(pf.InputError, match=words):
        pf.Model(robot(), "numpy", [name])


def test_refused_values():
    model = pf.Model(robot(), "numpy", [OUTER])
    with pytest.raises(pf.InputError, match="outer"):
        model.with_parameters({OUTER: -0.01})


def test_bores_wider_than_their_tubes_are_refused():
    """As the beam itself would, beside a diameter that is the robot's own or a parameter; batches, too."""
    inner, outer = (f"legs[0].joints[1].body.beam.{name}" for name in ("inner", "outer"))
    for names in ([inner], [outer, inner]):
        model = pf.Model(robot(), "numpy", names)
        for value in (0.09, [0.05, 0.08]):
            with pytest.raises(pf.InputError, match=r"inner is 0\.0[89]; it must be less than outer"):
                model.direct(model.robot.home, np.zeros(6), parameters={inner: value})
    model.direct(model.robot.home, np.zeros(6), parameters={inner: 0.09, outer: 0.1})


def test_springs_that_are_none_are_refused():
    """As the flexure itself would: a matrix that is not symmetric, or pushes."""
    model = pf.Model(robot(), "numpy", [STIFFNESS])
    skewed = SPRING + np.eye(3, k=1)
    for value, words in ((skewed, "symmetric"), ([SPRING, -SPRING], "negative in any direction")):
        with pytest.raises(pf.InputError, match=words):
            model.direct(model.robot.home, np.zeros(6), parameters={STIFFNESS: value})
