"""Modes and static loads as the page has them: where the robot is drawn, and what is told of it."""

from dataclasses import replace
from math import radians

import numpy as np
import pytest

import flexlegs
import parflex as pf
from measures import relative
from parflex.mechanics.closure import displaced
from parflex.model.core import core_of
from parflex.simulation.holding import held, swinging
from parflex.views.sketch import sketch
from parflex.views.viewer.drawing import edges
from parflex.views.viewer.loads import in_words, load_as_swing
from parflex.views.viewer.scene import Platform
from parflex.views.viewer.swing_frames import as_dataset, frames_of, largest_motions
from parflex.views.viewer.swing_page import swinging_scene
from parflex.views.viewer.swings import modes_as_swings

STIFFNESS = 2e6  # N/m, of each strut


def sprung(gravity=(0.0, 0.0, 0.0)) -> pf.Model:
    """A rigid platform on six struts with springs and next to no mass."""
    bar = pf.Bar(mass=1e-5, outer=0.01, length=0.15)
    robot = pf.robots.hexapod(
        base_radius=0.25,
        platform_radius=0.15,
        height=0.3,
        base_spread=radians(20),
        platform_spread=radians(30),
        strut=pf.Strut(bar, bar, stiffness=STIFFNESS),
    )
    return pf.Model(pf.Robot(robot.legs, robot.platform, gravity, robot.home_pose), "numpy")


@pytest.fixture(scope="module")
def bending() -> tuple[pf.Model, pf.LinearModel]:
    """A robot whose platform and legs bend, on locked motors."""
    model = pf.Model(flexlegs.robot("gs_flexlegs"), "numpy")
    return model, held(model, "locked")[1]


@pytest.fixture(scope="module")
def plate() -> tuple[pf.Model, pf.LinearModel]:
    """A plate that bends on cranks, on locked motors."""
    model = pf.Model(pf.robots.rus6(modes=3), "numpy")
    return model, held(model, "locked")[1]


def test_motions_are_those_of_the_drawn_robot(bending):
    """Central differences of the frames, against pictures of the robot beside the equilibrium."""
    model, lin = bending
    core, shapes = core_of(model), lin.modes()["shape"].values[[0, 8]]
    frames = frames_of(lin, shapes)
    for k, shape in enumerate(shapes):
        both = [
            sketch(model, core.state(displaced(core.mechanism, lin.point.x, h * shape)), 1.0)
            for h in (1e-4, -1e-4)
        ]
        assert relative(frames.path[1 + k], (both[0].lines - both[1].lines) / 2e-4) < 1e-5
        nodes = np.linalg.norm(both[0].nodes - both[1].nodes, axis=-1) / 2e-4
        points = np.linalg.norm(frames.path[1 + k], axis=-1)
        assert largest_motions(lin, frames)[k] == pytest.approx(max(nodes.max(), points.max()), rel=1e-5)


def test_legs_hold_the_platform_in_every_motion(bending):
    """Tips of the legs and attachments of the platform move alike, in real and imaginary parts."""
    _, lin = bending
    told = modes_as_swings(lin)
    frames = frames_of(lin, np.array([s for each in told.swings for s in (each.shape, each.quarter)]))
    body, data = lin.point.mechanism.platform.body, as_dataset(lin, frames)
    at = body.nodes + np.einsum("n,nka->ka", frames.elastic[0], body.shapes)
    bend = np.einsum("tn,nka->tka", frames.elastic[1:], body.shapes) @ frames.rotation[0].T
    moved = frames.position[1:, None] + np.einsum("tij,kj->tki", frames.rotation[1:], at) + bend
    held_nodes = np.array(body.attachments)[data.path_attachment.values - 1]
    assert relative(frames.path[1:, :, -1], moved[:, held_nodes]) < 1e-7


def test_page_lists_what_swings(plate):
    model, lin = plate
    modes = lin.modes()
    text = pf.view(lin).html
    for i in swinging(modes):
        assert f"<td>{float(modes.frequency[i]):.5g}</td>" in text
    assert text.count('{"title": "mode') == len(swinging(modes))
    assert 'src="http' not in text
    scene = swinging_scene(modes_as_swings(lin))
    size = np.max(np.ptp(model.robot.platform.nodes, axis=0))
    data = scene.arrays
    ends = [1 + 2 * k for k in range(len(scene.meta["swings"]))]
    nodes = [
        data["position"][k]
        + (data["nodes"] + np.einsum("n,nka->ka", data["elastic"][k], data["shapes"])) @ data["rotation"][k].T
        for k in (0, *ends)
    ]
    largest = [np.max(np.linalg.norm(each - nodes[0], axis=-1)) for each in nodes[1:]]
    assert max(largest) <= 0.08 * size * 1.05  # the turn of the bend, of second order, comes on top
    assert np.max(np.abs(data["elastic"][0])) == 0.0


