"""Struts between joints: their frequencies against Rayleigh's closed form, and their flexures' moments."""

from dataclasses import replace

import numpy as np
import pytest

import parflex as pf
from parflex.analysis.small_motions import allowed, slopes
from parflex.base.array import skew
from parflex.base.dual import jacobian
from parflex.base.spatial import rotation_from_vector
from parflex.mechanics import flexures
from parflex.model.core import core_of
from parts import INNER, LENGTH, OUTER, STEEL, step_tube

AREA = np.pi / 4 * (OUTER**2 - INNER**2)
SECOND = np.pi / 64 * (OUTER**4 - INNER**4)
BUCKLING = np.pi**2 * STEEL["young"] * SECOND / LENGTH**2  # Euler's load, N


def pinned(k: int) -> float:
    """ω_k (rad/s) of a beam between two ball joints, rotary inertia included (Rayleigh)."""
    wave = k * np.pi / LENGTH
    bending = STEEL["young"] * SECOND * wave**4
    return float(np.sqrt(bending / (STEEL["density"] * (AREA + SECOND * wave**2))))


def held_strut(foreshortening: bool = True, **shapes: int) -> pf.Robot:
    """A beam that is held as `held` says."""
    return held(pf.beam((0, 0, LENGTH), OUTER, INNER, **STEEL, **shapes, foreshortening=foreshortening))


def held(beam: pf.FlexibleBody) -> pf.Robot:
    """A strut on a universal joint under a platform that three posts hold: its slider loads it axially."""
    quarter = np.pi / 2
    joints = (
        pf.Joint(0, 0, alpha=-quarter),
        pf.Joint(1, 0, alpha=quarter),
        pf.Joint(2, 1, 1, alpha=quarter, body=beam),
    )
    strut = pf.Leg(np.eye(3), (0, 0, 0), joints, (pf.Tip(3, (0, 0, LENGTH), 0),))
    corners = [(0.2, 0, LENGTH), (-0.1, 0.2, LENGTH), (-0.1, -0.2, LENGTH)]
    posts = [pf.Leg(np.eye(3), p, (), (pf.Tip(0, (0, 0, 0), i),)) for i, p in enumerate(corners, start=1)]
    places = [(0.0, 0.0, 0.0), *(np.subtract(p, (0, 0, LENGTH)) for p in corners)]
    platform = pf.FlexibleBody.rigid(10.0, (0, 0, 0), np.eye(3), places)
    return pf.Robot([strut, *posts], platform, (0, 0, 0), ((0, 0, LENGTH), np.eye(3)))


def frequencies(robot: pf.Robot, push: float = 0.0) -> np.ndarray:
    """Frequencies (rad/s) about home under a force of the slider, by differences of the direct model."""
    core = core_of(pf.Model(robot, "numpy"))
    x = core.flat(robot.home)
    T = allowed(core.mechanism, x)
    K, _ = slopes(core.functions, x, T, lambda states: np.array([push]))
    return np.sqrt(np.sort(np.linalg.eigvals(-K).real))


@pytest.mark.parametrize("n", [1, 2, 3])
def test_bending_shapes_have_the_first_frequencies(n):
    """Two planes each; sines less their tangents come back to sines where both ends turn freely."""
    found = frequencies(held_strut(bending=n))
    assert len(found) == 2 * n
    for k in range(n):
        assert found[2 * k : 2 * k + 2] == pytest.approx(pinned(k + 1), rel=5e-4)


@pytest.mark.parametrize("part", [-0.2, 0.2, 0.5])
def test_an_axial_load_softens(part):
    """ω² falls as 1 − P/P_cr under compression, and rises under tension."""
    robot = held_strut(bending=1)
    unloaded, loaded = frequencies(robot), frequencies(robot, push=part * BUCKLING)
    assert loaded**2 / unloaded**2 == pytest.approx(1 - part, rel=1e-3)


