"""Numbers that change without compiling anew, against robots that are built with the numbers."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import cases
import parflex as pf
import zoo
from measures import random_states, relative
from parflex.export.export import robot_of as exported
from parflex.kernels.jacobians import direct_jacobian
from parflex.model.core import core_of
from parflex.simulation.laws import controller_of
from parflex.simulation.loads import Loads
from parflex.simulation.steppers import stepper_of
from parflex.simulation.steppers.cyrk_steps import CyrkSteps

SAME = 1e-12
NEARLY = 1e-11  # where a payload hides what counts as round-off in the bare body; of 27 rows of rank 24
BACKENDS = ("numpy", "vm", "native")
NODE, OTHER = 3, 20
DESIGNS = 3
MODES = 3

# what a joint is given, from the paper's values on
LINK = {
    "M": lambda rng: rng.uniform(0.0, 9.0),
    "MS": lambda rng: rng.normal(size=3),
    "I": lambda rng: np.diag(rng.uniform(2.0, 3.0, 3)) + symmetric(rng.normal(0.0, 0.1, (3, 3))),
    "IA": lambda rng: rng.uniform(0.0, 9.0),
    "Fv": lambda rng: rng.uniform(0.0, 50.0),
    "Fs": lambda rng: rng.uniform(0.0, 50.0),
    "v_s": lambda rng: rng.uniform(0.01, 0.1),
    "k": lambda rng: rng.uniform(0.0, 500.0),
    "q_0": lambda rng: rng.uniform(-3.0, 3.0),
}
OF_ROBOT = {
    "gravity": lambda rng: rng.normal(0.0, 5.0, 3),
    "platform.frequencies": lambda rng: rng.uniform(20.0, 400.0, MODES),
    "platform.damping_ratio": lambda rng: rng.uniform(0.0, 0.5, MODES),
    f"platform.payload[{NODE}]": lambda rng: rng.uniform(0.0, 50.0),
}
EVERY = (
    *OF_ROBOT,
    *(f"legs[1].joints[2].{field}" for field in LINK),
    *(f"legs[*].joints[1].{field}" for field in LINK),
)
IDLE = "legs[*].joints[1].M"  # the origin of that link stands still


def symmetric(a):
    return a + a.T


def body(frequencies, damping_ratio):
    """A platform for the paper's legs, of point masses, with shapes that have no symmetry."""
    rng = np.random.default_rng(0)
    held = pf.robots.gough_stewart(0).platform.attachment_points
    points = np.concatenate([held, rng.uniform(-0.5, 0.5, (20, 3))])
    masses = rng.uniform(1.0, 5.0, len(points))
    orthogonal = np.linalg.qr(rng.standard_normal((3 * len(masses), MODES)))[0]
    shapes = orthogonal.T.reshape(MODES, -1, 3) / np.sqrt(masses)[:, None]
    return pf.FlexibleBody.from_nodes(points, masses, shapes, frequencies, damping_ratio, range(6))


FREQUENCIES, RATIO = np.array([60.0, 90.0, 200.0]), np.array([0.02, 0.1, 0.3])


@cache
def robot_of():
    """The paper's legs with friction and springs, no two joints alike."""
    rng = np.random.default_rng(1)
    loads = [zoo.joint_loads(rng) for _ in range(3)]
    first = replace(pf.robots.gough_stewart(0), platform=body(FREQUENCIES, RATIO))
    joints = tuple(replace(joint, **load) for joint, load in zip(first.legs[0].joints, loads, strict=True))
    return replace(first, legs=tuple(replace(leg, joints=joints) for leg in first.legs))


def built(robot, name, value):
    """The robot with one number changed as a user would without parameters."""
    if name == "gravity":
        return replace(robot, gravity=value)
    if name == "platform.frequencies":
        return replace(robot, platform=body(value, RATIO))
    if name == "platform.damping_ratio":
        return replace(robot, platform=body(FREQUENCIES, value))
    if name.startswith("platform.payload"):
        return replace(robot, platform=robot.platform.with_payload(NODE, value))
    which, joint, field = name[5], int(name.split("joints[")[1][0]), name.rpartition(".")[2]
    legs = [
        replace(
            leg,
            joints=tuple(
                replace(old, **{field: value}) if j == joint else old for j, old in enumerate(leg.joints)
            ),
        )
        if which in ("*", str(i))
        else leg
        for i, leg in enumerate(robot.legs)
    ]
    return replace(robot, legs=tuple(legs))


