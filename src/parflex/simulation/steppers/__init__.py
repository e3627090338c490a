"""Steppers: integrators that go on in time, in Python or in machine code."""

import numpy as np

from parflex.base.array import Array
from parflex.simulation.laws.bound import BoundLaw
from parflex.simulation.steppers.cyrk_steps import cyrk_steps
from parflex.simulation.steppers.scipy_steps import SciPySteps
from parflex.simulation.steppers.stepper import Stepper

METHODS = ("DOP853", "RK45", "Radau")  # which begin each step from the point alone


def stepper_of(
    law: BoundLaw, method: str, t: float, y: Array, end: float, tolerances: dict[str, float]
) -> Stepper:
    """The integration of a law's motion from (t, y) on: in machine code where that is possible."""

    def rate(t: float, y: Array) -> Array:
        return np.concatenate(law.rate(t, y[: -law.works]))

    def slopes(t: float, y: Array) -> Array:
        return np.pad(law.jacobian(t, y[: -law.works]), (0, law.works))

    def until(t: float) -> float:
        return law.stretch(t)[1]

    fast = cyrk_steps(law, method, t, y, tolerances)
    return fast or SciPySteps(method, rate, slopes, t, y, end, tolerances, until)
