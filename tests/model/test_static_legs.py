"""The inverse model of legs that bend statically, and the refusal of what their bending makes ill-posed."""

from dataclasses import replace

import numpy as np
import pytest

import flexlegs
import parflex as pf
from flexlegs import NAMES
from measures import relative
from parflex.analysis import settling

AGREED = 5e-12  # the references and this library; what is asked is 1e-9
REACHED = 1e-10  # of the target, by the full direct model; what is asked is 1e-9

pytestmark = pytest.mark.filterwarnings("ignore::parflex.DynamicSingularity")


@pytest.fixture(scope="module", params=["numpy", "native"])
def backend(request) -> str:
    return request.param


def rows(name: str) -> pf.FrameOutput:
    return pf.FrameOutput(tuple(int(row) for row in flexlegs.arrays(name)["inverse_rows"]))


@pytest.mark.parametrize("name", NAMES)
def test_the_instantaneous_inverse_is_refused(name, backend):
    """With advice that works: `allow_ill_posed` gives the forces of the independent program of `data/`."""
    a, model = flexlegs.arrays(name), pf.Model(flexlegs.robot(name), backend)
    asked = flexlegs.states(name), a["inverse_target"], rows(name)
    with pytest.raises(pf.InputError, match=r'JointOutput.*legs="static".*allow_ill_posed=True'):
        model.inverse(*asked)
    assert relative(model.inverse(*asked, allow_ill_posed=True).forces, a["inverse_forces"]) <= AGREED


def test_struts_that_only_bend_are_not_refused():
    """The instantaneous inverse then means something: the direct model gives the target back."""
    model = pf.Model(hexapod(axial=0), "numpy")
    target = np.array([1.0, -2.0, 0.5, 3.0, 1.0, -1.0])
    found = model.inverse(model.robot.home, target)
    assert relative(model.direct(model.robot.home, found.forces).platform, target) <= REACHED
    with pytest.raises(pf.InputError, match="by the choice of shapes alone"):
        pf.Model(hexapod(axial=1), "numpy").inverse(model.robot.home, target)


def hexapod(axial: int) -> pf.Robot:
    """Six steel struts that bend, and stretch or not, under 5 kg."""
    steel = {"young": 205e9, "density": 7850.0, "bending": 1, "axial": axial}
    strut = pf.Strut(
        pf.Bar(outer=0.03, inner=0.024, length=0.2, **steel), pf.Bar(outer=0.016, length=0.2, **steel)
    )
    sizes = {"base_radius": 0.25, "platform_radius": 0.15, "height": 0.3}
    spreads = {"base_spread": np.radians(20), "platform_spread": np.radians(20)}
    return pf.robots.hexapod(
        **sizes, **spreads, strut=strut, payload=pf.Payload(5.0, inertia=0.03 * np.eye(3))
    )


def test_the_bent_robot_reaches_the_target(backend):
    """States of `data/`, legs bent by the answer and at rest in their bend, under its forces: the full direct
    model gives the target, and the legs do not accelerate in their bend."""
    a, model = flexlegs.arrays("gs_flexlegs"), pf.Model(flexlegs.robot("gs_flexlegs"), backend)
    states = flexlegs.states("gs_flexlegs")
    found = model.inverse(states, a["inverse_target"], legs="static")
    bent = replace(
        states, leg_elastic=found.leg_elastic, leg_elastic_rate=None, joint_rates=None, joints=None
    )
    there = model.direct(bent, found.forces)
    assert relative(there.platform, a["inverse_target"]) <= REACHED
    assert relative(there.contact_forces, found.contact_forces) <= REACHED
    modal = np.max(np.abs(np.stack(model.direct(states, found.forces).leg_elastic)))
    assert np.max(np.abs(np.stack(there.leg_elastic))) <= REACHED * modal


def test_a_robot_of_three_freedoms_reaches_the_target():
    """A Delta whose arms and rods bend: its state is the nearest that the bent legs allow."""
    name = "delta_flexarms_foreshortening"
    model, rng = pf.Model(flexlegs.robot(name), "native"), np.random.default_rng(0)
    state = model.project(replace(model.robot.home, twist=0.5 * rng.normal(size=6)))
    target = np.array([[1.0, 2.0, -3.0], [0.0, 0.0, 5.0]])
    found = model.inverse(state, target, rows(name), legs="static")
    for i in range(2):
        bend = tuple(e[i] for e in found.leg_elastic)
        bent = model.project(replace(state, leg_elastic=bend, leg_elastic_rate=None))
        assert relative(model.direct(bent, found.forces[i]).platform[:3], target[i]) <= REACHED


