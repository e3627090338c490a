"""What every robot of the gallery promises, rigid and flexible: one contract for all of `ALL_ROBOTS`."""

from dataclasses import replace
from functools import cache
from importlib import import_module

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import oracle
import parflex as pf
from measures import actuated, relative
from parflex.mechanics.closure import posed
from parflex.model.core import core_of
from parflex.robot.layout import unpack
from places import DOCS

ENTRIES = {entry.name: entry for entry in pf.robots.ALL_ROBOTS}
GAP = 1e-12  # m: round-off at the tips
SAME = 1e-10  # two orders of the same operations
SOFT = 1e-9  # likewise, where round-off of positions, 1e-17 m, is pulled at by flexures of 1e8 N/m
INVERSE = 1e-9  # the accuracy the library promises
GEOMETRY = 1e-10  # m and rad: Newton's method to its end
REST = 1e-8  # of an equilibrium's forces: the bend is found to 1e-9 of itself
POSES = 200
TRACKED = 1e-6  # m and rad: what feedback leaves of the integrator's error
MOVE_TIME, RUN = 0.4, 0.3  # s

every = pytest.mark.parametrize("flexible", [False, True], ids=["rigid", "flexible"])
robots = pytest.mark.parametrize("name", ENTRIES)
commanding = pytest.mark.parametrize("name", [name for name, entry in ENTRIES.items() if entry.output])
REACH = {"nano-hexapod": 1e-3}  # of that of the others: its actuators move by tenths of a millimetre


@cache
def robot(name: str, flexible: bool) -> pf.Robot:
    return ENTRIES[name].build() if flexible else ENTRIES[name].build(modes=0)


@cache
def model(name: str, flexible: bool) -> pf.Model:
    return pf.Model(robot(name, flexible), "numpy")


@cache
def compiled(name: str, flexible: bool) -> pf.Model:
    return pf.Model(robot(name, flexible), "vm")


def output(name: str) -> pf.FrameOutput | pf.JointOutput:
    return pf.FrameOutput(ENTRIES[name].output) if ENTRIES[name].output else pf.JointOutput()


@cache
def states(name: str, flexible: bool, count: int = 6) -> pf.State:
    """States on the closure within some 0.03 m and 0.06 rad of home, or less, moving and bent."""
    m, rng, reach = model(name, flexible), np.random.default_rng(7), REACH.get(name, 1.0)
    body = m.robot.platform
    omega = np.sqrt(body.stiffness)
    bend = 0.003 * reach * (omega[:1] / omega) ** 2
    turn = Rotation.from_rotvec(reach * rng.uniform(-0.06, 0.06, (count, 3))).as_matrix()
    guess = pf.State(
        m.robot.home.position + reach * rng.uniform(-0.03, 0.03, (count, 3)),
        turn @ m.robot.home.rotation,
        reach * rng.normal(0.0, 0.3, (count, 6)),
        bend * rng.normal(size=(count, body.modes)),
        30.0 * bend * rng.normal(size=(count, body.modes)),
    )
    return m.project(guess)


@cache
def forces(name: str, flexible: bool) -> np.ndarray:
    """Forces about those of the equilibrium, one row per state."""
    _, still = model(name, flexible).equilibrium(*model(name, flexible).robot.home_pose)
    rng = np.random.default_rng(8)
    return still + rng.uniform(-20.0, 20.0, (6, len(still)))


@robots
@every
def test_home_is_assembled(name, flexible):
    """The legs' inverse geometry puts every tip where the platform has it, by the oracle's chains."""
    home, body = robot(name, flexible).home, robot(name, flexible).platform
    joints = model(name, flexible).joints(home).q
    for leg, q in zip(robot(name, flexible).legs, joints, strict=True):
        held = body.attachment_points[[tip.attachment for tip in leg.tips]]
        wanted = home.position + held @ np.asarray(home.rotation).T
        assert np.max(np.abs(oracle.tree(leg, q)[1] - wanted)) <= GAP