@pytest.mark.parametrize("part", [0.0, 0.2, 0.5])
def test_an_axial_load_softens_a_tube_from_step(part):
    """Its geometric stiffness, by closed form: ω² = ω_1² (1/(1 + s) − P/P_cr) with the shear s = π² E I/(κ
    G A ℓ²) of 1.3 % (Engesser 1891; Cowper's κ). It is rigid along itself, so that it is loaded at home."""
    nu = STEEL["poisson"]
    kappa, shear = 2 * (1 + nu) / (4 + 3 * nu), STEEL["young"] / (2 + 2 * nu)
    s = np.pi**2 * STEEL["young"] * SECOND / (kappa * shear * AREA * LENGTH**2)
    found = frequencies(held(step_tube(negligible=1e-3)), push=part * BUCKLING)[:2]
    assert found == pytest.approx([pinned(1) * np.sqrt(1 / (1 + s) - part)] * 2, rel=1e-3)
    beam = frequencies(held_strut(bending=2, static=True), push=part * BUCKLING)[:2]
    assert found == pytest.approx(beam * np.sqrt((1 / (1 + s) - part) / (1 - part)), rel=1e-3)


def test_without_foreshortening_it_would_stiffen():
    """Fact: the effect then has the wrong sign, 1.40 at a fifth of Euler's load where 0.80 is right."""
    robot = held_strut(bending=1, foreshortening=False)
    ratio = frequencies(robot, push=0.2 * BUCKLING) ** 2 / frequencies(robot) ** 2
    assert ratio == pytest.approx(1.40, abs=0.01)


@pytest.mark.parametrize("angle", [0.1, 0.5, 1.0, 2.0])
def test_flexure_moments_are_the_gradient_of_their_energy(angle):
    """By automatic differentiation of ½ θᵀ K θ under small turns of the platform's section, for a spring of
    any principal axes, up to 2 rad from rest."""
    rng = np.random.default_rng(4)
    M, axis = rng.normal(size=(3, 3)), rng.normal(size=3)
    turn, rest = (rotation_from_vector(rng.normal(size=3)) for _ in range(2))
    leg = turn @ rotation_from_vector(angle * axis / np.linalg.norm(axis)) @ rest
    spring = pf.Flexure(M @ M.T, rest=rest)
    tables = flexures.flexures_of(pf.Leg(np.eye(3), (0, 0, 0), (), (pf.Tip(0, flexure=spring),)))

    def energy(delta: np.ndarray) -> np.ndarray:
        section = turn @ (np.eye(3) + skew(delta) + 0.5 * skew(delta) @ skew(delta))
        return flexures.energy(
            tables, flexures.bent_angle(flexures.from_rest(tables, section[..., None, None, :, :], leg[None]))
        )

    gradient = jacobian(energy, np.zeros((1, 3)))[0, 0]
    theta = flexures.bent_angle(flexures.from_rest(tables, turn[None, None], leg[None, None]))
    found = flexures.moments(tables, theta, np.zeros((1, 1, 3)))[0, 0]
    assert found == pytest.approx(-gradient, rel=0, abs=1e-10 * np.max(np.abs(gradient)))


@pytest.mark.filterwarnings("ignore:density is:parflex.ImplausibleValue")
def test_stiffness_on_axially_elastic_struts():
    """K = Jᵀ k J of a platform on six struts of fixed length, k = E A / ℓ each: by the exact Jacobian of the
    direct model, the struts without mass to speak of."""
    robot, J, k = on_six_struts()
    model = pf.Model(robot, "numpy")
    mechanism = core_of(model).mechanism
    by_state = model.direct_jacobian(robot.home, np.zeros(0)).state
    T = allowed(mechanism, core_of(model).flat(robot.home))
    follow = T[6:][mechanism.kept] @ np.linalg.inv(T[:6])  # of the struts' coordinates, with the platform's
    motions = mechanism.layout.motions
    slopes_by_pose = by_state[:, :6] + by_state[:, motions.joints] @ follow
    mass = np.diag([MASS] * 3 + [INERTIA] * 3)
    assert -mass @ slopes_by_pose == pytest.approx(J.T @ (k[:, None] * J), rel=0, abs=1e-9 * np.max(k))


MASS, INERTIA, TOP = 10.0, 0.3, 0.6


