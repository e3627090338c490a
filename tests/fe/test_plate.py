"""Plate modes against published, converged and analytic values."""

import warnings

import numpy as np
import pytest

import parflex as pf
from paper_robot import PLATE, TABLE_2, corners
from parflex.fe.plate.argyris import argyris
from parflex.fe.plate.mesh import unknowns
from parflex.mechanics.platform import body_energies, platform_of

# Converged Kirchhoff values with rotary inertia for the paper's plate, ν = 0.3: elastic modes 1, 3,
# 4, 5, 6, 8, 10 (rad/s), from Morley and Argyris elements refined until the sixth digit stood.
CONVERGED = {1: 189.196, 3: 316.176, 4: 403.891, 5: 476.578, 6: 704.391, 8: 760.255, 10: 1194.75}

# Free square plate, ν = 0.3, ω a² √(ρh/D), converged; Leissa's Ritz values of 1973 lie up to 1 %
# above (J. Sound Vib. 31, p. 257: 13.489, 19.789, 24.432, 35.024).
SQUARE = (13.4682, 19.5961, 24.2702, 34.8009, 34.8009)


@pytest.fixture(scope="module")
def hexagon():
    return pf.fe.plate_modes(corners(), n_modes=11, **PLATE)


def test_frequencies_are_the_converged_ones(hexagon):
    """≤ 0.1 % at the default mesh."""
    for mode, omega in CONVERGED.items():
        assert abs(hexagon.frequencies[mode - 1] / omega - 1) <= 1e-3


def test_table_2_is_met_as_far_as_it_is_converged(hexagon):
    """Modes 1–5 within 1 %, 6–7 within 1.5 %; 8–10 lie 8–9 % below the printed values."""
    difference = hexagon.frequencies[:10] / np.array(TABLE_2) - 1
    assert np.all(np.abs(difference[:5]) <= 0.01)
    assert np.all(np.abs(difference[5:7]) <= 0.015)
    assert np.all((difference[7:] <= -0.08) & (difference[7:] >= -0.09))


def test_thin_square_plate():
    """≤ 0.1 % of the converged values; thin, so that rotary inertia is nothing."""
    a, h, E, rho, nu = 1.0, 1e-3, 7e10, 2700.0, 0.3
    square = [(0, 0), (a, 0), (a, a), (0, a)]
    found = pf.fe.plate_modes(square, h, E, nu, rho, n_modes=5).frequencies
    D = E * h**3 / (12 * (1 - nu**2))
    factors = found * a**2 * np.sqrt(rho * h / D)
    assert np.max(np.abs(factors / SQUARE - 1)) <= 1e-3


@pytest.mark.slow
def test_error_estimate_bounds_the_error():
    """At each mesh the estimate is above the difference from a mesh two refinements finer."""
    best = pf.fe.plate_modes(corners(), n_modes=9, refine=4, **PLATE).frequencies
    for refine in (1, 2):
        found = pf.fe.plate_modes(corners(), n_modes=9, refine=refine, **PLATE)
        error = found.frequencies / best - 1
        assert np.all(error > -1e-6)  # Ritz: from above
        assert np.all(found.frequency_error >= error)
        assert np.all(found.frequency_error <= 0.02)


def test_moments_of_free_modes(hexagon):
    """tr P2 = ΦᵀMΦ = 1, S = 0 and β = 0, all to 1e-9 of their scale."""
    m = hexagon.moments
    assert np.max(np.abs(np.trace(m.P2, axis1=2, axis2=3) - np.eye(11))) <= 1e-9
    assert np.max(np.abs(m.S)) <= 1e-9 * np.sqrt(m.m)
    beta = m.P1 - np.swapaxes(m.P1, 1, 2)
    assert np.max(np.abs(beta)) <= 1e-9 * np.sqrt(np.trace(m.P0))
    assert np.max(np.abs(m.P1[:, 2, :2])) > 1e-5  # not because P1 itself were nothing


