"""Couplings of joints, against Lagrange's equations, springs of single joints, and turned axes."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import parflex as pf
from lagrange import Lagrange, errors
from measures import random_states, relative
from parflex.mechanics.chain import chain_of, frames
from parflex.mechanics.legs.base import joints_at

AGREED = 1e-10
SAME = 1e-12
K = np.array([[60.0, 25.0, -9.0], [25.0, 40.0, 4.0], [-9.0, 4.0, 900.0]])
D = np.array([[2.0, 0.5, 0.1], [0.5, 1.0, 0.2], [0.1, 0.2, 30.0]])


def with_couplings(robot, *couplings):
    return replace(robot, legs=tuple(replace(leg, couplings=couplings) for leg in robot.legs))


def state_of(robot, seed):
    """A state that names its joints."""
    state = random_states(robot, 1, seed)[0]
    legs = pf.Model(robot, "numpy").joints(state)
    return replace(state, joints=legs.q, joint_rates=legs.qd)


@pytest.mark.parametrize("backend", ["numpy", "vm", "native"])
def test_they_obey_lagranges_equations(backend):
    """Two couplings in each leg, one of them on a joint whose drive gives; energies too."""
    couplings = (pf.Coupling((1, 2, 3), K, D, (0.1, 0.2, 0.9)), pf.Coupling((2,), [[7.0]]))
    robot = with_couplings(pf.robots.gough_stewart(2), *couplings)
    legs = []
    for leg in robot.legs:
        driven = replace(leg.joints[2], drive_stiffness=3e4, drive_damping=4.0, IA=2.0)
        legs.append(replace(leg, joints=(*leg.joints[:2], driven)))
    robot = replace(robot, legs=tuple(legs))
    state, forces = state_of(robot, 1), np.linspace(-50, 80, 6)
    model, answer = pf.Model(robot, backend), Lagrange(robot)(state, forces)
    found = errors(answer, model, state, forces)
    assert max(found.values()) <= AGREED, found
    assert sum(model.energies(state)) == pytest.approx(answer.energy, rel=SAME)


def test_a_diagonal_one_is_springs_of_the_joints():
    """Also its derivatives: by q_0, k and viscous friction of each joint."""
    robot = pf.robots.gough_stewart(1)
    rest = (0.1, 0.2, 0.9)
    coupled = with_couplings(robot, pf.Coupling((1, 2, 3), np.diag(np.diag(K)), np.diag(np.diag(D)), rest))
    numbers = list(zip(np.diag(K), rest, np.diag(D), strict=True))
    legs = [
        [replace(j, k=k, q_0=q_0, Fv=j.Fv + d) for j, (k, q_0, d) in zip(leg.joints, numbers, strict=True)]
        for leg in robot.legs
    ]
    pairs = zip(robot.legs, legs, strict=True)
    sprung = replace(robot, legs=tuple(replace(leg, joints=tuple(joints)) for leg, joints in pairs))
    state, forces = state_of(robot, 2), np.linspace(-50, 80, 6)
    one, other = (pf.Model(each, "numpy") for each in (coupled, sprung))
    assert relative(one.direct(state, forces).platform, other.direct(state, forces).platform) <= 1e-13
    assert relative(*(m.direct_jacobian(state, forces).state for m in (one, other))) <= SAME
    assert one.energies(state).springs == pytest.approx(other.energies(state).springs, rel=SAME)


def on_a_flexure(coupling):
    """A body on one leg of six sprung joints, P P P R R R at right angles, of which the last alone carries
    mass: a 6 × 6 flexure at the base, its joints carried in the state."""
    quarter = np.pi / 2
    joints = [pf.Joint(j, sigma=int(j < 3), alpha=quarter, gamma=quarter) for j in range(5)]
    stage = {"M": 2.0, "MS": (0.0, 0.1, 0.2), "I": np.diag([0.3, 0.3, 0.2])}
    joints.append(pf.Joint(5, sigma=0, mu=1, alpha=quarter, gamma=quarter, **stage))
    points = np.array([[0.1, 0.0, 0.05], [-0.1, 0.1, 0.05], [-0.1, -0.1, 0.05]])
    tips = tuple(pf.Tip(6, point, n) for n, point in enumerate(points))
    body = pf.FlexibleBody.rigid(3.0, (0.01, 0.02, 0.1), np.diag([0.2, 0.2, 0.3]), points)
    leg = pf.Leg(np.eye(3), np.zeros(3), joints, tips, couplings=(coupling,))
    return pf.Robot((leg,), body, (0, 0, -9.81), (np.zeros(3), np.eye(3)))


@pytest.mark.parametrize("backend", ["numpy", "vm"])
def test_a_flexure_of_six_joints_without_mass(backend):
    """A full 6 × 6 matrix, displaced and in motion: Lagrange's equations are the gradient of its energy."""
    rng = np.random.default_rng(0)
    root, dampers = rng.normal(size=(2, 6, 6))
    scale = np.diag([60.0, 60.0, 60.0, 4.0, 4.0, 4.0])
    coupling = pf.Coupling(
        range(1, 7), scale @ root @ root.T @ scale, dampers @ dampers.T, 0.01 * rng.normal(size=6)
    )
    robot = on_a_flexure(coupling)
    turn = Rotation.from_rotvec(0.1 * rng.normal(size=3)).as_matrix()
    state = pf.State(0.01 * rng.normal(size=3), turn, 0.2 * rng.normal(size=6))
    model = pf.Model(robot, backend)
    legs = model.joints(state)
    state = replace(state, joints=legs.q, joint_rates=legs.qd)
    answer = Lagrange(robot)(state, np.array([0.7]))
    found = errors(answer, model, state, np.array([0.7]))
    assert max(found.values()) <= AGREED, found
    assert sum(model.energies(state)) == pytest.approx(answer.energy, rel=SAME)