def designs(name, count=DESIGNS):
    """Values (count, …) of a parameter."""
    rng = np.random.default_rng(len(name))
    draw = OF_ROBOT.get(name) or LINK[name.rpartition(".")[2]]
    return np.array([draw(rng) for _ in range(count)])


@pytest.fixture(scope="module", params=BACKENDS)
def model(request):
    return pf.Model(robot_of(), request.param, parameters=EVERY)


@pytest.fixture(scope="module")
def states():
    return random_states(robot_of(), DESIGNS, 3)


FORCES = np.linspace(400.0, 700.0, 6)
TARGET = np.array([1.0, -2.0, 3.0, 0.5, -0.5, 1.0])


@cache
def unchanged():
    return pf.Model(robot_of(), "numpy")


@cache
def wanted(name):
    """The answers of robots built with each value, whichever backend is asked."""
    others = [pf.Model(built(robot_of(), name, value), "numpy") for value in designs(name)]
    states = random_states(robot_of(), DESIGNS, 3)
    return [(m.direct(states[i], FORCES), m.inverse(states[i], TARGET)) for i, m in enumerate(others)]


def agree(found, expected, tolerance=SAME):
    for a, b in zip(found, expected, strict=True):
        assert relative(a, b) <= tolerance


@pytest.mark.filterwarnings("ignore::parflex.DynamicSingularity")  # under a heavy payload
@pytest.mark.parametrize("name", EVERY)
def test_each_parameter_is_that_of_a_robot_built_with_it(model, states, name):
    """A batch of values in one call, each with a state of its own; the others as the robot has them."""
    values = designs(name)
    direct = model.direct(states, FORCES, parameters={name: values})
    inverse = model.inverse(states, TARGET, parameters={name: values})
    plain = unchanged().direct(states, FORCES).platform
    for i, (moved, driven) in enumerate(wanted(name)):
        agree([a[i] for a in direct], moved)
        agree([a[i] for a in inverse], driven)
        assert relative(direct.platform[i], plain[i]) > 1e-6 or name == IDLE


# --- robots of other kinds ---

OTHERS = {
    "carried joints": lambda: zoo.odd(0, 3),
    "Delta": lambda: zoo.with_loads(cases.case("delta3", "flex")),
    "repeated rows": zoo.three_rods,
}


@pytest.mark.parametrize("kind", OTHERS)
def test_robots_of_other_kinds(kind):
    """Many parameters at once, on states of the closure; two payloads, one of them nothing."""
    sample = OTHERS[kind]()
    robot = sample.robot
    joint, body = robot.legs[0].joints[0], robot.platform
    changed = {
        "M": joint.M + 0.3, "I": joint.I + 0.1 * np.eye(3), "Fv": 0.7, "Fs": 1.3, "k": 11.0, "q_0": -0.4
    }  # fmt: skip
    values = {f"legs[0].joints[0].{field}": value for field, value in changed.items()}
    values |= {"gravity": [1.0, 2.0, -3.0], "platform.payload[0]": 2.5, "platform.payload[1]": 0.0}
    values["platform.payload[2]"] = 1.5
    if body.modes:
        values["platform.damping_ratio"] = 0.07
    first = replace(robot.legs[0], joints=(replace(joint, **changed), *robot.legs[0].joints[1:]))
    omega = np.sqrt(body.stiffness)  # modes are normalised
    laden = replace(body, damping=2 * 0.07 * omega).with_payload(2, 1.5).with_payload(0, 2.5)
    other = replace(robot, legs=(first, *robot.legs[1:]), gravity=(1.0, 2.0, -3.0), platform=laden)
    expected, model = pf.Model(other, "numpy"), pf.Model(robot, "vm", parameters=list(values))
    states, found = sample.states, model.with_parameters(values)
    moved = expected.direct(states, sample.forces)
    agree(model.direct(states, sample.forces, parameters=values), moved, NEARLY)
    agree(found.direct(states, sample.forces), moved, NEARLY)
    aims = states, sample.target, sample.output
    agree(model.inverse(*aims, parameters=values), expected.inverse(*aims), NEARLY)
    assert relative(found.robot.platform.moments.P2, laden.moments.P2) <= SAME