def test_degenerate_pairs_are_rotations_of_cosines(hexagon):
    """Σ Φ Φᵀ over a pair at two corners is A cos m(θ_i − θ_j), whatever its orientation."""
    theta = np.radians(np.arange(-120, 181, 60))
    w = hexagon.shapes[:, list(hexagon.corners), 2]
    for pair, m, A in (((0, 1), 2, 0.0979), ((5, 6), 1, 0.1624)):
        product = sum(np.outer(w[k], w[k]) for k in pair)
        expected = A * np.cos(m * (theta[:, None] - theta))
        assert np.max(np.abs(product - expected)) <= 0.01 * A
    assert np.max(np.abs(w[4])) <= 1e-6 * np.max(np.abs(w))


def test_orientation_is_canonical(hexagon):
    """Of a pair, the first is largest and positive at the first corner, the second vanishes there."""
    first = hexagon.shapes[:, hexagon.corners[0], 2]
    w = np.abs(hexagon.shapes[:, list(hexagon.corners), 2])
    for a, b in ((0, 1), (5, 6), (7, 8), (9, 10)):
        assert first[a] > 0
        assert abs(first[b]) <= 1e-9
        assert first[a] >= w[a].max() - 1e-6  # equal ones elsewhere, by symmetry
    again = pf.fe.plate_modes(corners(), n_modes=11, **PLATE)
    assert np.array_equal(hexagon.shapes, again.shapes)
    finer = pf.fe.plate_modes(corners(), n_modes=11, refine=3, **PLATE)
    for k in range(11):
        assert hexagon.shapes[k, 20, 2] * finer.shapes[k, 20, 2] > 0 or abs(hexagon.shapes[k, 20, 2]) < 1e-3


def test_sense_of_rotation_is_of_no_account():
    """Corners clockwise and anticlockwise, the first corner kept: the same modes."""
    clockwise = np.roll(corners()[::-1], 1, axis=0)
    found = pf.fe.plate_modes(clockwise, n_modes=4, **PLATE)
    expected = pf.fe.plate_modes(corners(), n_modes=4, **PLATE)
    assert np.allclose(found.nodes, expected.nodes)
    assert np.allclose(found.frequencies, expected.frequencies, rtol=1e-9)


def test_shapes_and_slopes_belong_together():
    """Φ_r = (∂w/∂y, −∂w/∂x, 0): along edges, w changes by the trapezoid of its slope, whose error
    falls at least with the square of the edge."""
    errors = []
    for refine in (2, 3):
        found = pf.fe.plate_modes(corners(), n_modes=9, refine=refine, **PLATE)
        a, b = found.triangles[:, 0], found.triangles[:, 1]
        gap = (found.nodes[b] - found.nodes[a])[:, :2]
        slope = np.stack([-found.rotations[:, :, 1], found.rotations[:, :, 0]], axis=-1)
        trapezoid = 0.5 * np.sum((slope[:, a] + slope[:, b]) * gap, axis=-1)
        change = found.shapes[:, b, 2] - found.shapes[:, a, 2]
        errors.append(np.max(np.abs(change - trapezoid), axis=1))
    assert np.all(errors[1] < errors[0] / 4)


def test_mass_and_centre_of_any_polygon():
    """A right triangle: area, centroid and second moments of the textbook."""
    a, b, rho, h = 0.6, 0.4, 1000.0, 0.01
    moments = pf.fe.plate_modes([(0, 0), (a, 0), (0, b)], h, 1e10, 0.3, rho, n_modes=1).moments
    m = rho * h * a * b / 2
    assert abs(moments.m - m) <= 1e-12 * m
    assert np.allclose(moments.MS0 / m, [a / 3, b / 3, 0], atol=1e-12)
    second = [[a * a / 6, a * b / 12, 0], [a * b / 12, b * b / 6, 0], [0, 0, h * h / 12]]
    assert np.allclose(moments.P0 / m, second, atol=1e-12)


