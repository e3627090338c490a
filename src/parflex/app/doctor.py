"""Self-examination: versions, and the backends against the NumPy reference."""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.compiled import ALL_BACKENDS, choose
from parflex.kernels import models as kernels
from parflex.mechanics.output import FrameOutput
from parflex.model.core import core_of
from parflex.model.model import Model
from parflex.robots import gough_stewart

AGREEMENT = 1e-12  # backends differ by the order of additions only
IDENTITY = 1e-10


class Check(NamedTuple):
    """One line of the examination."""

    what: str
    found: str
    passed: bool


def examine() -> list[Check]:
    """Each backend against NumPy, and forces recovered from their own accelerations."""
    robot = gough_stewart(modes=3)
    reference = Model(robot, "numpy")
    state, forces = reference.equilibrium(*robot.home_pose)
    core = core_of(reference)
    x = core.flat(state)
    x[core.mechanism.layout.at.twist] = 0.1
    lines = [Check("fastest backend", choose("auto").version(), True)]
    expected = core.functions(kernels.direct)(x=x, forces=forces)
    for name in ALL_BACKENDS:
        functions = core_of(Model(robot, name)).functions
        found = functions(kernels.direct)(x=x, forces=forces)
        error = max(relative(found[key], value) for key, value in expected.items())
        lines.append(Check(f'"{name}" against NumPy, direct model', f"{error:.1e}", error <= AGREEMENT))
        again = functions(kernels.inverse, FrameOutput())(x=x, target=found["platform"])["forces"]
        error = relative(again, forces)
        lines.append(Check(f'"{name}" inverse after direct', f"{error:.1e}", error <= IDENTITY))
    return lines


def relative(a: Array, b: Array) -> float:
    """max |a − b| / max(1, max |b|)."""
    return float(np.max(np.abs(a - b), initial=0.0) / max(1.0, np.max(np.abs(b), initial=0.0)))
