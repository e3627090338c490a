"""Beams against clouds of points and closed solutions of bending, stretching, twisting, buckling; misuse."""

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq

import parflex as pf
from measures import relative
from parflex.robot.modal import modal_mass

END = np.array([0.3, -0.4, 0.5])
STEEL = dict(young=205e9, poisson=0.29, density=7850.0)
TUBE = dict(outer=0.05, inner=0.04, **STEEL)
LENGTH = np.linalg.norm(END)
T = END / LENGTH
ALONG = np.outer(T, T)
ACROSS = np.eye(3) - ALONG
AREA, SECOND = np.pi / 4 * (0.05**2 - 0.04**2), np.pi / 64 * (0.05**4 - 0.04**4)
EA, EI, GJ = 205e9 * AREA, 205e9 * SECOND, 205e9 / 2 / 1.29 * 2 * SECOND
MANY = pf.beam(END, **TUBE, bending=2, axial=2, torsion=2, static=True, damping_ratio=0.01)


def bending(xi):
    """Sines less their tangents, ξ² and ξ³, and their slopes by ξ."""
    k = np.pi * np.array([1, 2])[:, None]
    value = [*(np.sin(k * xi) - k * xi), xi**2, xi**3]
    return np.array(value), np.array([*(k * np.cos(k * xi) - k), 2 * xi, 3 * xi**2])


def stretching(xi):
    """ξ and a quarter of a sine, and their slopes by ξ."""
    return np.array([xi, np.sin(np.pi / 2 * xi)]), np.array([0 * xi + 1, np.pi / 2 * np.cos(np.pi / 2 * xi)])


def continued(body, xi):
    """Displacements, rotations and slopes (N, P, 3) of the axis at ξ (P,), by the functions that the shapes
    at its nodes are combinations of."""
    at = np.linspace(0, 1, len(body.nodes))

    def fitted(functions, values):
        by_node = np.moveaxis(values, 1, 0).reshape(len(at), -1)
        parts = np.linalg.lstsq(functions(at)[0].T, by_node)[0]
        return [np.moveaxis((f.T @ parts).reshape(len(xi), -1, 3), 0, 1) for f in functions(xi)]

    w, slope = fitted(bending, body.shapes @ ACROSS)
    u, twist = (fitted(stretching, x @ ALONG)[0] for x in (body.shapes, body.rotation_shapes))
    return w + u, np.cross(T, slope / LENGTH) + twist, slope / LENGTH


def halves(count):
    """The places ξ (2 count,) of two points in each of so many slices that have a slice's second moment."""
    middles = (np.arange(count) + 0.5) / count
    return np.concatenate([middles - 1 / count / np.sqrt(12), middles + 1 / count / np.sqrt(12)])


def test_its_integrals_are_sums_over_a_cloud():
    """Four points in each of 2 × 1200 sections, on a radius with the section's second moment."""
    xi = halves(1200)
    phi, psi, _ = continued(MANY, xi)
    radius = np.sqrt(2 * SECOND / AREA)
    u = np.cross(T, [0, 0, 1.0]) / np.linalg.norm(np.cross(T, [0, 0, 1.0]))
    arms = radius * np.array([u, -u, np.cross(T, u), -np.cross(T, u)])
    r = (xi[:, None, None] * END + arms).reshape(-1, 3)
    Phi = (phi[:, :, None] + np.cross(psi[:, :, None], arms)).reshape(MANY.modes, -1, 3)
    dm = 7850 * AREA * LENGTH / len(r)
    found = MANY.moments
    expected = {
        "m": 7850 * AREA * LENGTH,
        "MS0": dm * np.sum(r, axis=0),
        "P0": dm * r.T @ r,
        "S": dm * np.sum(Phi, axis=1).T,
        "P1": dm * np.einsum("kpa,pb->kab", Phi, r),
        "P2": dm * np.einsum("kpa,jpb->kjab", Phi, Phi, optimize=True),
    }
    for name, value in expected.items():
        assert relative(getattr(found, name), value) <= 1e-9, name


def test_its_modes_are_normal():
    assert np.array_equal(MANY.m_ee, np.eye(MANY.modes))
    assert np.max(np.abs(modal_mass(MANY.moments) - np.eye(MANY.modes))) < 1e-12
    assert MANY.damping == pytest.approx(2 * 0.01 * MANY.frequencies)