@commanding
@every
def test_mobility_is_as_stated(name, flexible):
    m = model(name, flexible)
    found = m.mobility(m.robot.home)
    assert found.freedoms == len(ENTRIES[name].output)
    assert found.actuators >= found.freedoms
    assert (found.internal, found.redundant, len(found.parallel), len(found.serial)) == (0, 0, 0, 0)


@commanding
def test_closed_forms_are_recognised(name):
    assert not any(group.type.carries for group in core_of(model(name, False)).mechanism.groups)


@commanding
def test_the_output_is_commanded(name):
    """The actuators move it the right way, and what bends while it is held comes to rest."""
    m = model(name, True)
    report = m.output_report(m.robot.home, output(name))
    assert np.min(report.gain_ratio.real) > 0
    assert report.stable


@robots
@every
def test_equilibrium_is_at_rest(name, flexible):
    m = model(name, flexible)
    state, still = m.equilibrium(*m.robot.home_pose)
    found = m.direct(state, still)
    load = m.robot.platform.stiffness * state.elastic
    assert np.max(np.abs(found.platform)) <= REST
    assert relative(found.elastic + load, load) <= REST


@commanding
@every
def test_inverse_after_direct(name, flexible):
    """The forces come back; of redundant ones those nearest to them."""
    m, u = model(name, flexible), forces(name, flexible)
    found = m.direct(states(name, flexible), u)
    target = found.platform[..., list(ENTRIES[name].output)]
    back = m.inverse(states(name, flexible), target, output(name), preload=u)
    assert relative(back.forces, u) <= INVERSE
    assert relative(back.platform, found.platform) <= INVERSE
    assert relative(back.elastic, found.elastic) <= INVERSE


@robots
@every
def test_backends_agree(name, flexible):
    u, target = forces(name, flexible), np.ones(len(ENTRIES[name].output) or robot(name, flexible).n_forces)
    plain, fast = model(name, flexible), compiled(name, flexible)
    at, same = states(name, flexible), SOFT if any(leg.soft for leg in plain.robot.legs) else SAME
    for a, b in zip(fast.joints(at), plain.joints(at), strict=True):
        assert relative(np.concatenate(a, axis=-1), np.concatenate(b, axis=-1)) <= same
    direct = (m.direct(at, u) for m in (plain, fast))
    inverse = (m.inverse(at, target, output(name)) for m in (plain, fast))
    for answers in (direct, inverse):
        for a, b in zip(*answers, strict=True):
            assert relative(b, a) <= same


def cloud(name: str, flexible: bool) -> oracle.NodalPlatform:
    """The plate as the oracle sees it, held where the robot holds it."""
    entry, body = ENTRIES[name], model(name, flexible).robot.platform
    module = import_module(entry.build.__module__)
    ratio = body.damping[0] / (2 * np.sqrt(body.stiffness[0])) if flexible else 0.0
    plate = oracle.plate_cloud(module.corners(), **module.PLATE, n_modes=body.modes, damping_ratio=ratio)
    shapes = np.moveaxis(body.shapes[:, list(body.attachments)], 0, -1)
    return replace(plate, attachments=body.attachment_points, attachment_shapes=shapes)


@commanding
@every
def test_oracle_agrees(name, flexible):
    m, at, u = model(name, flexible), states(name, flexible), forces(name, flexible)
    found = m.direct(at, u)
    q, plate = m.joints(at).q, cloud(name, flexible)
    for s in range(2):
        wanted = oracle.direct(m.robot, plate, at[s], u[s], start=[leg[s] for leg in q])
        assert relative(found.platform[s], wanted[0]) <= INVERSE
        assert relative(found.elastic[s], wanted[1]) <= INVERSE
        assert relative(found.contact_forces[s], wanted[2]) <= INVERSE