@pytest.mark.parametrize("angle", [0.0, np.pi / 4])
def test_turned_axes_of_sliding_joints(angle):
    """Two sliders at right angles whose frame is turned by 45° and whose matrix is diag(k1, k2), against
    sliders that stand straight and have the same matrix in their axes, R diag(k1, k2) Rᵀ."""
    K_d, D_d = np.diag([9e3, 4e3]), np.diag([30.0, 20.0])
    c, s = np.cos(angle), np.sin(angle)
    R = np.array([[c, -s], [s, c]])
    straight = sliders(0.0, pf.Coupling((1, 2), R @ K_d @ R.T, R @ D_d @ R.T))
    turned = sliders(angle, pf.Coupling((1, 2), K_d, D_d))
    forces = np.zeros(straight.n_forces)
    found = []
    for robot in (straight, turned):
        home = robot.home
        state = replace(
            home, position=np.asarray(home.position) + [0.01, -0.02, 0.0], twist=[0.1, 0.2, 0, 0, 0, 0]
        )
        found.append(pf.Model(robot, "numpy").direct(state, forces))
    assert relative(found[0].platform, found[1].platform) <= AGREED


def sliders(angle, coupling):
    """A plate on one stage of two crossed sliders, x then y of a frame that is turned by an angle about the
    vertical; the stage clamps it by three tips."""
    quarter = np.pi / 2
    place = pf.Joint(0, sigma=1, gamma=angle + quarter, alpha=quarter)
    across = pf.Joint(1, sigma=1, mu=1, alpha=-quarter, gamma=-quarter, M=1.0, I=np.diag([0.1, 0.1, 0.1]))
    points = np.array([[0.1, 0.0, 0.0], [-0.1, 0.1, 0.0], [-0.1, -0.1, 0.0]])
    joints = (place, across)
    bare = pf.Leg(np.eye(3), np.zeros(3), joints, (pf.Tip(0, (0, 0, 0)),))
    chain = chain_of(bare)
    at = frames(chain, joints_at(chain, np.zeros((1, 2))))
    R = at.R_0j[1][0]
    tips = tuple(pf.Tip(2, R.T @ point, n) for n, point in enumerate(points))
    body = pf.FlexibleBody.rigid(3.0, (0, 0, 0), np.diag([0.2, 0.2, 0.3]), points)
    leg = replace(bare, tips=tips, couplings=(coupling,))
    return pf.Robot((leg,), body, (0, 0, -9.81), (np.zeros(3), np.eye(3)))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            lambda: pf.Coupling((1, 2), [[1.0, 2.0], [0.0, 1.0]]),
            "stiffness differs from its transpose",
        ),
        (
            lambda: pf.Coupling((1, 2), [[1.0, 2.0], [2.0, 1.0]]),
            "stiffness has the principal value -1",
        ),
        (lambda: pf.Coupling((1, 2), np.eye(3)), r"Coupling.stiffness has shape \(3, 3\); expected \(2, 2\)"),
        (lambda: pf.Coupling((1, 2), np.eye(2), rest=(0.0,)), r"Coupling.rest has shape \(1,\)"),
        (lambda: pf.Coupling((1, 1), np.eye(2)), "from 1, each once"),
        (lambda: pf.Coupling((0, 1), np.eye(2)), "from 1, each once"),
        (lambda: on_delta((2, 4)), "across a branch of the tree: joint 4 does not follow joint 2 but"),
        (lambda: on_delta((1, 9)), "this leg has joints 1"),
    ],
)
def test_bad_couplings_are_refused(change, words):
    with pytest.raises(pf.InputError, match=words):
        change()


