"""The control of a robot for which nobody names one: the legs' servos, where they can hold it."""

from typing import NamedTuple

from parflex.analysis.mobility import motions, rank, scaled_closure
from parflex.analysis.posed import well_posed
from parflex.mechanics.held import held
from parflex.mechanics.output import FrameOutput
from parflex.model.core import core_of
from parflex.model.inverting import MOVING, STATIC
from parflex.model.model import Model
from parflex.simulation.laws.computed_torque import ComputedTorque
from parflex.simulation.laws.controller import Controller
from parflex.simulation.laws.servo import Servo
from parflex.simulation.laws.verdict import buckling, decisive, grows
from parflex.simulation.trajectory import Trajectory

KP, KD = 400.0, 40.0  # 1/s² and 1/s, of computed torque: critically damped, e-fold in 50 ms


class Choice(NamedTuple):
    """A controller, and why it is not the legs' servos; empty where it is."""

    controller: Controller
    why: str = ""


def default_control(model: Model, way: Trajectory) -> Choice:
    """The legs' servos along a trajectory, or computed torque where they cannot hold the robot at home."""
    core = core_of(model)
    if any(held(core.mechanism).layout.joints):
        why = "the legs' servos need legs with closed-form inverse geometry"
        return Choice(held_frame(model, way), why)
    locked = decisive(core.at_home.locked_poles())
    if grows(locked):
        return Choice(held_frame(model, way), buckling(locked))
    return Choice(Servo(model, way))


def held_frame(model: Model, way: Trajectory) -> ComputedTorque:
    """Computed torque of as many rows of V̇_p as the platform has freedoms, those that are most its own."""
    from scipy.linalg import qr

    core = core_of(model)
    G = scaled_closure(core.mechanism, core.flat(core.robot.home))
    _, triangle, order = qr(motions(core.mechanism, G).platform.T, pivoting=True, mode="economic")
    freedoms = min(rank(triangle), model.robot.n_forces)
    output = FrameOutput(tuple(sorted(order[:freedoms].tolist())))
    legs = MOVING if well_posed(core.readable, output, core.flat(core.robot.home)) else STATIC
    return ComputedTorque(model, way, KP, KD, output, legs=legs)
