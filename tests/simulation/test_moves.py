"""Moves: what every kind keeps, the circle in its own terms, and one more kind as one more file."""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import parflex as pf
from measures import relative
from parflex.app.trajectory_file import read_plan, trajectory_of
from parflex.app.trajectory_schema import trajectory_table
from parflex.base.check import POSITIVE
from parflex.base.kinds import LENGTH, TIME
from parflex.kernels.segment import path, resting
from parflex.simulation.moves import ALL_MOVES, Circle, Hold, MoveTo, Pose
from parflex.simulation.moves.move import Move, entry
from parflex.simulation.moves.move_to import QUINTIC

FROM = Pose(np.array([0.2, -0.1, 0.9]), Rotation.from_rotvec([0.3, -0.2, 0.5]).as_matrix())
OTHER = Rotation.from_rotvec([-0.4, 0.6, 0.1]).as_matrix()
EXAMPLES = {
    MoveTo: [MoveTo((0.1, 0.0, 1.0), OTHER, duration=0.7), MoveTo(rotation=OTHER, duration=0.3)],
    Hold: [Hold(0.4)],
    Circle: [
        Circle(0.01, 5.0, 5),
        Circle(0.2, 0.5, 1.3, normal=(0.3, -0.5, 0.8), centre=(1, 2, 0), ramp=2.0),
        Circle(0.05, 2.0, 3, normal=(1, 0, 0), ramp=1.5),  # its speed grows, and then falls
    ],
}
ALL_EXAMPLES = [move for moves in EXAMPLES.values() for move in moves]
STEP = 1e-5  # s, of central differences, whose error is STEP² times a third derivative of some 1e3
DIFFERENCES = 1e-6
REST = 0.1


def way_of(*moves):
    """A trajectory of moves from the pose."""
    return pf.Trajectory.of(pf.State(*FROM), moves, rest=(REST, REST))


@pytest.fixture(params=ALL_EXAMPLES, ids=repr)
def move(request):
    return request.param


def test_every_kind_has_examples():
    assert EXAMPLES.keys() == set(ALL_MOVES)


def test_a_move_goes_from_rest_to_rest(move):
    """It begins in the pose given and ends in its own, without velocity or acceleration."""
    way = way_of(move)
    assert way.duration == pytest.approx(2 * REST + move.duration, rel=1e-14)
    for t, pose in ((REST, FROM), (way.duration - REST, move.end(FROM))):
        sample = way.sample(t)
        assert relative(sample.position, pose.position) < 1e-14
        assert relative(sample.rotation, pose.rotation) < 1e-14
        assert relative(sample.twist, np.zeros(6)) < 1e-12
        assert relative(sample.acceleration, np.zeros(6)) < 1e-11


def test_a_move_is_a_motion(move):
    """v_p = Rᵀ ṗ, ω̂ = Rᵀ Ṙ, v̇_p = Rᵀ p̈ and ω̇_p, by central differences of poses and twists."""
    way = way_of(move)
    t = np.random.default_rng(0).uniform(0, way.duration, 300)
    before, now, after = (way.sample(t + s) for s in (-STEP, 0, STEP))
    R_t = np.swapaxes(now.rotation, -1, -2)
    velocity = R_t @ (after.position - before.position)[..., None] / (2 * STEP)
    spin = R_t @ (after.rotation - before.rotation) / (2 * STEP)
    omega = np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]], axis=-1)
    assert np.allclose(now.twist, np.hstack([velocity[..., 0], omega]), atol=DIFFERENCES)
    linear = [s.rotation @ s.twist[:, :3, None] for s in (before, after)]
    rates = R_t @ (linear[1] - linear[0]) / (2 * STEP)
    turning = (after.twist[:, 3:] - before.twist[:, 3:]) / (2 * STEP)
    assert np.allclose(now.acceleration, np.hstack([rates[..., 0], turning]), rtol=1e-4, atol=1e-4)


def test_a_move_has_no_jumps(move):
    """Across the ends of every segment, position, velocity and acceleration change with the time alone."""
    way = way_of(move)
    near = 1e-9  # s, in which an acceleration changes by jerk × time
    before, after = (way.sample(way.starts[1:] + s) for s in (-near, near))
    for name, most in (("position", 1e-8), ("rotation", 1e-8), ("twist", 1e-7), ("acceleration", 1e-5)):
        assert np.max(np.abs(getattr(before, name) - getattr(after, name))) < most, name


