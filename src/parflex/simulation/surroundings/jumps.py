"""Jumps in samples: steps that the samples beside them do not explain."""

import numpy as np

from parflex.base.array import Array

NEAR = 4  # samples on either side that may explain a step
STEEP = 10.0  # times the steepest of these: a step that they do not
PART = 0.02  # of the samples' range: a smaller step is rounding


def first_jump(t: Array, values: Array) -> int | None:
    """The number of the first sample to which values (T,) at times (T,) jump; None where they do not.

    A step is explained by another one near it that is a tenth as steep or more: shaking has many of them, a
    smooth start has steeper ones before it.
    """
    steps = np.diff(values)
    slopes = np.abs(steps / np.diff(t))
    large = np.abs(steps) > PART * np.ptp(values)
    for i in np.flatnonzero(large):
        spike = i + 1 < len(steps) and large[i + 1] and steps[i] * steps[i + 1] < 0
        width = 2 if spike else 1
        beside = [*slopes[max(0, i - NEAR) : i], *slopes[i + width : i + width + NEAR]]
        if slopes[i] > STEEP * max(beside, default=0.0):
            return int(i) + 1
    return None