def test_derivatives_are_those_of_a_robot_built_with_it(model, states):
    """Jacobians of the direct model, under all parameters at once."""
    if model.backend == "native":
        return
    values = {name: designs(name, 1)[0] for name in EVERY if "payload" not in name}
    values[f"platform.payload[{NODE}]"] = 4.0
    other = model.with_parameters(values)
    plain = pf.Model(other.robot, "numpy")
    given = {"x": core_of(model).flat(states), "forces": FORCES}
    agree(
        core_of(other).functions(direct_jacobian, ())(**given).values(),
        core_of(plain).functions(direct_jacobian, ())(**given).values(),
    )


# --- one model, many values ---

PAYLOAD = f"platform.payload[{OTHER}]"


@pytest.fixture
def counted(model, monkeypatch):
    """A model of its own, and the names of the kernels that it has compiled."""
    backend, done = type(core_of(model).functions.backend)(), []
    compile_one = backend.compile
    monkeypatch.setattr(
        backend, "compile", lambda kernel: done.append(kernel.name) or compile_one(kernel), raising=False
    )
    monkeypatch.setattr("parflex.model.core.choose", lambda name: backend)
    return pf.Model(model.robot, parameters=["gravity", PAYLOAD]), done


def test_a_thousand_designs_are_compiled_once(counted):
    """In one call; a few of them against models of their own, which share the code."""
    model, done = counted
    count = 20 if model.backend == "numpy" else 1000  # which compiles nothing, and takes its time
    masses = np.linspace(0.0, 50.0, count)
    found = model.direct(model.robot.home, FORCES, parameters={PAYLOAD: masses})
    assert found.platform.shape == (count, 6)
    for i in (0, count // 2, count - 1):
        one = model.with_parameters({PAYLOAD: masses[i]})
        agree([a[i] for a in found], one.direct(model.robot.home, FORCES))
        c, out = one.compiled(), np.zeros(6 + MODES)
        c.direct(c.pack(model.robot.home), FORCES, out)
        assert relative(out[:6], found.platform[i]) <= SAME
    assert done == ["direct"]


def test_batches_broadcast(model):
    """States along one axis, gravity along another."""
    states = random_states(model.robot, 4, 5)
    gravity = np.array([[[0.0, 0.0, -9.81]], [[0.0, 0.0, -1.62]]])
    found = model.direct(states, FORCES, parameters={"gravity": gravity, "platform.damping_ratio": 0.1})
    assert found.platform.shape == (2, 4, 6)
    moon = model.with_parameters({"gravity": (0, 0, -1.62), "platform.damping_ratio": 0.1})
    agree([a[1] for a in found], moon.direct(states, FORCES))


def test_values_are_told_and_kept(model):
    moon = model.with_parameters({"gravity": (0, 0, -1.62)})
    later = moon.with_parameters({f"platform.payload[{NODE}]": 3.0})
    assert later.parameters["gravity"].tolist() == [0, 0, -1.62]
    assert later.parameters[f"platform.payload[{NODE}]"] == 3.0
    assert model.parameters["gravity"].tolist() == [0, 0, -9.81]
    assert relative(model.parameters["platform.frequencies"], FREQUENCIES) <= SAME
    assert relative(model.parameters["platform.damping_ratio"], RATIO) <= SAME
    later.parameters["gravity"][:] = 0.0
    assert later.robot.gravity.tolist() == [0, 0, -1.62]


def test_simulation_with_other_numbers(model):
    """A run on the moon, and its energies, against that of a robot built for the moon."""
    values = {"gravity": (0.0, 0.0, -1.62), f"platform.payload[{NODE}]": 4.0}
    moon, t = model.with_parameters(values), np.linspace(0.0, 0.02, 3)
    built_there = replace(
        model.robot, gravity=values["gravity"], platform=model.robot.platform.with_payload(NODE, 4.0)
    )
    expected = pf.Model(built_there, "vm")
    state, forces = expected.equilibrium(*model.robot.home_pose)
    assert relative(moon.equilibrium(*model.robot.home_pose)[1], forces) <= 1e-9
    push = {"wrenches": [pf.Wrench(0, (10.0, 20.0, 30.0))], "max_step": 0.01}
    two = pf.simulate(expected, 1.1 * forces, state, t, **push).dataset
    if model.backend == "native":
        law = controller_of(moon, forces).bind(moon, Loads(moon, ()))
        y, tolerances = (
            np.append(core_of(moon).flat(state), np.zeros(3)),
            {"rtol": 1e-6, "atol": 1e-6, "max_step": 1.0},
        )
        assert isinstance(stepper_of(law, "DOP853", 0.0, y, 1.0, tolerances), CyrkSteps)
    one = pf.simulate(moon, 1.1 * forces, state, t, **push).dataset
    for name in two.data_vars:
        if two[name].dtype.kind == "f":
            assert relative(one[name], two[name]) <= 1e-9, name
    assert one.attrs["gravity"].tolist() == [0.0, 0.0, -1.62]


def test_controllers_belong_to_their_model(model):
    """A controller that was made for the Earth is not taken to the moon unseen."""
    hold = pf.JointPD(model, model.robot.home, 1e5, 1e3)
    with pytest.raises(pf.InputError, match="made for another model"):
        pf.simulate(model.with_parameters({"gravity": (0, 0, -1.62)}), hold, model.robot.home, [0, 1e-3])


def test_export_is_at_the_values_of_the_model(model):
    moon = model.with_parameters({"gravity": (0, 0, -1.62)})
    assert exported(moon).gravity.tolist() == [0, 0, -1.62]


def test_branches_share_code(monkeypatch):
    """The elbows that a state names, on the moon: against legs that have them as postures."""
    sample = cases.case("rus6", "rigid")
    legs = tuple(replace(leg, posture=None) for leg in sample.robot.legs)
    model = pf.Model(replace(sample.robot, legs=legs), "vm", parameters=["gravity"])
    state, forces = sample.states[0], sample.forces[0]
    model.direct(state, forces)
    monkeypatch.delattr("parflex.compiled.vm.trace")  # nothing more is compiled
    moon = model.with_parameters({"gravity": (0, 0, -1.62)})
    stated = pf.Model(replace(sample.robot, gravity=(0, 0, -1.62)), "numpy")
    agree(moon.direct(state, forces), stated.direct(state, forces))


# --- what is refused ---


def named(*names):
    return lambda: pf.Model(robot_of(), parameters=names)


def given(**values):
    """A call with values, given by their last word."""
    by_word = {name.rpartition(".")[2].partition("[")[0]: name for name in OF_ROBOT}
    by_word |= {field: f"legs[*].joints[2].{field}" for field in LINK}
    chosen = {by_word[word]: value for word, value in values.items()}
    return lambda: pf.Model(robot_of(), parameters=list(chosen)).direct(
        robot_of().home, FORCES, parameters=chosen
    )


REFUSED = {
    "one string": (
        lambda: pf.Model(robot_of(), parameters="gravity"),
        "parameters is str; give a list of names: gravity, legs",
    ),
    "misspelt": (named("gravty"), r"'gravty' is no parameter of this robot \(did you mean gravity\?\)"),
    "no such leg": (named("legs[6].joints[2].M"), r"did you mean legs\[.\].joints\[2\].M\?.*It has 6 legs"),
    "no such joint": (named("legs[*].joints[3].M"), r"did you mean legs\[\*\].joints\[.\].M\?"),
    "no such node": (named("platform.payload[26]"), "It has 6 legs, 26 nodes and 3 modes"),
    "from the end": (
        named("legs[-1].joints[2].M"),
        r"there are gravity, legs\[i\].joints\[j\].X or .*from 0",
    ),
    "not a name": (named(7), "parameters: 7 is no parameter"),
    "length of a link": (
        named("legs[0].joints[2].r"),
        "'legs.*r' is geometry, which is folded into the compiled code",
    ),
    "place of a base": (named("legs[0].origin"), "geometry"),
    "place of a tip": (named("legs[0].tips[0].offset"), "geometry"),
    "attachment": (named("platform.attachments[0]"), "geometry"),
    "twice": (named("gravity", "gravity"), "'gravity' and 'gravity' are the same number; name it once"),
    "overlapping": (
        named("legs[*].joints[2].M", "legs[3].joints[2].M"),
        r"'legs\[\*\].joints\[2\].M' and 'legs\[3\].joints\[2\].M' are the same number",
    ),
    "modes of a rigid platform": (
        lambda: pf.Model(pf.robots.gough_stewart(0), parameters=["platform.frequencies"]),
        "is no parameter of this robot.*0 modes",
    ),
    "legs that differ": (
        lambda: pf.Model(built(robot_of(), "legs[1].joints[2].M", 7.0), parameters=["legs[*].joints[2].M"]),
        "is one value for all legs, but theirs differ",
    ),
    "negative mass": (given(M=[1.0, -2.0]), r"joints\[2\].M'\] is -2.0 at index 1; it cannot be negative"),
    "negative payload": (given(payload=-1.0), r"payload\[3\]'\] is -1.0; it cannot be negative"),
    "negative frequency": (given(frequencies=[1, -2, 3]), r"is -2.0 at index 1; it cannot be negative"),
    "negative damping": (given(damping_ratio=-0.1), "cannot be negative"),
    "smoothing over nothing": (given(v_s=0.0), "v_s'] is 0.0; it must be positive"),
    "unsymmetric inertia": (given(I=np.eye(3, k=1)), "I'] is .*; it must be symmetric"),
    "not a number": (given(gravity=(0, 0, np.nan)), r"\['gravity'\] is nan at index \(2,\)"),
    "gravity of two": (given(gravity=(0, 0)), r"\['gravity'\] has shape \(2,\); expected \(3\)"),
    "two ratios": (given(damping_ratio=(0.1, 0.1)), r"has shape \(2,\); expected \(3\)"),
    "words": (given(M="heavy"), "is not an array of numbers"),
    "unbroadcastable": (given(M=[1, 2], k=[1, 2, 3]), r"\(2,\) of legs.*\(3,\) of legs.*broadcast together"),
    "not named before": (
        lambda: pf.Model(robot_of(), parameters=["gravity"]).with_parameters({"gravty": 1}),
        r"'gravty' is none of this model \(did you mean gravity\?\); it has gravity",
    ),
    "none named": (
        lambda: pf.Model(robot_of()).direct(robot_of().home, FORCES, parameters={"gravity": (0, 0, 0)}),
        r"the model has none; name those.*pf.Model\(robot, parameters=\['gravity'\]\)",
    ),
    "a list of values": (
        lambda: pf.Model(robot_of(), parameters=["gravity"]).with_parameters([1]),
        "parameters is list; give a dict of names and values",
    ),
    "a batch of models": (
        lambda: pf.Model(robot_of(), parameters=["gravity"]).with_parameters({"gravity": np.zeros((2, 3))}),
        r"parameters are a batch \(2,\); a model has one value of each",
    ),
    "damping without frequency": (
        lambda: pf.Model(
            replace(robot_of(), platform=replace(robot_of().platform, stiffness=np.array([1.0, 0, 1]))),
            parameters=["platform.frequencies"],
        ),
        "mode 2 of the platform has damping but no frequency",
    ),
}


@pytest.mark.parametrize("what", REFUSED)
def test_refused(what):
    call, words = REFUSED[what]
    with pytest.raises(pf.InputError, match=words):
        call()
