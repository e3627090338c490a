"""Control laws. A new one is a file in this folder and a line in `ALL_LAWS`."""

from typing import TYPE_CHECKING, Any

from parflex.simulation.laws.called import Called
from parflex.simulation.laws.computed_torque import ComputedTorque
from parflex.simulation.laws.constant_forces import ConstantForces
from parflex.simulation.laws.controller import Controller
from parflex.simulation.laws.joint_pd import JointPD
from parflex.simulation.laws.servo import Servo

if TYPE_CHECKING:
    from parflex.model.model import Model

ALL_LAWS: tuple[type[Controller], ...] = (Servo, ComputedTorque, JointPD, ConstantForces, Called)


def controller_of(model: "Model", given: Any) -> Controller:
    """The controller that is given, or that stands for forces (m,) or a callable (t, state) -> forces."""
    if isinstance(given, Controller):
        return given
    return Called(model, given) if callable(given) else ConstantForces(model, given)