def on_six_struts() -> tuple[pf.Robot, np.ndarray, np.ndarray]:
    """A rigid platform on six struts without motors; J (6, 6) of their lengths, and their stiffness (6,)."""

    def ring(radius: float, height: float, *angles: float) -> np.ndarray:
        at = np.deg2rad(angles)
        return np.stack([radius * np.cos(at), radius * np.sin(at), 0 * at + height], axis=1)

    feet = ring(0.5, 0.0, 10, 110, 130, 230, 250, 350)
    heads = ring(0.3, TOP, 50, 70, 170, 190, 290, 310)
    material = STEEL | {"density": 1e-7}
    legs, rows, k = [], [], []
    for i, (foot, head) in enumerate(zip(feet, heads, strict=True)):
        length = np.linalg.norm(head - foot)
        n = (head - foot) / length
        up = np.cross(n, (1.0, 0.0, 0.0))
        up /= np.linalg.norm(up)
        beam = pf.beam((length, 0, 0), 0.01, **material, bending=0, axial=1)
        joints = (pf.Joint(0, 0), pf.Joint(1, 0, alpha=np.pi / 2, body=beam))
        axes = np.stack([n, np.cross(up, n), up], axis=1)
        legs.append(pf.Leg(axes, foot, joints, (pf.Tip(2, (length, 0, 0), i),)))
        rows.append([*n, *np.cross(head - (0, 0, TOP), n)])
        k.append(STEEL["young"] * np.pi / 4 * 0.01**2 / length)
    platform = pf.FlexibleBody.rigid(MASS, (0, 0, 0), INERTIA * np.eye(3), heads - (0, 0, TOP))
    return pf.Robot(legs, platform, (0, 0, 0), ((0, 0, TOP), np.eye(3))), np.array(rows), np.array(k)


def test_a_flexure_that_is_turned_about_is_refused():
    """Within 5 degrees of half a turn; before that the moment is what the formula says."""
    robot = held_strut(bending=1)
    leg = robot.legs[0]
    for degrees, fine in ((170.0, True), (176.0, False), (179.9, False)):
        rest = rotation_from_vector(np.deg2rad([degrees, 0.0, 0.0]))
        tip = replace(leg.tips[0], flexure=pf.Flexure(np.eye(3), rest=rest))
        turned = pf.Model(replace(robot, legs=(replace(leg, tips=(tip,)), *robot.legs[1:])), "numpy")
        if fine:
            turned.direct(robot.home, [0.0])
        else:
            with pytest.raises(pf.InputError, match="5 degrees of half a turn"):
                turned.direct(robot.home, [0.0])


def test_stiff_legs_tend_to_rigid_ones():
    """Forces and accelerations of legs that bend statically come near to those of the same robot with rigid
    links as one over their stiffness."""
    beams = [pf.beam(end, 0.08, 0.068, **STEEL, static=True, axial=1) for end in ((0, -0.7, 0), (0, 0, 0.62))]
    rigid = [stiffened(body, np.inf) for body in beams]
    target, apart = np.array([1.0, -2.0, 0.5, 3.0, -1.0, 2.0]), []
    exact = pf.Model(with_links(rigid), "numpy")
    state = replace(exact.robot.home, twist=(0.1, -0.2, 0.1, 0.3, 0.1, -0.2))
    wanted = exact.inverse(state, target).forces
    for factor in (1e2, 1e4, 1e6):
        soft = pf.Model(with_links([stiffened(body, factor) for body in beams]), "numpy")
        found = soft.inverse(state, target, legs="static").forces
        apart.append(float(np.max(np.abs(found - wanted))))
    assert apart[0] / apart[1] == pytest.approx(100, rel=0.05)
    assert apart[1] / apart[2] == pytest.approx(100, rel=0.05)


def stiffened(body: pf.FlexibleBody, factor: float) -> dict:
    """The fields of a joint whose link is a body so much stiffer, or rigid."""
    if np.isfinite(factor):
        return {
            "M": 0.0,
            "MS": np.zeros(3),
            "I": np.zeros((3, 3)),
            "body": replace(body, stiffness=factor * body.stiffness),
        }
    t = body.moments
    return {"M": t.m, "MS": t.MS0, "I": np.trace(t.P0) * np.eye(3) - t.P0}


def with_links(links: list[dict]) -> pf.Robot:
    """The paper's robot with other cylinders and rods."""
    robot, legs = pf.robots.gough_stewart(modes=3), []
    for i, leg in enumerate(robot.legs):
        joints = (
            leg.joints[0],
            *(replace(j, **fields) for j, fields in zip(leg.joints[1:], links, strict=True)),
        )
        legs.append(replace(leg, joints=joints, tips=(pf.Tip(3, (0, 0, 0.62), i),), posture=None))
    return replace(robot, legs=tuple(legs))
