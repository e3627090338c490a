"""The gallery's models against what they answered before the code was put in storeys (`reference/`)."""

import numpy as np
import pytest

import parflex as pf
from measures import relative
from reference.gallery import ENTRIES, STORED, answers, robot_of

SAME = 1e-13


@pytest.mark.parametrize("kind", ["rigid", "flexible"])
@pytest.mark.parametrize("name", ENTRIES)
def test_answers_as_before(name, kind):
    start = f"{name}/{kind}/"
    with np.load(STORED) as every:
        stored = {key.removeprefix(start): every[key] for key in every.files if key.startswith(start)}
    found = answers(name, pf.Model(robot_of(name, kind == "flexible"), "numpy"), stored)
    for key, value in found.items():
        assert relative(value, stored[key]) <= SAME, key
