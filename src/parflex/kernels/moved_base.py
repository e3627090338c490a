"""Kernels of robots on a floor that moves: `base` (19,) is one more input."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from parflex.base.array import Array
from parflex.kernels.inputs import remade
from parflex.kernels.kernel import Kernel
from parflex.mechanics.mechanism import Mechanism
from parflex.robot.base_motion import BaseMotion
from parflex.robot.carrying import base_of

BASE = "base"


def moved_base(mechanism: Mechanism, build: Callable[..., Kernel], *chosen: object) -> Kernel:
    """The kernel that `build` makes of the mechanism and its other arguments, with the flat motion of the
    base as an input, as `BaseMotion.flat` has it; its quaternion may have any length but zero."""
    return remade(mechanism, BASE, AT_REST, with_base, build, *chosen)


def with_base(mechanism: Mechanism, base: Array) -> Mechanism:
    """The mechanism on a base that moves so (…, 19)."""
    return replace(mechanism, base=base_of(base))


AT_REST: Array = np.asarray(BaseMotion().flat)