def test_cut_pair_is_said():
    with pytest.warns(UserWarning, match="10 modes cut a degenerate pair in two"):
        found = pf.fe.plate_modes(corners(), n_modes=10, **PLATE)
    assert "9 or 11 modes do not" in found.notes[0]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert pf.fe.plate_modes(corners(), n_modes=9, **PLATE).notes == ()


def test_unknowns_are_counted_before_meshing():
    """6 per node and 1 per edge; 522 for the default hexagon."""
    assert unknowns(6, 2) == 522
    assert unknowns(6, 1) == 156


def test_origin_and_attachments_can_be_chosen():
    """Σp at a corner: the tensors are shifted, the motion of the body is the same."""
    modes = pf.fe.plate_modes(corners(), n_modes=9, **PLATE)
    points = modes.nodes[[1, 3, 5]]
    body = pf.FlexibleBody.from_modes(modes, attachments=points, origin=modes.nodes[1])
    assert body.attachments == (1, 3, 5)
    assert np.allclose(body.attachment_points[0], 0)
    central = pf.FlexibleBody.from_modes(modes, attachments=[1, 3, 5])
    V, qd = np.array([0.1, 0.2, -0.3, 0.4, -0.5, 0.6]), 0.1 * np.arange(9)
    r = modes.nodes[1]
    moved = np.concatenate([V[:3] + np.cross(V[3:], r), V[3:]])
    q = 0.01 * np.arange(9)
    here, there = platform_of(body), platform_of(central)
    assert abs(body_energies(here, moved, q, qd)[0] - body_energies(there, V, q, qd)[0]) <= 1e-12


def test_published_frequencies_replace_the_computed_ones():
    body = pf.robots.gough_stewart(10, frequencies="published").platform
    assert np.allclose(np.sqrt(body.stiffness), TABLE_2, rtol=1e-9)
    assert np.allclose(body.damping, 2 * 0.4 * np.array(TABLE_2), rtol=1e-9)


def test_far_from_the_origin_is_the_same_plate():
    """Moved by a kilometre: the same frequencies and shapes, nodes and centre moved."""
    here = pf.fe.plate_modes(corners(), n_modes=4, **PLATE)
    there = pf.fe.plate_modes(corners() + [1000.0, -500.0], n_modes=4, **PLATE)
    assert np.allclose(there.frequencies, here.frequencies, rtol=1e-8)
    assert np.allclose(there.nodes - here.nodes, [1000.0, -500.0, 0.0], atol=1e-9)
    bodies = [pf.FlexibleBody.from_modes(modes) for modes in (here, there)]
    for a, b in zip(*(platform_of(body).moments[1:] for body in bodies), strict=True):
        assert np.allclose(a, b, atol=1e-6)


def test_slender_plate_is_not_passed_off_as_resolved():
    """A strip fifty times as long as wide: the default mesh does not resolve its modes, and says so."""
    strip = [(0, 0), (1.0, 0), (1.0, 0.02), (0, 0.02)]
    with pytest.warns(UserWarning, match="from the mesh once coarser: raise refine"):
        found = pf.fe.plate_modes(strip, n_modes=3, **PLATE)
    assert np.max(found.frequency_error) > 0.05


def test_elements_are_made_once_and_are_read_only():
    """Two plates of one outline share them; a finer mesh has its own."""
    found = argyris(corners(), 2)
    assert argyris(corners(), 2) is found
    assert argyris(corners(), 1) is not found
    with pytest.raises(ValueError, match="read-only"):
        found.dx[0] = 0.0


def test_plates_that_share_elements_are_their_own():
    """Material and thickness are not those of the plate before."""
    thin = pf.fe.plate_modes(corners(), n_modes=3, **PLATE | {"thickness": 1e-3})
    thick = pf.fe.plate_modes(corners(), n_modes=3, **PLATE | {"thickness": 2e-3})
    assert np.allclose(thick.frequencies, 2 * thin.frequencies, rtol=1e-4)