def test_deflection_of_a_platform_on_springs():
    """C F, with C the inverse of k Σ J Jᵀ of massless struts, whose Plücker coordinates are J."""
    model = sprung()
    lin = held(model, "springs")[1]
    node, force, moment = 0, np.array([100.0, 20.0, -50.0]), np.array([0.0, 3.0, 1.0])
    told = load_as_swing(lin, [pf.Wrench(node, force), pf.Wrench(node, moment=moment)])
    robot = model.robot
    heads = robot.platform.attachment_points
    along = heads + robot.home.position - [leg.origin for leg in robot.legs]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    J = np.hstack([along, np.cross(heads, along)])
    at = robot.platform.nodes[node]
    load = np.concatenate([force, moment + np.cross(at, force)])
    pose = np.linalg.solve(STIFFNESS * J.T @ J, load)
    moved = pose[:3] + np.cross(pose[3:], at)
    assert relative(told.forces[0].moved, moved) < 1e-8
    assert np.array_equal(told.forces[0].force, force)
    assert [row[3] for row in told.rows] == [in_words(u, "m") for u in moved]
    assert [row[4] for row in told.rows] == [in_words(u, "rad") for u in pose[3:]]


def test_deflection_on_locked_motors_is_an_equilibrium(plate):
    """The platform held where the load moves it: the motors' joints are where they were, as far as a tenth of
    the load is linear. The equilibrium's own way is Newton's method on all of the robot's forces."""
    model, lin = plate
    load = [pf.Wrench(0, (10.0, -4.0, -5.0))]
    told = load_as_swing(lin, load)
    core, first = core_of(model), slice(0, 6)
    step = told.swings[0].shape.copy()
    moved = core.state(displaced(core.mechanism, lin.point.x, step))
    found, _ = model.equilibrium(moved.position, moved.rotation, wrenches=load)
    rest, _ = model.equilibrium(*model.robot.home_pose)
    motors = [np.array([q[0] for q in model.joints(each).q]) for each in (rest, found, moved)]
    free = np.array([q[0] for q in model.joints(pf.State(moved.position, moved.rotation)).q])
    assert np.max(np.abs(step[first])) > 1e-6
    assert np.max(np.abs(motors[1] - motors[0])) < 1e-3 * np.max(np.abs(free - motors[0]))
    assert relative(found.elastic - rest.elastic, moved.elastic - rest.elastic) < 1e-3


def test_loads_that_have_no_deflection():
    """Free motors hold a robot neither where there is no gravity, nor where there is."""
    rus = pf.robots.rus6(modes=1)
    push = [pf.Wrench(0, (0, 0, -1.0))]
    for gravity, words in (((0, 0, 0), "nothing holds"), (rus.gravity, r"unstable, a motion grows")):
        free = pf.Model(pf.Robot(rus.legs, rus.platform, gravity, rus.home_pose), "numpy")
        with pytest.raises(pf.InputError, match=words):
            pf.view(held(free, "springs")[1], wrenches=push)
    model = pf.Model(rus, "numpy")
    state, forces = model.equilibrium(*rus.home_pose)
    locked = model.linearise(state, forces, controller="locked")
    with pytest.raises(pf.InputError, match="nodes 0 … "):
        pf.view(locked, wrenches=[pf.Wrench(9999, (0, 0, -1.0))])
    with pytest.raises(pf.InputError, match=r"list of pf\.Wrench"):
        pf.view(locked, wrenches=[(0, 0, -1.0)])
    with pytest.raises(pf.InputError, match="batches"):
        pf.view(locked, wrenches=[pf.Wrench(0, np.zeros((2, 3)))])
    with pytest.raises(pf.InputError, match="a linear system has its own"):
        pf.view(locked, modes="modes.nc")


def test_a_result_takes_no_wrenches(flown):
    with pytest.raises(pf.InputError, match="wrenches load a linear system"):
        pf.view(flown.result, wrenches=[pf.Wrench(0, (0, 0, -1.0))])


def test_nothing_swings_is_said():
    """A rigid robot on locked motors does not move at all."""
    model = pf.Model(pf.robots.gough_stewart(modes=0), "numpy")
    text = pf.view(held(model, "locked")[1]).html
    assert "Nothing swings" in text


def test_edges_of_a_cube_and_of_a_square():
    """Twelve, and four: diagonals of flat faces are none."""
    cube = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    none = np.zeros((0, 8, 3))
    assert len(edges(Platform(cube, none, triangles, 1.0))) == 12
    assert len(edges(Platform(cube, none, triangles[:2], 1.0))) == 4


@pytest.mark.parametrize(
    ("value", "words"),
    [(0.0, "0"), (2.5e-3, "2.5 mm"), (-3.1e-5, "-31 µm"), (4e-9, "4 nm"), (1.5, "1500 mm")],
)
def test_lengths_in_words(value, words):
    assert in_words(value, "m") == words


def test_a_node_that_the_modes_do_not_carry_is_told(plate):
    """Where the platform says what its modes miss, the page does, in its banner."""
    model, _ = plate
    body = model.robot.platform
    robot = pf.Robot(
        model.robot.legs,
        replace(body, missed=np.where(np.arange(len(body.nodes)) == 0, 0.3, 0.0)),
        model.robot.gravity,
        model.robot.home_pose,
    )
    lin = held(pf.Model(robot, "numpy"), "locked")[1]
    [note] = load_as_swing(lin, [pf.Wrench(0, (0, 0, -1.0))]).notes
    assert note.startswith(
        "Node 0 is asked for, where its modes lack 30 % of the platform's static compliance"
    )
    assert load_as_swing(lin, [pf.Wrench(1, (0, 0, -1.0))]).notes == ()