@pytest.mark.parametrize("circle", EXAMPLES[Circle], ids=repr)
def test_a_circle_is_round(circle):
    """All of it lies on the rim, in the plane across the normal through the start; nothing turns."""
    way = way_of(circle)
    sample = way.sample(np.linspace(0, way.duration, 501))
    normal = circle.normal / np.linalg.norm(circle.normal)
    towards = np.array([0.0, 1.0, 0.0] if abs(normal[0]) == 1 else [1.0, 0.0, 0.0])
    towards = towards if circle.centre is None else circle.centre
    inward = np.cross(normal, np.cross(towards, normal))
    centre = FROM.position + circle.radius * inward / np.linalg.norm(inward)
    arm = sample.position - centre
    assert np.max(np.abs(np.linalg.norm(arm, axis=1) - circle.radius)) < 1e-15
    assert np.max(np.abs(arm @ normal)) < 1e-15
    assert relative(sample.rotation, np.broadcast_to(FROM.rotation, sample.rotation.shape)) < 1e-15
    velocity = (sample.rotation @ sample.twist[:, :3, None])[..., 0]
    assert np.all(np.cross(arm, velocity) @ normal > -1e-15)  # right-handed


def test_a_circle_keeps_its_frequency():
    """Between the ramps the angle grows by 2π f t, at the speed 2π f r and the acceleration (2π f)² r."""
    circle = Circle(0.01, 5.0, 5, normal=(0.3, -0.5, 0.8), ramp=0.4)
    way, omega = way_of(circle), 2 * np.pi * 5.0
    t = np.linspace(REST + 0.4, way.duration - REST - 0.4, 200)
    sample = way.sample(t)
    assert np.allclose(np.linalg.norm(sample.twist[:, :3], axis=1), omega * 0.01, rtol=1e-14)
    assert np.allclose(np.linalg.norm(sample.acceleration[:, :3], axis=1), omega**2 * 0.01, rtol=1e-13)
    period = way.sample(t[t < t[-1] - 0.2] + 0.2).position
    assert np.max(np.abs(period - sample.position[: len(period)])) < 1e-15


def test_circles_go_round_as_often_as_they_say():
    """The angle, unwrapped about the centre, is 2π times the turns; half a turn ends opposite."""
    circle = Circle(0.1, 2.0, 2.5)
    way = way_of(circle)
    arm = way.sample(np.linspace(0, way.duration, 400)).position - FROM.position - (0.1, 0, 0)
    angle = np.unwrap(np.arctan2(arm[:, 1], arm[:, 0]))
    assert angle[-1] - angle[0] == pytest.approx(5 * np.pi, rel=1e-14)
    assert relative(way.positions[-1], FROM.position + (0.2, 0, 0)) < 1e-15


def test_moves_are_composed():
    """Each begins where the one before ended; poses and times are those of the moves."""
    moves = (Hold(1.0), MoveTo(FROM.position + (0, 0, 0.01), duration=0.05), Circle(0.01, 5.0, 5, ramp=0.4))
    way = pf.Trajectory.of(pf.State(*FROM), moves)
    assert np.allclose(way.durations, [1.0, 0.05, 1.4], rtol=1e-14)
    assert relative(way.positions, FROM.position + np.outer([0, 0, 1, 1], [0, 0, 0.01])) < 1e-15
    assert relative(way.sample(1.5).position, FROM.position + (0, 0, 0.01)) > 1e-3  # on its way round
    assert not way.still
    assert pf.Trajectory.of(pf.State(*FROM), [Hold(1.0), MoveTo(*FROM, duration=1.0)]).still


def test_straight_moves_are_what_a_trajectory_is_by_default():
    poses = np.stack([FROM.position, (0.1, 0, 1)]), np.stack([FROM.rotation, OTHER])
    plain = pf.Trajectory(*poses, [0.7], rest=(0.1, 0.1))
    composed = way_of(MoveTo((0.1, 0, 1), OTHER, duration=0.7))
    assert np.array_equal(plain.segments, composed.segments)
    assert np.array_equal(plain.starts, composed.starts)


