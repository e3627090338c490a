"""Values that are legal and hardly meant: told with the likely slip, where the user stands."""

import warnings

import numpy as np
import pytest

import parflex as pf
from parflex.base.plausible import doubt, listening

SLIPS = {
    "degrees": (
        dict(alpha=-90),
        "Joint.alpha is -90 rad, more than a full turn; if it is in deg, give -1.570",
    ),
    "millimetres": (dict(d=250), 'Joint.d is 250 m, .* give 0.25 m, in files "250 mm"'),
    "grams": (dict(M=73000), 'Joint.M is 73000 kg, .* give 73 kg, in files "73000 g"'),
    "a moment": (dict(MS=(0, -4e4, 0)), "Joint.MS is -40000 kg m, .* give -40 kg m"),
    "a limit in degrees": (dict(q_min=-90), "Joint.q_min is -90 rad"),
}


@pytest.mark.parametrize("name", SLIPS)
def test_likely_slips_are_named(name):
    given, words = SLIPS[name]
    with pytest.warns(pf.ImplausibleValue, match=words) as caught:
        pf.Joint(0, 0, **given)
    assert [each.filename for each in caught] == [__file__]


def test_the_same_number_is_usual_of_another_kind():
    """A slide may go 40 m where an angle of 40 rad is doubted; limits may be missing."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        pf.Joint(0, 1, q_min=-40.0)


def test_who_listens_is_told_instead():
    with listening() as outer:
        doubt("a is 1; give 2")
        with listening() as inner:
            pf.Joint(0, 0, theta=np.pi * 100)
    assert outer == ["a is 1; give 2"]
    assert [words.split()[0] for words in inner] == ["Joint.theta"]