@commanding
def test_forward_geometry_after_inverse_geometry(name):
    """From home to all poses in one batch, and to some by the door."""
    m, rng = model(name, False), np.random.default_rng(9)
    home, mechanism = m.robot.home, core_of(m).mechanism
    turn = Rotation.from_rotvec(rng.uniform(-0.08, 0.08, (POSES, 3))).as_matrix()
    place = home.position + rng.uniform(-0.04, 0.04, (POSES, 3))
    wanted = m.project(pf.State(place, turn @ home.rotation))
    joints = actuated(m.robot, m.joints(wanted).q)
    start = np.broadcast_to(core_of(m).flat(home), (POSES, mechanism.layout.size))
    found = unpack(posed(mechanism, start, joints)[0], mechanism.layout)
    assert np.max(np.abs(found.position - wanted.position)) <= GEOMETRY
    assert np.max(np.abs(found.rotation - wanted.rotation)) <= GEOMETRY
    for s in range(3):
        assert np.max(np.abs(m.forward(joints[s]).position - wanted.position[s])) <= GEOMETRY


@commanding
@every
def test_computed_torque_keeps_to_the_trajectory(name, flexible):
    """In the commanded rows. Where the robot drifts off in the others, the error's components turn
    with the platform: they are those of the commanded rows up to drift times turn."""
    entry, m = ENTRIES[name], compiled(name, flexible)
    start, _ = m.equilibrium(*m.robot.home_pose)
    way = pf.Trajectory.through(start, entry.moves, MOVE_TIME, rest=(0.0, 0.0))
    control = pf.ComputedTorque(m, way, kp=400.0, kd=40.0, output=output(name))
    run = pf.simulate(m, control, start, np.linspace(0.0, RUN, 7), rtol=1e-7, atol=1e-9)
    assert not run.partial
    error = np.abs(run.dataset["pose_error"].values)
    moved = np.linalg.norm(run.dataset["position"].values - np.asarray(start.position), axis=1)
    turn = max(np.linalg.norm(move[1]) for move in entry.moves)
    assert np.max(error[:, list(entry.output)]) <= TRACKED + turn * np.max(error)
    assert np.max(moved) > 1e-3


@robots
@every
def test_file_and_back(name, flexible, tmp_path):
    """The robot that is read answers as the one that was written, to the bit."""
    m = model(name, flexible)
    back = pf.Model(pf.load_robot(m.robot.to_file(tmp_path / "robot.toml")), "numpy")
    at, u = states(name, flexible), forces(name, flexible)
    for a, b in zip(m.direct(at, u), back.direct(at, u), strict=True):
        assert np.array_equal(a, b)


def test_a_platform_of_ones_own():
    """Every robot takes one, with as many attachments as its plate has."""
    for entry in pf.robots.ALL_ROBOTS:
        points = model(entry.name, False).robot.platform.attachment_points
        body = pf.FlexibleBody.rigid(5.0, (0, 0, 0.02), np.diag([0.1, 0.1, 0.15]), points)
        assert entry.build(platform=body).platform is body


def test_the_command_checks_a_written_robot(parflex):
    model("Delta", True).robot.to_file("delta.toml")
    code, out, err = parflex("check", "delta.toml")
    assert code == 0, err
    assert "3 freedoms" in out


@robots
def test_the_page_shows_it(name):
    """Its picture is there, and the table counts as the model does."""
    entry = ENTRIES[name]
    assert (DOCS / "pictures" / f"gallery_{entry.build.__name__}.png").stat().st_size > 10_000
    lines = (DOCS / "gallery.md").read_text(encoding="utf-8").splitlines()
    (row,) = [line for line in lines if line.startswith(f"| [{name}]")]
    cells = [cell.strip() for cell in row.strip("| ").split("|")]
    found = model(name, True).mobility(robot(name, True).home)
    legs = robot(name, True).legs
    assert cells[1:3] == [f"`{entry.build.__name__}`", f"{len(legs)} × {legs[0].word}"]
    modes = robot(name, True).platform.modes
    assert cells[3:7] == [str(n) for n in (found.freedoms, found.actuators, found.rows, modes)]
    assert cells[8] == entry.source