@pytest.mark.parametrize("backend", ["vm", "native"])
def test_compiled_laws_follow_a_circle(model_of, backend):
    """Forces of computed torque, traced and compiled, are those of the floats, in every segment."""
    home = model_of(0).robot.home
    moves = [Hold(0.1), MoveTo(home.position + (0.01, 0, 0), OTHER, duration=0.2), Circle(0.02, 5.0, 2)]
    way = pf.Trajectory.of(home, moves, rest=(0.1, 0.1))
    reference, compiled = (
        pf.ComputedTorque(model, way, kp=100, kd=20) for model in (model_of(0), model_of(0, backend))
    )
    for t in np.linspace(0, way.duration, 23):
        assert relative(compiled(t, home) / 1e3, reference(t, home) / 1e3) < 1e-11


@dataclass(frozen=True, eq=False, repr=False)
class Lift(Move):
    """A kind of move as its file would have it: straight up, by a height."""

    word = "lift"
    about = "Straight up."

    height: float = entry(LENGTH, "how far", POSITIVE)
    duration: float = entry(TIME, "how long", POSITIVE, default=1.0)

    def segments(self, start):
        way = np.array([0.0, 0.0, self.height, 0.0])
        line = path(start.position, way, QUINTIC)
        return [resting(*start, self.duration)._replace(path=line)]


FILE = """\
format = "parflex-trajectory-1"
[[move]]
lift = { height = "20 mm" }
[controller]
kind = "computed-torque"
"""


def test_another_kind_has_its_table_in_trajectory_files(tmp_path):
    """One more class in the tuple: it has a key, its complaints have lines, and it is flown."""
    kinds = (*ALL_MOVES, Lift)
    file = tmp_path / "way.toml"
    file.write_text(FILE)
    way = trajectory_of(read_plan(file, moves=kinds), pf.State(*FROM))
    assert relative(way.positions, FROM.position + np.outer([0, 1], [0, 0, 0.02])) < 1e-15
    table = trajectory_table(moves=kinds).model_json_schema()["$defs"]["LiftTable"]
    assert table["properties"]["duration"]["default"] == 1.0
    file.write_text(FILE.replace("height", "hight"))
    with pytest.raises(pf.InputError, match=r"way.toml:3: move\[0\].lift.hight is not known; did you mean h"):
        read_plan(file, moves=kinds)


BAD = {
    "no radius": (lambda: Circle(0.0, 5.0), "Circle.radius is 0.0; it must be positive"),
    "backwards": (lambda: Circle(0.1, -5.0), "Circle.frequency is -5.0; it must be positive"),
    "no turns": (lambda: Circle(0.1, 5.0, 0), "Circle.turns is 0.0; it must be positive"),
    "no normal": (lambda: Circle(0.1, 5.0, normal=(0, 0, 0)), "Circle.normal is zero; give a direction"),
    "centre along it": (lambda: Circle(0.1, 5.0, centre=(0, 0, 2)), "give a direction across the normal"),
    "sudden": (lambda: Circle(0.1, 5.0, ramp=0), "Circle.ramp is 0.0; it must be positive"),
    "long ramp": (
        lambda: Circle(0.1, 5.0, 2, ramp=0.5),
        "Circle.ramp is 0.5 s, longer than turns / frequency, 0.4 s",
    ),
    "no time": (lambda: Hold(0), "Hold.duration is 0.0; it must be positive"),
    "stretched": (lambda: MoveTo(None, np.diag([1, 1, 2]), duration=1), "MoveTo.rotation is not a rotation"),
    "nothing": (lambda: way_of(), "moves is empty"),
    "a pose": (lambda: way_of((0, 0, 1)), "moves[0] is tuple; expected a Move"),
    "elsewhere": (
        lambda: pf.Trajectory([(0, 0, 1)] * 2, [np.eye(3)] * 2, [1.0], moves=(Hold(2.0),)),
        "Trajectory.moves do not lead through its positions and rotations in its durations; use ",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_told(name):
    make, words = BAD[name]
    with pytest.raises(pf.InputError) as caught:
        make()
    assert words in str(caught.value)
