"""Hexapods from radii, angles and struts: against rows written by hand, against published figures, misuse."""

from dataclasses import replace
from itertools import permutations
from math import radians

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import parflex as pf
from measures import random_forces, random_states, relative
from parflex.robots.hexapod_geometry import HexapodGeometry, between

SKETCH = dict(
    base_radius=0.25,
    platform_radius=0.15,
    height=0.3,
    base_spread=radians(20),
    platform_spread=radians(20),
)
BARS = pf.Bar(mass=0.3, com=0.12, inertia=(2e-5, 1.1e-3)), pf.Bar(mass=0.2, com=0.1, inertia=(1e-5, 8e-4))
STRUT = pf.Strut(*BARS, stroke=(0.29, 0.4), stiffness=2e7, damping=20.0)
PAYLOAD = pf.Payload(5.0, (0.01, -0.02, 0.06), np.diag([0.02, 0.03, 0.04]))
DISC = pf.FlexibleBody.rigid(
    4.9, (0, 0, 0), np.diag([0.0356, 0.0356, 0.0708]), HexapodGeometry(**SKETCH).platform_joints
)


def ring(radius: float, degrees: list[float]) -> np.ndarray:
    angle = np.radians(degrees)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle], axis=-1)


def by_rows() -> pf.Robot:
    """The hexapod of the sketch by Denavit–Hartenberg rows: pairs of the base at 0, 120, 240°, of the
    platform at 60, 180, 300°, neighbours joined; y of each base frame across its strut."""
    feet, heads = ring(0.25, [-10, 10, 110, 130, 230, 250]), ring(0.15, [-50, 50, 70, 170, 190, 290])
    places = heads + [0, 0, 0.3] - feet
    quarter, legs = np.pi / 2, []
    length = np.sqrt(0.3**2 + 0.25**2 + 0.15**2 - 2 * 0.25 * 0.15 * np.cos(np.radians(40)))
    for i, (foot, way) in enumerate(zip(feet, places, strict=True)):
        turn = Rotation.from_euler("z", np.arctan2(way[1], way[0])).as_matrix()
        (m1, c1), (m2, c2) = (0.3, 0.12), (0.2, 0.1)
        at1, at2 = 1.1e-3 + m1 * c1**2, 8e-4 + m2 * c2**2
        joints = (
            pf.Joint(0, 0, alpha=-quarter),
            pf.Joint(1, 0, alpha=quarter, M=m1, MS=(0, -m1 * c1, 0), I=np.diag([at1, 2e-5, at1])),
            pf.Joint(2, 1, mu=1, alpha=quarter, M=m2, MS=(0, 0, -m2 * c2), I=np.diag([at2, at2, 1e-5]),
                     k=2e7, q_0=length, Fv=20.0, q_min=0.29, q_max=0.4),
        )  # fmt: skip
        legs.append(pf.Leg(turn, foot, joints, (pf.Tip(3, attachment=i),)))
    m, c = np.array([4.9, 5.0]), np.array([[0, 0, 0], [0.01, -0.02, 0.06]])
    com = m @ c / 9.9
    inertias = np.array([np.diag([0.0356, 0.0356, 0.0708]), np.diag([0.02, 0.03, 0.04])])
    arms = c - com
    steiner = [mass * (arm @ arm * np.eye(3) - np.outer(arm, arm)) for mass, arm in zip(m, arms, strict=True)]
    body = pf.FlexibleBody.rigid(9.9, com, np.sum(inertias, axis=0) + np.sum(steiner, axis=0), heads)
    return pf.Robot(tuple(legs), body, home_pose=((0, 0, 0.3), np.eye(3)))