def test_the_equilibrium_of_the_reference():
    """The stored equilibrium's platform at rest, wanted to stay: forces and the legs' bend of the independent
    program of `data/`; nothing accelerates."""
    a, model = flexlegs.arrays("gs_flexlegs"), pf.Model(flexlegs.robot("gs_flexlegs"), "numpy")
    state = pf.State(a["static_position"], a["static_rotation"], elastic=a["static_elastic"])
    found = model.inverse(state, np.zeros(6), legs="static")
    assert relative(found.forces, a["static_forces"]) <= AGREED
    assert relative(np.stack(found.leg_elastic), a["static_leg_elastic"]) <= AGREED
    assert relative(found.contact_forces, a["static_contact"]) <= AGREED
    assert np.max(np.abs(found.elastic)) <= 1e-10


def test_wrenches_and_joints_go_with_it():
    """Under a wrench, and for accelerations of the actuated joints, the direct model gives the target too."""
    model = pf.Model(flexlegs.robot("gs_flexlegs"), "numpy")
    state, push = model.robot.home, [pf.Wrench(3, force=(20.0, -30.0, 50.0))]
    target = np.linspace(-2, 2, 6)
    found = model.inverse(state, target, pf.JointOutput(), push, legs="static")
    bent = replace(state, leg_elastic=found.leg_elastic)
    there = model.direct(bent, found.forces, push)
    assert relative(np.stack(there.leg_joints)[:, 2], target) <= REACHED


def test_rigid_legs_do_not_bend():
    """The answer is the usual one, to the bit."""
    model = pf.Model(pf.robots.rus6(modes=2), "numpy")
    found = model.inverse(model.robot.home, np.ones(6), legs="static")
    assert np.array_equal(found.forces, model.inverse(model.robot.home, np.ones(6)).forces)
    assert [e.shape for e in found.leg_elastic] == [(0,)] * 6
    assert model.inverse(model.robot.home, np.ones(6)).leg_elastic is None


def test_soft_flexures_need_newton(monkeypatch):
    """Tips a thousand times as stiff against turning as in `data/`: the steps do not contract."""
    robot, used = flexlegs.robot("gs_flexlegs"), []
    legs = tuple(
        replace(leg, tips=tuple(replace(tip, flexure=stiffer(tip.flexure)) for tip in leg.tips))
        for leg in robot.legs
    )
    newton = settling.newton
    monkeypatch.setattr(settling, "newton", lambda *given: used.append(1) or newton(*given))
    model = pf.Model(replace(robot, legs=legs), "numpy")
    state = replace(robot.home, twist=[0.1, 0.2, -0.1, 0.2, 0.1, 0.3])
    found = model.inverse(state, np.ones(6), legs="static")
    bent = replace(state, leg_elastic=found.leg_elastic)
    assert used
    assert relative(model.direct(bent, found.forces).platform, np.ones(6)) <= REACHED


def stiffer(flexure: pf.Flexure) -> pf.Flexure:
    return replace(flexure, stiffness=1000 * np.asarray(flexure.stiffness))


def test_bends_that_there_are_not():
    """A fixed point of slope −3, by hand at b/4; and y² = −1, which has none."""
    b = np.array([[1.0, -2.0], [3.0, 0.5]])
    found = settling.settled(lambda y: 4.0 * y - b, np.zeros((2, 2)), np.ones(2))
    assert relative(found, b / 4) <= 1e-12
    with pytest.raises(pf.NotConverged, match="no bend of the legs was found"):
        settling.settled(lambda y: y * y + 1.0, np.full(1, 0.3), np.ones(1))


def test_a_buckling_load_is_told():
    """Struts pressed with a hundred times what they carry have no such bend."""
    model = pf.Model(flexlegs.robot("gs_flexlegs"), "numpy")
    with pytest.raises(pf.NotConverged, match="the legs buckle or nearly so"):
        model.inverse(model.robot.home, [0, 0, 1e5, 0, 0, 0], legs="static")


def test_words_are_checked():
    model = pf.Model(pf.robots.rus6(modes=0), "numpy")
    with pytest.raises(pf.InputError, match="legs is \"?'?stiff"):
        model.inverse(model.robot.home, np.zeros(6), legs="stiff")


def test_parameters_go_with_it():
    """A thicker rod of one leg, without compiling anew: as the model of a robot built with it."""
    robot, name = hexapod(axial=1), "legs[0].joints[2].body.beam.outer"
    model = pf.Model(robot, "numpy", [name])
    built = pf.Model(model.with_parameters({name: 0.02}).robot, "numpy")
    found = model.inverse(robot.home, np.ones(6), legs="static", parameters={name: 0.02})
    there = built.inverse(robot.home, np.ones(6), legs="static")
    assert relative(found.forces, there.forces) <= 1e-12
    assert relative(np.stack(found.leg_elastic), np.stack(there.leg_elastic)) <= 1e-12
    plain = model.inverse(robot.home, np.ones(6), legs="static")
    assert relative(found.leg_elastic[0], plain.leg_elastic[0]) > 1e-7
