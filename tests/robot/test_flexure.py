"""Flexures by an axis and two numbers, and links that have their mass twice."""

import numpy as np
import pytest

import parflex as pf


@pytest.mark.parametrize("size", [1.0, 1e-200, 1e200, 1e-310])
def test_an_axis_is_a_direction_of_any_length(size):
    """K has the torsion about it and the bending across: (3, 4, 0)/5, by hand."""
    found = pf.Flexure.about(np.array([3.0, 4.0, 0.0]) * size, bending=2.0, torsion=27.0).stiffness
    assert np.allclose(found, [[11, 12, 0], [12, 18, 0], [0, 0, 2]], rtol=1e-12)


def test_a_soft_one_has_the_same_axes():
    """As above: K_t has the axial stiffness along, the shear across."""
    found = pf.Flexure.about((3, 4, 0), axial=27.0, shear=2.0, translation_damping=5.0)
    assert np.allclose(found.translation, [[11, 12, 0], [12, 18, 0], [0, 0, 2]], rtol=1e-12)
    assert np.array_equal(found.translation_damping, 5 * np.eye(3))
    assert not np.any(found.stiffness)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"axial": 1.0}, "shear is missing"),
        ({"shear": 1.0}, "axial is missing"),
        ({"translation_damping": 1.0}, "translation_damping is given without axial and shear"),
    ],
)
def test_half_of_a_soft_one(given, words):
    with pytest.raises(pf.InputError, match=words):
        pf.Flexure.about((0, 0, 1), **given)


def test_no_axis():
    with pytest.raises(pf.InputError, match=r"axis is \[0.0, 0.0, 0.0\]; give a direction"):
        pf.Flexure.about((0, 0, 0), bending=1)


def test_a_mass_given_twice_is_named():
    """By the field that has it, not by another that is zero."""
    rod = pf.beam((0, 0, 0.5), 0.02, young=2e11, poisson=0.3, density=7850)
    with pytest.raises(pf.InputError, match=r"Joint.MS is \[0.0, 0.0, 0.1\] beside body"):
        pf.Joint(0, sigma=0, body=rod, MS=(0, 0, 0.1))