def on_delta(joints):
    return replace(pf.robots.delta(0).legs[0], couplings=(pf.Coupling(joints, np.eye(2)),))


def test_files_keep_them(tmp_path):
    robot = with_couplings(pf.robots.gough_stewart(0), pf.Coupling((1, 2, 3), K, D, (0.1, 0.2, 0.9)))
    for leg in robot.legs:
        assert leg.couplings[0].joints == (1, 2, 3)
    found = pf.load_robot(robot.to_file(tmp_path / "robot.toml"))
    for leg in found.legs:
        (own,) = leg.couplings
        assert own.joints == (1, 2, 3)
        assert np.array_equal(own.stiffness, K)
        assert np.array_equal(own.damping, D)
        assert own.rest.tolist() == [0.1, 0.2, 0.9]


def test_files_have_units(tmp_path):
    """Of a joint that turns, of one that slides, and of both together."""
    robot = with_couplings(pf.robots.gough_stewart(0), pf.Coupling((2, 3), [[60.0, 25.0], [25.0, 40.0]]))
    path = robot.to_file(tmp_path / "robot.toml")
    text = path.read_text()
    written = '[["0.06 N m/mrad", "25 N/rad"], ["25 N", "0.04 N/mm"]]'
    path.write_text(text.replace("[[60.0, 25.0], [25.0, 40.0]]", f'{written}\nrest = ["3 deg", "500 mm"]'))
    assert text != path.read_text()
    for leg in pf.load_robot(path).legs:
        assert np.allclose(leg.couplings[0].stiffness, [[60.0, 25.0], [25.0, 40.0]], rtol=1e-14)
        assert np.allclose(leg.couplings[0].rest, [np.radians(3), 0.5], rtol=1e-14)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("joints = [1, 2]", "joints = [1, 3]", "a coupling across a branch of the tree"),
        ("[25.0, 40.0]", "[24.0, 40.0]", "stiffness differs from its transpose by 1"),
        ("[60.0, 25.0]", "[1.0, 25.0]", "stiffness has the principal value -11.2"),
        ("[60.0, 25.0], [25.0, 40.0]", "[60.0]", "stiffness has 1 rows; give one for each of 2 joints"),
        ("[60.0, 25.0]", "[60.0]", r"stiffness\[0\] has 1 numbers; give one for each of 2 joints"),
        ("[60.0, 25.0]", '["60 N/m", 25.0]', r"stiffness\[0\]\[0\] is \"60 N/m\", which is not a stiffness"),
        ("joints = [1, 2]", "joints = [1, 9]", r"joints is \[1, 9\]; this leg has joints 1 … 3"),
    ],
)
def test_files_name_the_line(tmp_path, old, new, words):
    robot = with_couplings(pf.robots.gough_stewart(0), pf.Coupling((1, 2), K[:2, :2]))
    path = robot.to_file(tmp_path / "robot.toml")
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(pf.InputError, match=words) as told:
        pf.load_robot(path)
    assert re.search(r"robot.toml:\d+: chain.rrp-1.couplings\[0\]", str(told.value))
