"""Trajectory files: the motion they describe, and complaints with their lines."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import parflex as pf
from measures import relative
from parflex.app.trajectory_file import planned_controller, read_plan, start_of, trajectory_of

GOOD = """\
format = "parflex-trajectory-1"
rest = ["100 ms", 0.2]
sample_time = "10 ms"

[[move]]
position = ["100 mm", 0, 0]
rotation = [0, "10 deg", 0]
duration = "500 ms"

[[move]]
duration = 1

[controller]
kind = "computed-torque"
kp = 100
kd = [20, 20, 20, 10, 10, 10]
"""
SPRINGS = """\
format = "parflex-trajectory-1"
start = "home"
[[move]]
duration = 1
[controller]
kind = "joint-pd"
kp = 1e5
kd = 1e3
"""


def round_about(entries: str) -> str:
    """The plan with a circle for its second move."""
    return GOOD.replace("duration = 1\n", f"circle = {{ {entries} }}\n")


@pytest.fixture
def plan(tmp_path):
    """Reads a plan from its text."""

    def read(text: str):
        path = tmp_path / "way.toml"
        path.write_text(text, encoding="utf-8")
        return read_plan(path)

    return read


def test_poses_are_displacements_from_the_start(plan, model_of):
    model, read = model_of(1), plan(GOOD)
    start = start_of(read, model)
    way = trajectory_of(read, start.state)
    home = model.robot.home
    assert way.duration == pytest.approx(1.8)
    assert relative(way.positions, home.position + np.array([[0, 0, 0], [0.1, 0, 0], [0, 0, 0]])) < 1e-15
    turned = Rotation.from_euler("y", 10, degrees=True).as_matrix() @ home.rotation
    assert relative(way.sample(0.6).rotation, turned) < 1e-12
    controller = planned_controller(read, model, start, way)
    assert isinstance(controller, pf.ComputedTorque)
    assert controller.kp == 100
    assert list(controller.kd) == [20, 20, 20, 10, 10, 10]


def test_moves_of_other_kinds(plan, model_of):
    """A hold and a circle, as `Trajectory.of` makes them; springs hold what stays."""
    circle = round_about(
        'radius = "10 mm", frequency = "5 Hz", turns = 2, normal = [1, 0, 0], ramp = "0.3 s"'
    )
    read = plan(circle.replace("[[move]]", '[[move]]\nhold = "100 ms"\n[[move]]', 1))
    home = model_of(0).robot.home
    there = pf.MoveTo(
        home.position + (0.1, 0, 0), Rotation.from_euler("y", 10, degrees=True).as_matrix(), duration=0.5
    )
    moves = [pf.Hold(0.1), there, pf.Circle(0.01, 5, 2, normal=(1, 0, 0), ramp=0.3)]
    expected = pf.Trajectory.of(home, moves, rest=(0.1, 0.2))
    assert relative(trajectory_of(read, home).segments, expected.segments) < 1e-14
    holding = plan(SPRINGS.replace("duration = 1", 'hold = "1 s"'))
    start = start_of(holding, model_of(0))
    way = trajectory_of(holding, start.state)
    assert isinstance(planned_controller(holding, model_of(0), start, way), pf.JointPD)


def test_starts(plan, model_of):
    """At equilibrium the forces hold the weight; at home the platform is undeformed and they are zero."""
    model = model_of(1)
    bent, flat = (start_of(plan(text), model) for text in (GOOD, SPRINGS))
    assert np.any(bent.state.elastic)
    assert not np.any(flat.state.elastic)
    assert relative(model.direct(bent.state, bent.forces).platform, np.zeros(6)) < 1e-9
    assert not np.any(flat.forces)


def test_springs_hold_the_start(plan, model_of):
    model, read = model_of(0), plan(SPRINGS)
    start = start_of(read, model)
    controller = planned_controller(read, model, start, trajectory_of(read, start.state))
    assert isinstance(controller, pf.JointPD)
    assert controller.reference is start.state


CASES = {
    "a move for springs": (
        SPRINGS.replace("duration", "position = [1, 0, 0]\nduration"),
        7,
        'controller.kind is "joint-pd", which holds the start, but a move leaves it',
    ),
    "two gains": (SPRINGS.replace("1e5", "[1e5, 1e5]"), 7, "controller.kp has shape (2,)"),
    "three pose gains": (GOOD.replace("kp = 100", "kp = [1, 2, 3]"), 15, "controller.kp is [1. 2. 3.]; give"),
    "a length for a time": (GOOD.replace("500 ms", "500 mm"), 8, "which is not a time"),
    "no time at all": (GOOD.replace('"500 ms"', "0"), 8, "move[0].duration is 0; it must be positive"),
    "no duration": (GOOD.replace("duration = 1\n", ""), 10, "move[1] has no duration; give the time"),
    "two moves in one": (
        GOOD.replace("duration = 1\n", "hold = 1\nduration = 1\n"),
        10,
        "move[1] gives duration and",
    ),
    "no radius": (round_about("radius = 0, frequency = 5"), 11, "move[1].circle.radius is 0; it must be"),
    "no frequency": (round_about("radius = 0.1"), 11, "circle.frequency is missing; give turns per second"),
    "radians for turns": (
        round_about('radius = 0.1, frequency = "5 rad/s"'),
        11,
        'which is not a frequency; expected a frequency in Hz, such as 5 or "5 Hz"',
    ),
    "no normal": (
        round_about("radius = 0.1, frequency = 5, normal = [0, 0, 0]"),
        11,
        "move[1].circle.normal is zero; give a direction",
    ),
    "a ramp too long": (
        round_about('radius = 0.1, frequency = 5, ramp = "300 ms"'),
        11,
        "move[1].circle.ramp is 0.3 s, longer than turns / frequency, 0.2 s; give a shorter",
    ),
    "a circle for springs": (
        SPRINGS.replace("duration = 1", "circle = { radius = 0.1, frequency = 1 }"),
        6,
        "which holds the start, but a move leaves it",
    ),
    "no moves": (
        GOOD[: GOOD.index("[[move]]")] + GOOD[GOOD.index("[controller]") :],
        1,
        "move is missing; give the moves",
    ),
    "another start": (
        SPRINGS.replace('"home"', '"there"'),
        2,
        "start is \"there\"; expected 'equilibrium' or",
    ),
    "degrees without a unit": (GOOD.replace('"10 deg"', "10"), 7, 'write degrees as "30 deg"'),
    "no rotation": (
        GOOD.replace('[0, "10 deg", 0]', "[[1, 0, 0], [0, 1, 0], [0, 0, -1]]"),
        7,
        "move[0].rotation is not a rotation",
    ),
    "hertz": (GOOD.replace("[20,", '["20 Hz",'), 16, "which leaves open what is counted"),
    "a robot": ('format = "parflex-robot-1"\n[home]\n', 1, 'format is "parflex-robot-1"; expected'),
    "a controller of another kind": (
        GOOD.replace("computed-torque", "magic"),
        14,
        'controller.kind is "magic"; choose "computed-torque" or "joint-pd"',
    ),
}


def used(plan, text, model):
    """A plan, read and bound to a model."""
    read = plan(text)
    start = start_of(read, model)
    return planned_controller(read, model, start, trajectory_of(read, start.state))


@pytest.mark.parametrize("name", CASES)
def test_complaints_name_line_field_and_value(name, plan, model_of):
    text, line, words = CASES[name]
    with pytest.raises(pf.InputError) as caught:
        used(plan, text, model_of(0))
    told = str(caught.value)
    assert told.startswith(f"way.toml:{line}: "), told
    assert words in told
    assert "\n" not in told