def test_a_hexapod_is_the_same_by_rows():
    """Direct and inverse model of random states, to 1e-14 of their size."""
    mine = pf.robots.hexapod(**SKETCH, strut=STRUT, platform=DISC, payload=PAYLOAD)
    models = [pf.Model(robot, "numpy") for robot in (mine, by_rows())]
    states = random_states(mine, 20, 1)
    states = replace(states, position=mine.home.position + 0.2 * (states.position - mine.home.position))
    found, wanted = (model.direct(states, np.full(6, 30.0)) for model in models)
    assert relative(found.platform, wanted.platform) <= 1e-14
    target = np.random.default_rng(2).normal(size=(20, 6))
    found, wanted = (model.inverse(states, target).forces for model in models)
    assert relative(found, wanted) <= 1e-14


def public_hexapod() -> pf.Robot:
    """Dehaeze's hexapod of identification.org: offsets of 15 mm, {M} 90 mm above the base."""
    bar = pf.Bar(mass=0.1, outer=0.01, length=0.05)
    sketch = dict(base_radius=0.115, platform_radius=0.09, height=0.06, base_offset=0.015)
    sketch |= dict(platform_offset=-0.015, base_spread=radians(20), platform_spread=radians(20))
    across = 1.0 * (3 * 0.1**2 + 0.01**2) / 12
    joints = HexapodGeometry(**sketch).platform_joints
    disc = pf.FlexibleBody.rigid(1.0, (0, 0, -0.005), np.diag([across, across, 0.005]), joints)
    return pf.robots.hexapod(**sketch, strut=pf.Strut(bar, bar, stiffness=20e6, damping=20), platform=disc)


PUBLISHED = {(0, 0): 4.7e-8, (0, 4): 3.2e-7, (2, 2): 2.1e-8, (3, 3): 5.2e-6, (5, 5): 1.7e-6}


def test_compliance_of_a_published_hexapod():
    """(k JᵀJ)⁻¹ at a point 45 mm above {M} (dynamics-study.org), J by the rates of the legs' lengths."""
    robot = public_hexapod()
    assert np.allclose(robot.home_pose[0], (0, 0, 0.09), atol=1e-16)
    at = np.array([0, 0, 0.045])
    twists = np.eye(6)
    twists[:3, :3], twists[3:, :3] = np.eye(3), np.cross(at, np.eye(3))  # the point turned about stands still
    states = pf.State(*(np.broadcast_to(part, (6, *part.shape)) for part in robot.home_pose), twists)
    rates = np.stack([qd[..., 2] for qd in pf.Model(robot, "numpy").joints(states).qd], axis=-1)
    compliance = np.linalg.inv(rates @ rates.T * robot.legs[0].joints[2].k)
    assert relative(compliance[0, 0] / 4.74996e-8, 1.0) < 1e-6
    for place, value in PUBLISHED.items():
        digit = 10.0 ** (np.floor(np.log10(value)) - 1)
        assert abs(compliance[place] - value) <= digit / 2 + 1e-3 * value, place


def test_springs_are_at_rest_at_home():
    """The forces that hold it at home are those without springs."""
    stiff, loose = (
        pf.Model(pf.robots.hexapod(**SKETCH, strut=replace(STRUT, stiffness=k)), "numpy") for k in (2e7, 0)
    )
    forces = [model.equilibrium(*model.robot.home_pose)[1] for model in (stiff, loose)]
    assert relative(*forces) < 1e-7  # 2e7 N/m times the round-off of a length


@pytest.mark.parametrize("order", [(5, 0, 1, 2, 3, 4), (3, 1, 4, 0, 5, 2)])
def test_a_platform_of_ones_own_may_number_its_joints_as_it_likes(order):
    expected = pf.robots.hexapod(**SKETCH, platform=DISC)
    points = DISC.attachment_points[list(order)] + 1e-4
    inertia = np.diag([0.0356, 0.0356, 0.0708])
    mine = pf.robots.hexapod(**SKETCH, platform=pf.FlexibleBody.rigid(4.9, (0, 0, 0), inertia, points))
    assert [leg.tips[0].attachment for leg in mine.legs] == [order.index(i) for i in range(6)]
    lengths = [pf.Model(robot, "numpy").joints(robot.home).q for robot in (mine, expected)]
    assert relative(*np.array(lengths)[..., 2]) < 2e-4


