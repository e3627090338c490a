"""A bound call keeps alive what it runs on, when nobody else does."""

import subprocess
import sys

import pytest

from parflex.compiled import ALL_BACKENDS

ALONE = """
import gc
import numpy as np
import parflex as pf
from parflex.kernels import models
from parflex.model.core import core_of


def bound():
    model = pf.Model(pf.robots.rps3(), "{backend}")
    x, forces, out = core_of(model).flat(model.robot.home), np.ones(3), np.zeros(6)
    function = core_of(model).functions(models.direct)
    return function.bind({{"x": x, "forces": forces}}, {{"platform": out}}), out, function(x=x, forces=forces)


trigger, out, wanted = bound()
gc.collect()
elsewhere = [np.ones(4096) for _ in range(2000)]
trigger()
assert np.allclose(out, wanted["platform"], rtol=1e-12), out
"""


@pytest.mark.parametrize("backend", ALL_BACKENDS)
def test_a_trigger_outlives_model_and_function(backend):
    """In a process of its own: without its machine code it would end that by a segmentation fault."""
    done = subprocess.run(
        [sys.executable, "-c", ALONE.format(backend=backend)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr or done.returncode