def test_foreshortening_is_the_integral_of_the_slopes():
    """Sums over 2 × 400 points; a stretched or a twisted beam does not come nearer."""
    slope = continued(MANY, halves(400))[2]
    drawn = np.einsum("kpa,lpa->kl", slope, slope) * LENGTH / slope.shape[1]
    assert MANY.foreshortening.shape == (1, 3, MANY.modes, MANY.modes)
    assert relative(MANY.foreshortening[0] / np.max(drawn), -T[:, None, None] * drawn / np.max(drawn)) <= 1e-9
    assert pf.beam(END, **TUBE, foreshortening=False).foreshortening is None


def test_a_force_and_a_moment_at_the_end_bend_it_as_a_cantilever():
    """F ℓ³/3EI + M ℓ²/2EI and F ℓ²/2EI + M ℓ/EI, F ℓ/EA along it, M ℓ/GJ about it; by K alone."""
    F, N = np.array([100.0, -20.0, 50.0]), np.array([3.0, 7.0, -2.0])
    Phi, turns = MANY.attachment_shapes[0], MANY.attachment_turns[0]
    q = (Phi.T @ F + turns.T @ N) / MANY.stiffness
    moved = ACROSS @ F * LENGTH**3 / (3 * EI) + np.cross(ACROSS @ N, T) * LENGTH**2 / (2 * EI)
    moved += ALONG @ F * LENGTH / EA
    turned = np.cross(T, ACROSS @ F) * LENGTH**2 / (2 * EI) + ACROSS @ N * LENGTH / EI
    turned += ALONG @ N * LENGTH / GJ
    assert relative(Phi @ q / np.max(np.abs(moved)), moved / np.max(np.abs(moved))) <= 1e-10
    assert relative(turns @ q / np.max(np.abs(turned)), turned / np.max(np.abs(turned))) <= 1e-10


@pytest.mark.parametrize(("count", "bound"), [(1, 1e-3), (2, 1e-4), (3, 1e-7)])
@pytest.mark.parametrize("kind", ["axial", "torsion"])
def test_a_bar_with_a_body_at_its_end(kind, count, bound):
    """A body of five times the bar's mass, or inertia about it: β tan β = 1/5, ω = β/ℓ √(E/ρ) or √(G/ρ)."""
    body = pf.beam(END, **TUBE, **{"bending": 0, kind: count})
    shape = (body.attachment_shapes if kind == "axial" else body.attachment_turns)[0].T @ T
    tip = 5 * 7850 * LENGTH * (AREA if kind == "axial" else 2 * SECOND)
    found = np.sqrt(eigh(np.diag(body.stiffness), body.m_ee + tip * np.outer(shape, shape))[0][0])
    beta = brentq(lambda x: x * np.tan(x) - 0.2, 1e-3, 1.5)
    modulus = 205e9 if kind == "axial" else 205e9 / 2 / 1.29
    assert abs(found / (beta / LENGTH * np.sqrt(modulus / 7850)) - 1) <= bound


@pytest.mark.parametrize("n", [1, 2, 3])
def test_a_strut_between_joints(n):
    """The frequencies 1 … n of a bar that turns about its origin and whose end is held, against Euler and
    Bernoulli's with rotary inertia, (kπ/ℓ)² √(EI/(ρA (1 + (kπ/ℓ)² I/A)))."""
    body = pf.beam((0, 0, 0.62), 0.032, **STEEL, bending=n)
    mass, stiffness = about_its_origin(body)
    k = np.pi * np.arange(1, n + 1) / 0.62
    second_by_area = 0.032**2 / 16
    expected = k**2 * np.sqrt(205e9 / 7850 * second_by_area / (1 + k**2 * second_by_area))
    found = np.sqrt(eigh(stiffness, mass)[0])
    assert np.max(np.abs(found / expected - 1)) <= 5e-4


def about_its_origin(body):
    """Mass and stiffness (n, n) in the plane of x and z of a bar along z whose end is held in x: the turn
    about y follows from its modes."""
    m, modes = body.moments, np.abs(body.shapes[:, -1, 0]) > 0
    turn = -body.shapes[modes, -1, 0] / body.nodes[-1, 2]
    M_re = (m.P1[:, 0, 2] - m.P1[:, 2, 0])[modes]  # ∫ (r × Φ)_y
    inertia = m.P0[0, 0] + m.P0[2, 2]
    mass = np.eye(len(turn)) + np.outer(turn, M_re) + np.outer(M_re, turn) + inertia * np.outer(turn, turn)
    return mass, np.diag(body.stiffness[modes])