@pytest.mark.parametrize(("base", "platform"), [(0, 0), (20, 0), (0, 20)])
def test_joints_of_a_pair_may_coincide(base, platform):
    """The forces are those of spreads that are a millionth of a radian larger, whose joints are apart."""
    robots = [
        pf.robots.hexapod(
            **SKETCH | dict(base_spread=radians(base) + more, platform_spread=radians(platform) + more)
        )
        for more in (0.0, 1e-6)
    ]
    forces = [pf.Model(robot, "numpy").equilibrium(*robot.home_pose)[1] for robot in robots]
    assert relative(*forces) < 1e-5
    assert [leg.tips[0].attachment for leg in robots[0].legs] == list(range(6))


def test_a_body_of_three_nodes_is_held_where_it_lists_them_twice():
    """The remedy of the message; held so, it is the ideal hexapod of its disc."""
    nodes = ring(0.15, [60, 180, 300])
    body = pf.FlexibleBody.rigid(4.9, (0, 0, 0), np.diag([0.0356, 0.0356, 0.0708]), nodes)
    sketch = SKETCH | dict(platform_spread=0.0, strut=STRUT)
    with pytest.raises(pf.InputError, match="where two joints coincide, list the node twice among"):
        pf.robots.hexapod(**sketch, platform=body)
    robot = pf.robots.hexapod(**sketch, platform=replace(body, attachments=(0, 0, 1, 1, 2, 2)))
    heads = robot.platform.attachment_points[[leg.tips[0].attachment for leg in robot.legs]]
    assert np.allclose(heads, ring(0.15, [-60, 60, 60, 180, 180, 300]), atol=1e-12)


def test_struts_join_neighbours():
    """No other pairing of the joints has shorter struts in all."""
    geometry = HexapodGeometry(**SKETCH)
    heads = geometry.platform_joints + geometry.home
    total = {
        order: np.sum(np.linalg.norm(heads[list(order)] - geometry.base_joints, axis=1))
        for order in permutations(range(6))
    }
    assert min(total, key=total.get) == tuple(range(6))
    assert np.allclose(np.linalg.norm(heads - geometry.base_joints, axis=1), geometry.length, rtol=1e-14)


def test_no_leg_is_near_gimbal_lock_at_home():
    for height in (0.05, 0.3, 3.0):
        robot = pf.robots.hexapod(**SKETCH | {"height": height, "base_radius": 0.2})
        q = pf.Model(robot, "numpy").joints(robot.home).q
        assert np.allclose([each[1] for each in q], np.pi / 2)


def test_upright_struts_stand():
    """Joints below each other: any direction is across the strut."""
    sketch = dict(base_radius=0.2, platform_radius=0.2, height=0.3)
    with pytest.raises(pf.InputError, match="120 deg together"):
        pf.robots.hexapod(**sketch, base_spread=radians(60), platform_spread=radians(60))


def test_distance_of_segments():
    a, b = np.zeros(3), np.array([1.0, 0, 0])
    cases = {
        "crossing": ((0.5, -1, 0.2), (0.5, 1, 0.2), 0.2),
        "beside": ((2.0, 1, 0), (3.0, 1, 0), np.sqrt(2)),
        "an end over the middle": ((0.3, 0, 0.4), (0.3, 0, 2.0), 0.4),
        "parallel": ((0.2, 0.1, 0), (0.8, 0.1, 0), 0.1),
    }
    for c, d, expected in cases.values():
        assert between(a, b, np.array(c), np.array(d)) == pytest.approx(expected, rel=1e-12)


