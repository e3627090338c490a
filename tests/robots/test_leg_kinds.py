"""Legs by physical fields: their rows against the gallery's, written by hand; any direction of an axis."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import parflex as pf
from measures import relative
from oracle import screw
from parflex.mechanics.legs import ALL_LEG_TYPES
from parflex.robots import delta, gough_stewart, prs3, rus6
from parflex.robots.legs import ALL_LEG_KINDS, PRS, PUS, RPS, RUS, UPS, DeltaArm
from parflex.robots.legs.base import towards
from parflex.robots.links import box, tube

STEEL = 7850.0
TUBE = pf.Bar(outer=0.06, inner=0.048, length=0.4, density=STEEL)
ROD = pf.Bar(outer=0.02, length=0.5, density=STEEL)
MADE = (
    UPS(TUBE, ROD),
    RPS(TUBE, ROD),
    RUS(crank=TUBE, rod=ROD),
    PUS(carriage=2.0, rod=ROD),
    PRS(carriage=2.0, rod=ROD),
    DeltaArm(arm=TUBE, rod=ROD, spacing=0.1),
)
DIRECTIONS = np.concatenate([np.eye(3), -np.eye(3), np.random.default_rng(3).normal(size=(5, 3))])


def geometry(joints):
    """The rows without what the links weigh."""
    names = ("antecedent", "sigma", "mu", "gamma", "b", "alpha", "d", "theta", "r")
    return [[getattr(joint, name) for name in names] for joint in joints]


BY_HAND = {
    "RUS": (RUS(crank=pf.Bar(mass=1, length=0.2), rod=pf.Bar(mass=1, length=0.6)), rus6()),
    "PRS": (PRS(carriage=1.0, rod=pf.Bar(mass=1, length=0.45)), prs3()),
    "Delta": (
        DeltaArm(arm=pf.Bar(mass=1, length=0.35), rod=pf.Bar(mass=1, length=0.8), spacing=0.15),
        delta(),
    ),
    "UPS": (UPS(TUBE, ROD), gough_stewart()),
}


@pytest.mark.parametrize("name", BY_HAND)
def test_rows_are_those_of_the_gallery(name):
    """By their default directions, to the bit."""
    kind, robot = BY_HAND[name]
    assert geometry(kind.joints) == geometry(robot.legs[0].joints)
    for mine, theirs in zip(kind.tips, robot.legs[0].tips, strict=True):
        assert (mine.frame, *mine.offset) == (theirs.frame, *theirs.offset)


def test_links_are_bars():
    """Masses, first moments and inertias about the frames, against tubes from point to point."""
    cylinder = tube(STEEL, 0.03, (0, 0, 0), (0, -0.4, 0), bore=0.024)
    rod = tube(STEEL, 0.01, (0, 0, -0.5), (0, 0, 0))
    arm = tube(STEEL, 0.03, (0, 0, 0), (0.4, 0, 0), bore=0.024)
    limb = tube(STEEL, 0.01, (0, 0, 0), (0.5, 0, 0))
    nothing = box(0.0, (1, 1, 1))
    expected = (
        (nothing, cylinder, rod),
        (cylinder, rod),
        (arm, nothing, limb),
        ({"M": 2.0} | {name: nothing[name] for name in ("MS", "I")}, nothing, limb),
        ({"M": 2.0} | {name: nothing[name] for name in ("MS", "I")}, limb),
        (arm, nothing, limb, nothing, limb),
    )
    for kind, links in zip(MADE, expected, strict=True):
        for joint, link in zip(kind.joints, links, strict=True):
            for name, value in link.items():
                assert relative(getattr(joint, name), value) < 1e-15, kind.word


BENT = {"young": 205e9, "bending": 1, "axial": 1}


def bent(kind):
    """The kind with bars that bend."""
    bars = {name: bar for name, bar in vars(kind).items() if isinstance(bar, pf.Bar)}
    return replace(kind, **{name: replace(bar, **BENT) for name, bar in bars.items()})


def weighed(kind, q):
    """Mass, first and second moments of all links, and the tips (t, 3), in Σ0i at joint values q (n,)."""
    frames, total = [np.eye(4)], np.zeros((4, 4))
    for joint, value in zip(kind.joints, q, strict=True):
        theta, r = joint.theta + value * (1 - joint.sigma), joint.r + value * joint.sigma
        row = screw(2, joint.gamma, joint.b) @ screw(0, joint.alpha, joint.d) @ screw(2, theta, r)
        frames.append(frames[joint.antecedent] @ row)
        body, second = joint.body, 0.5 * np.trace(joint.I) * np.eye(3) - joint.I
        m, first = joint.M, np.asarray(joint.MS)
        if body is not None:
            m, first, second = body.moments.m, body.moments.MS0, body.moments.P0
        here = np.block([[second, first[:, None]], [first, m]])
        total += frames[-1] @ here @ frames[-1].T
    return total, np.array([(frames[tip.frame] @ [*tip.offset, 1])[:3] for tip in kind.tips])


@pytest.mark.parametrize("kind", MADE, ids=lambda kind: kind.word)
def test_bars_that_bend_are_where_rigid_ones_are(kind):
    """Unbent they have the masses, moments and tips of rigid ones at any joint values, and each sits on the
    end of the one before."""
    q = np.random.default_rng(1).uniform(0.2, 1, len(kind.joints))
    for found, expected in zip(weighed(bent(kind), q), weighed(kind, q), strict=True):
        assert relative(found, expected) < 1e-14
    leg = bent(kind).placed(np.eye(3), (0, 0, 0), range(len(kind.tips)))
    bodies = [joint.body is not None for joint in leg.joints]
    assert sum(bodies) == sum(joint.M > 0 for joint in kind.joints) - ("carriage" in vars(kind))
    on_bodies = [joint.antecedent > 0 and bodies[joint.antecedent - 1] for joint in leg.joints]
    assert leg.seats.joints == tuple(0 if there else -1 for there in on_bodies)
    assert leg.seats.tips == (0,) * len(kind.tips)


def test_every_kind_is_tried_here():
    assert tuple(type(kind) for kind in MADE) == ALL_LEG_KINDS


@pytest.mark.parametrize("kind", MADE, ids=lambda kind: kind.word)
def test_kinds_have_closed_forms(kind):
    for each in (kind, bent(kind)):
        leg = each.placed(np.eye(3), (0, 0, 0), range(len(kind.tips)))
        [*closed, _] = ALL_LEG_TYPES
        assert [known for known in closed if known.recognises(leg)]


@pytest.mark.parametrize("axis", DIRECTIONS, ids=str)
def test_an_axis_points_where_it_is_told_to(axis):
    """Rot(z, γ) Rot(x, α) takes z there, and leaves x level."""
    row = {"gamma": 0.0} | towards(axis, "axis")
    turned = Rotation.from_euler("ZX", [row["gamma"], row["alpha"]]).as_matrix()
    assert np.allclose(turned[:, 2], axis / np.linalg.norm(axis), atol=1e-15)
    assert abs(turned[2, 0]) < 1e-15
    assert -np.pi / 2 < row["gamma"] <= np.pi / 2


def test_the_drive_is_at_the_actuated_joint():
    limits = {"stroke": (0.2, 0.3), "stiffness": 5.0, "rest": 0.25, "damping": 2.0, "rotor_inertia": 1.5}
    for kind in (
        RPS(TUBE, ROD, **limits),
        PUS(carriage=1, rod=ROD, **limits),
        RUS(crank=TUBE, rod=ROD, **limits),
    ):
        [joint] = [joint for joint in kind.joints if joint.mu]
        assert (joint.q_min, joint.q_max, joint.k, joint.q_0, joint.Fv, joint.IA) == (
            0.2,
            0.3,
            5,
            0.25,
            2,
            1.5,
        )


MISUSE = {
    "no direction": (lambda: UPS(TUBE, ROD, axis=(0, 0, 0)).joints, r"UPS.axis is \[0.0, 0.0, 0.0\]; give a"),
    "no length": (
        lambda: RUS(crank=TUBE, rod=pf.Bar(mass=1, com=0.1, inertia=(0, 0.1))).tips,
        "rod.length is missing; give the distance between its joints",
    ),
    "a bar of nothing": (lambda: PUS(carriage=1, rod=1.5), "PUS.rod is float; expected a Bar"),
    "no spacing": (lambda: DeltaArm(arm=TUBE, rod=ROD, spacing=0), "DeltaArm.spacing is 0.0; it must be"),
}


@pytest.mark.parametrize("name", MISUSE)
def test_misuse_is_told_in_a_sentence(name):
    make, words = MISUSE[name]
    with pytest.raises(pf.InputError, match=words):
        make()
