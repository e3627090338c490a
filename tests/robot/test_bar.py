"""Bars from dimensions, against masses at Gauss points; what is missing, said twice, or no body's."""

import numpy as np
import pytest

import parflex as pf
from measures import relative
from parflex.robot.bar import beam_of


def test_a_tube_has_the_inertia_of_its_points():
    """Points on the ring of mean square radius, at ± ℓ/√12 from the middle, have its second moments."""
    bar = pf.Bar(outer=0.04, inner=0.03, length=0.5, density=7850.0)
    mass = 7850 * np.pi * (0.02**2 - 0.015**2) * 0.5
    radius = np.sqrt((0.02**2 + 0.015**2) / 2)
    x = 0.5 / np.sqrt(12) * np.array([1, 1, 1, 1, -1, -1, -1, -1])
    y, z = radius * np.array([[1, 0, -1, 0] * 2, [0, 1, 0, -1] * 2])
    assert relative(bar.kilograms, mass) < 1e-14
    assert bar.centre == 0.25
    expected = np.mean(y**2 + z**2) * mass, np.mean(x**2 + z**2) * mass
    assert relative(np.divide(bar.inertia_at_com, expected), np.ones(2)) < 1e-14


def test_a_mass_and_a_length_are_a_slender_bar():
    bar = pf.Bar(mass=2.0, length=0.6)
    assert bar.inertia_at_com == (0.0, pytest.approx(2.0 * 0.6**2 / 12))


BENT = dict(outer=0.04, inner=0.03, length=0.5, young=205e9)


def test_a_bar_that_bends_weighs_as_much_as_one_that_does_not():
    """Mass, first moment and inertia about its joint of the beam, against the rigid bar's by Steiner."""
    for heavy in ({"density": 7850.0}, {"mass": 1.7}):
        bar = pf.Bar(**BENT | heavy, axial=1)
        rigid = pf.Bar(**{name: BENT[name] for name in ("outer", "inner", "length")} | heavy)
        for along in np.array([[0, -1.0, 0], [1, 0, 0], [0.6, 0, 0.8]]):
            found, ee = beam_of(bar, along).body.moments, np.outer(along, along)
            axial, across = rigid.inertia_at_com
            inertia = axial * ee + (across + rigid.kilograms * 0.25**2) * (np.eye(3) - ee)
            assert relative(found.m, rigid.kilograms) < 1e-14
            assert relative(found.MS0, rigid.kilograms * 0.25 * along) < 1e-14
            assert relative(np.trace(found.P0) * np.eye(3) - found.P0, inertia) < 1e-14


def test_a_modulus_bends_a_bar_once_in_each_plane():
    """As `pf.beam` by default; without shapes it is rigid, whatever its modulus."""
    bar = pf.Bar(**BENT, density=7850.0)
    assert bar.flexible
    assert beam_of(bar, (0, 0, 1)).body.modes == 2
    assert not pf.Bar(**BENT, density=7850.0, bending=0).flexible


def test_numbers_overrule_dimensions():
    bar = pf.Bar(mass=2.0, length=0.6, com=0.1, inertia=(0.01, 0.05))
    assert (bar.kilograms, bar.centre, bar.inertia_at_com) == (2.0, 0.1, (0.01, 0.05))


MISUSE = {
    "nothing": ({}, "Bar.mass is missing; give it, or all of outer, length and density"),
    "no density": (dict(outer=0.1, length=1), "Bar.mass is missing"),
    "mass alone": (dict(mass=1), "Bar.com is missing; give com and inertia, or the length"),
    "no inertia": (dict(mass=1, com=0.1), "Bar.inertia is missing"),
    "twice": (dict(mass=1, density=2700, outer=0.1, length=1), "Bar.density is 2700.0, beside mass"),
    "a wall of nothing": (dict(mass=1, outer=0.1, inner=0.1, length=1), "Bar.inner is 0.1; it must be less"),
    "bore without a bar": (dict(mass=1, inner=0.1, length=1), "inner is 0.1, without outer; give"),
    "no body": (dict(mass=1, com=0.1, inertia=(3.0, 1.0)), "no body's: the first cannot be more than twice"),
    "no modulus": (dict(outer=0.1, length=1, mass=1, bending=1), "young is missing; a bar that bends"),
    "no length that bends": (dict(mass=1, com=0.1, inertia=(0, 1), young=1e11), "Bar.com is given, but a"),
    "no thickness": (dict(mass=1, length=1, young=1e11), "Bar.outer is missing; a bar that bends"),
    "no ratio": (dict(BENT, mass=1, torsion=2), "Bar.poisson is missing, but torsion is 2; give Poisson's"),
    "too many shapes": (dict(BENT, mass=1, bending=17), "bending is 17, but the 33 nodes of a beam carry 16"),
    "negative": (dict(mass=-1, length=1), "Bar.mass is -1.0; it must be positive"),
    "one inertia": (dict(mass=1, com=0.1, inertia=[1.0]), "Bar.inertia has shape"),
}  # fmt: skip


@pytest.mark.parametrize("name", MISUSE)
def test_misuse_is_told_in_a_sentence(name):
    given, words = MISUSE[name]
    with pytest.raises(pf.InputError, match=words):
        pf.Bar(**given)


def test_limits_go_from_low_to_high():
    bar = pf.Bar(mass=1, length=0.1)
    with pytest.raises(pf.InputError, match=r"Strut.stroke is \[0.4, 0.3\]; give the lower limit first"):
        pf.Strut(bar, bar, stroke=(0.4, 0.3))