THICK = pf.Bar(outer=0.06, length=0.2, density=2700.0)
MISUSE = {
    "no height": (dict(height=0.0), "HexapodGeometry.height is 0.0; it must be positive"),
    "pairs that meet": (dict(base_spread=radians(120)), "base_spread is 120 deg, so that joints of neighb"),
    "degrees": (dict(base_spread=20), "base_spread is 1146 deg"),
    "over each other": (dict(base_spread=radians(100)), "base_spread and platform_spread are 120 deg"),
    "a point": (dict(base_radius=1e-6), "base_radius, platform_radius and height are 1e-06, 0.15 and 0.3 m"),
    "through each other": (dict(base_radius=0.05, strut=pf.Strut(THICK, THICK)), "legs 1 and 2 pass within"),
    "beyond the stroke": (dict(height=0.1, strut=STRUT), "strut.stroke is 0.29 … 0.4 m, but at home"),
    "no strut": (dict(strut=THICK), "strut is Bar; expected a Strut"),
    "five joints": (
        dict(platform=pf.FlexibleBody.rigid(1, (0, 0, 0), np.eye(3), np.eye(3))),
        "platform has 3 attachments; a hexapod holds six",
    ),
    "joints beside": (
        dict(platform=replace(DISC, nodes=DISC.nodes * 1.2)),
        "no attachment at the joint of leg 1, .* the nearest that no leg holds, 0, is 0.03 m away",
    ),
    "joints above": (
        dict(platform=replace(DISC, nodes=DISC.nodes + [0, 0, 0.01])),
        "give platform_offset = 0.01",
    ),
    "a payload on no node": (dict(payload=pf.Payload(1.0, node=6)), "Payload.node is 6; this body has"),
}  # fmt: skip


@pytest.mark.filterwarnings("ignore::parflex.ImplausibleValue")
@pytest.mark.parametrize("name", MISUSE)
def test_misuse_is_told_in_a_sentence(name):
    changes, words = MISUSE[name]
    with pytest.raises(pf.InputError, match=words):
        pf.robots.hexapod(**SKETCH | changes)


SHORT = pf.Bar(mass=0.3, length=0.2)
HARDLY_MEANT = {
    "millimetres": (dict(base_radius=250), 'base_radius is 250 m, .* in files "250 mm"'),
    "centimetres": (dict(platform_radius=15), "platform_radius is 15 m and base_radius 0.25 m, 60 times"),
    "over each other, nearly": (dict(base_spread=radians(99)), "spread are 119 deg together"),
    "a rod in cm": (dict(strut=pf.Strut(SHORT, pf.Bar(mass=0.3, length=20))), "strut.rod.length is 20 m"),
    "a tonne": (dict(payload=pf.Payload(1000)), "Payload.mass is 1000 kg, on a platform of 4.5.* give 1 kg"),
}  # fmt: skip


@pytest.mark.parametrize("name", HARDLY_MEANT)
def test_what_is_hardly_meant_is_doubted_once(name):
    changes, words = HARDLY_MEANT[name]
    with pytest.warns(pf.ImplausibleValue, match=words) as caught:
        pf.robots.hexapod(**SKETCH | changes)
    assert len(caught) == 1
    assert caught[0].filename == __file__


def test_advice_about_the_offset_works():
    lifted = replace(DISC, nodes=DISC.nodes + [0, 0, 0.01])
    robot = pf.robots.hexapod(**SKETCH, platform=lifted, platform_offset=0.01)
    assert robot.home_pose[0][2] == pytest.approx(0.29)


def test_default_strut_and_disc_hold_themselves():
    model = pf.Model(pf.robots.hexapod(**SKETCH), "numpy")
    assert model.mobility(model.robot.home).freedoms == 6
    forces = model.equilibrium(*model.robot.home_pose)[1]
    body = model.robot.platform.moments.m
    # each holds a sixth of the platform, and its own rod, along its axis; the cylinder and rod lean on both
    assert np.allclose(forces, forces[0])
    assert 0.9 < 6 * forces[0] * (0.3 / 0.34285) / (9.81 * body) < 1.4
    assert random_forces(model, 1, 1).shape == (1, 6)
