"""Compliance and stiffness of a point, and stability lobes, against closed forms."""

import numpy as np
import pytest
import xarray as xr

import parflex as pf
from published_hexapods import compliance_point, dehaeze, hold

M, K, ZETA, K_S = 1.0, 1e6, 0.03, 2e9
OMEGA = np.linspace(0.5, 3.0, 60001) * np.sqrt(K / M)


def oscillator(omega=OMEGA):
    """The compliance of a mass on a spring along x, other directions rigid."""
    H = np.zeros((3, 3, len(omega)), complex)
    H[0, 0] = 1 / (K - M * omega**2 + 2j * ZETA * np.sqrt(K * M) * omega)
    return xr.DataArray(H, {"omega": omega}, ("output", "input", "omega"))


def lobes(**changes):
    given = dict(stiffness=K_S, teeth=2, direction=(1, 0, 0), speeds=np.linspace(500.0, 1e4, 40))
    return pf.stability_lobes(changes.pop("frf", oscillator()), **given | changes)


def test_the_lowest_lobe_of_an_oscillator():
    """2 k ζ (1 + ζ) / K_s (Tlusty); the grid of frequencies leaves less than 1e-6."""
    assert float(lobes().lowest) == pytest.approx(2 * K * ZETA * (1 + ZETA) / K_S, rel=1e-5)


def test_limits_are_roots_of_the_characteristic_equation():
    """1 + b K_s G(jω) (1 − exp(−jωT)) = 0 at the limit of each speed, T the time from tooth to tooth."""
    found = lobes()
    s, T = 2j * np.pi * found.chatter.values, 60.0 / (2 * found.speed.values)
    G = 1 / (K + M * s**2 + 2 * ZETA * np.sqrt(K * M) * s)
    assert np.all(np.isfinite(found.limit))
    assert np.max(np.abs(1 + found.limit.values * K_S * G * (1 - np.exp(-s * T)))) <= 1e-5
    assert np.all(found.limit.values >= float(found.lowest) * (1 - 1e-5))


def test_a_slanted_cut_sees_the_product_of_cosines():
    """Force at 60° and thickness at 0°: half the compliance, twice the depth."""
    pair = [(np.cos(np.pi / 3), np.sin(np.pi / 3), 0.0), (1.0, 0.0, 0.0)]
    assert float(lobes(direction=pair).lowest) == pytest.approx(2 * float(lobes().lowest), rel=1e-12)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (dict(teeth=0), "teeth is 0"),
        (dict(stiffness=-1.0), "stiffness"),
        (dict(direction=(0, 0, 0)), "direction must be a vector"),
        (dict(direction=(0, 0, 1)), "nowhere negative"),
        (dict(speeds=[-1.0]), "speeds must be"),
        (dict(frf=np.zeros((3, 3, 4))), "frf is no compliance"),
        (dict(frf=oscillator(OMEGA[:1])), "fewer than two positive frequencies"),
        (dict(frf=oscillator(OMEGA[:100])), "nowhere negative"),
    ],
)
def test_what_makes_no_lobes_is_said(changes, words):
    with pytest.raises(pf.InputError, match=words):
        lobes(**changes)


def test_dynamic_stiffness_is_the_inverse_of_compliance():
    """At rest it is k JᵀJ about the point, whose inverse is published (test_published.py)."""
    robot = dehaeze()
    lin, offset = hold(robot), compliance_point(robot)
    omega = [0.0, 3000.0]
    given, back = (f(lin, 0, offset)(omega) for f in (pf.compliance, pf.dynamic_stiffness))
    for k in range(2):
        assert np.allclose(given.values[..., k] @ back.values[..., k], np.eye(6), atol=1e-9)
    assert given.values[0, 0, 0].real == pytest.approx(4.74996e-8, rel=1e-5)
    assert list(back.input.values) == list(given.output.values)
    assert list(back.output_units.values[[2, 3]]) == ["N", "N m"]
    with pytest.raises(pf.InputError, match="the platform has nodes 0 … 5"):
        pf.compliance(lin, 6)