def test_a_strut_buckles_under_eulers_load():
    """One shape, hinged at both ends: the end comes nearer by ½ ℓ q² + q Φ e − ½ eᵀHe with q = −Φ e/ℓ."""
    body = pf.beam((0, 0, 0.62), 0.032, **STEEL)
    phi, H = body.shapes[0, -1, 0], body.foreshortening[0, 2, 0, 0]
    nearer = -(phi**2) / (2 * 0.62) - H / 2
    critical = body.stiffness[0] / 2 / nearer
    assert critical == pytest.approx(np.pi**2 * 205e9 * np.pi / 64 * 0.032**4 / 0.62**2, rel=1e-12)


def test_as_many_shapes_as_its_nodes_carry_are_normal():
    body = pf.beam(END, **TUBE, bending=16, axial=16, torsion=16, static=True)
    assert np.max(np.abs(modal_mass(body.moments) - np.eye(body.modes))) < 1e-11
    assert np.all(body.shapes[:, 0] == 0)
    assert np.all(body.rotation_shapes[:, 0] == 0)


def test_without_shapes_it_is_rigid():
    joint = pf.Joint(0, 0, body=pf.beam(END, **TUBE, bending=0))
    assert joint.body.modes == 0
    assert joint.mass == pytest.approx(7850 * AREA * LENGTH)
    leg = pf.Leg(np.eye(3), np.zeros(3), (joint,), (pf.Tip(1, END),))
    assert leg.seats.tips == (0,)


def test_with_fewer_modes_or_a_payload_it_is_no_beam():
    """Its numbers are then no longer those that its dimensions give: parameters must not take it for one."""
    assert type(MANY.with_modes([0, 2])) is pf.FlexibleBody
    heavier = MANY.with_payload(32, 0.5)
    assert type(heavier) is pf.FlexibleBody
    assert heavier.moments.m == MANY.moments.m + 0.5
    assert np.array_equal(heavier.foreshortening, MANY.foreshortening)


SLIPS = {
    "a thickness in mm": (
        dict(outer=32),
        r'outer is 32 m, of a beam .* 0.7071 m long; .* give 0.032 m, .* "32 mm"',
    ),
    "a modulus in GPa": (dict(young=205), 'young is 205 Pa, less than any .*; did you mean "205 GPa"?'),
}


@pytest.mark.parametrize("name", SLIPS)
def test_what_is_hardly_meant_is_doubted_once(name):
    given, words = SLIPS[name]
    with pytest.warns(pf.ImplausibleValue, match=words) as caught:
        pf.beam(**{"end": END} | TUBE | given)
    assert len(caught) == 1


MISUSE = {
    "a wall of nothing": (dict(inner=0.05), r"Beam.inner is 0.05; it must be less than outer, which is 0.05"),
    "no length": (dict(end=(0, 0, 0)), r"Beam.end is \[0.0, 0.0, 0.0\], where the beam begins; give"),
    "no plane": (dict(end=(0, 1)), "Beam.end has shape"),
    "poisson": (dict(poisson=0.5), "poisson is 0.5; it must lie between -1 and 0.5"),
    "no modulus": (dict(young=0), "Beam.young is 0.0; it must be positive"),
    "weightless": (dict(density=0), "Beam.density is 0.0; it must be positive"),
    "too many": (dict(bending=17), "Beam.bending is 17, but the 33 nodes of a beam carry 16 shapes"),
    "too many along": (dict(axial=40), "Beam.axial is 40, but the 33 nodes"),
    "half a shape": (dict(torsion=0.5), "Beam.torsion is 0.5; it must be a whole number"),
    "no flag": (dict(static=1), "Beam.static is 1; give True or False"),
    "negative damping": (dict(damping_ratio=-0.1), "Beam.damping_ratio is -0.1; it cannot be negative"),
    "a hair": (dict(outer=1e-200, inner=0), "Beam.outer is 1e-200, of no body there is; give it in SI"),
    "a planet": (dict(density=1e30), r"Beam.density is 1e\+30, of no body there is; give it in SI"),
    "damping of others": (dict(damping_ratio=[0.1] * 3), "Beam.damping_ratio has 3 entries; give one for"),
}  # fmt: skip


@pytest.mark.parametrize("name", MISUSE)
def test_misuse_is_told_in_a_sentence(name):
    given, words = MISUSE[name]
    with pytest.raises(pf.InputError, match=words):
        pf.beam(**{"end": END} | TUBE | given)
