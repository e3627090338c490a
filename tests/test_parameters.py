"""Numbers that change without compiling anew, against robots that are built with the numbers."""

from dataclasses import replace

import numpy as np
import pytest

import parflex as pf
import zoo
from conftest import random_states, relative

SAME = 1e-12
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
def states(model):
    return random_states(model.robot, DESIGNS, 3)


FORCES = np.linspace(400.0, 700.0, 6)
TARGET = np.array([1.0, -2.0, 3.0, 0.5, -0.5, 1.0])


def agree(found, expected):
    for a, b in zip(found, expected, strict=True):
        assert relative(a, b) <= SAME


@pytest.mark.filterwarnings("ignore::parflex.DynamicSingularity")  # under a heavy payload
@pytest.mark.parametrize("name", EVERY)
def test_each_parameter_is_that_of_a_robot_built_with_it(model, states, name):
    """A batch of values in one call, each with a state of its own; the others as the robot has them."""
    values = designs(name)
    direct = model.direct(states, FORCES, parameters={name: values})
    inverse = model.inverse(states, TARGET, parameters={name: values})
    plain = pf.Model(model.robot, "numpy")
    for i, value in enumerate(values):
        other = pf.Model(built(model.robot, name, value), "numpy")
        agree([a[i] for a in direct], other.direct(states[i], FORCES))
        agree([a[i] for a in inverse], other.inverse(states[i], TARGET))
        unlike = relative(direct.platform[i], plain.direct(states[i], FORCES).platform)
        assert unlike > 1e-6 or name == IDLE
