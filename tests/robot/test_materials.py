"""Materials by name and by numbers."""

import numpy as np
import pytest

import parflex as pf
from parflex.robot.materials import chosen

# plies of 0.6 … 0.63 fibres: E_1, E_2, ν_12, G_12 (Pa); Daniel and Ishai 2006, Tsai and Hahn 1980
PLIES = {"AS4/3501-6": (147e9, 10.3e9, 0.27, 7.0e9), "T300/5208": (181e9, 10.3e9, 0.28, 7.17e9)}


def quasi_isotropic(E_1, E_2, nu_12, G_12):
    """Young's modulus and Poisson's ratio of the laminate: invariants U_1, U_4 of the ply."""
    share = 1 - nu_12**2 * E_2 / E_1
    Q_11, Q_22, Q_12 = E_1 / share, E_2 / share, nu_12 * E_2 / share
    U_1 = (3 * Q_11 + 3 * Q_22 + 2 * Q_12 + 4 * G_12) / 8
    U_4 = (Q_11 + Q_22 + 6 * Q_12 - 4 * G_12) / 8
    return (U_1**2 - U_4**2) / U_1, U_4 / U_1


def test_every_material_has_its_name_and_a_source():
    for name, made in pf.fe.MATERIALS.items():
        assert made.name == name
        assert len(made.source) > 5


def test_moduli_are_those_of_the_codes():
    """G = E / 2 (1 + ν): 81 GPa of steel (EN 1993-1-1, 3.2.6), 27 GPa of aluminium (EN 1999-1-1, 3.2.5) to
    3 %, since the code's ν is 0.3."""
    assert np.isclose(pf.fe.material("steel").lame[1], 81e9, rtol=0.003)
    assert np.isclose(pf.fe.material("aluminium").lame[1], 27e9, rtol=0.03)


def test_laminate_lies_between_its_sources():
    made = pf.fe.material("CFRP quasi-isotropic")
    (low, nu_1), (high, nu_2) = (quasi_isotropic(*ply) for ply in PLIES.values())
    assert low < made.young < high
    assert min(nu_1, nu_2) - 0.01 < made.poisson < max(nu_1, nu_2) + 0.01


@pytest.mark.parametrize("name", ["cast iron", "Cast-Iron", " CAST_IRON "])
def test_capitals_and_hyphens_do_not_matter(name):
    assert pf.fe.material(name) is pf.fe.MATERIALS["cast iron"]


def test_numbers_or_a_name():
    assert chosen("steel") is chosen(pf.fe.material("steel"))
    assert chosen(None, 1e11, 0.3, 5000) == pf.fe.Material(1e11, 0.3, 5000)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({}, "material is not given; name one of aluminium, steel"),
        ({"young": 1e11}, "poisson is not given, but young is: name one of"),
        ({"young": 1e11, "mark": "--"}, "--poisson is not given, but --young is"),
        ({"material": "steel", "density": 7850}, "density is given, and material too; leave out one"),
        ({"material": "alumnium"}, "material is 'alumnium', which is not known; did you mean 'aluminium'?"),
        ({"material": "wood"}, "material is 'wood', which is not known; It can be aluminium"),
        ({"material": 5}, "material is 5"),
    ],
)
def test_what_is_missing_or_misspelt_is_said(given, words):
    with pytest.raises(pf.InputError) as told:
        chosen(**given)
    assert words in str(told.value)


@pytest.mark.parametrize(
    ("numbers", "words"),
    [
        ((70.0, 0.33, 2700.0), 'young is 70 Pa, less than any material of machines has; did you mean "70 '),
        ((70e3, 0.33, 2700.0), 'did you mean "70000 MPa"?'),
        ((10.2e6, 0.33, 2700.0), 'did you mean "1.02e+07 psi"?'),
        ((7e13, 0.33, 2700.0), "young is 7e+13 Pa, more than any material of machines has; is its unit"),
        ((70e9, 0.33, 2.7), 'machines has; did you mean "2.7 g/cm^3"?'),
        ((70e9, 0.33, 2.7e-9), 'did you mean "2.7e-09 t/mm^3"?'),
        ((70e9, 0.33, 0.098), 'did you mean "0.098 lb/in^3"?'),
        ((70e9, -0.33, 2700.0), "poisson is -0.33, as of foams alone; did you mean 0.33?"),
    ],
)  # fmt: skip
def test_numbers_in_another_unit_are_doubted(numbers, words):
    with pytest.warns(pf.ImplausibleValue) as told:
        pf.fe.Material(*numbers)
    assert words in str(told[0].message)


def test_plates_and_solids_take_names():
    """A name is its numbers, for thin plates, solids and all their parts."""
    square = [(0, 0), (0.4, 0), (0.4, 0.4), (0, 0.4)]
    named = pf.fe.plate_modes(square, 0.01, n_modes=3, material="steel")
    numbers = pf.fe.plate_modes(square, 0.01, 210e9, 0.3, 7850.0, 3)
    assert np.array_equal(named.frequencies, numbers.frequencies)
    assert named.materials == (pf.fe.material("steel"),)
    with pytest.raises(pf.InputError, match="material is not given"):
        pf.fe.plate_body(square, 0.01)
    with pytest.raises(pf.InputError, match="n_modes is not given"):
        pf.fe.plate_modes(square, 0.01, material="steel")
