"""The functions that are exported, and the names of their arrays in C."""

from collections.abc import Mapping
from typing import NamedTuple

from parflex.kernels import models
from parflex.kernels.kernel import Kernel
from parflex.kernels.motion import derivative
from parflex.kernels.projection import projection
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.output import Output
from parflex.robot.robot import Robot

OPTIONAL = ("w", "preload")  # inputs that may be NULL, which stands for zeros
NAMES = {  # names in C, where they are not the kernels' own
    "forces": "u",
    "load": "w",
    "platform": "Vd",
    "elastic": "qdd_e",
    "contact": "f",
    "rate": "xd",
}


class Routine(NamedTuple):
    """A kernel as a C function, and what is said of it."""

    kernel: Kernel
    words: str
    closure: bool = True  # whether a state off the closure is refused

    @property
    def inputs(self) -> tuple[str, ...]:
        """The names of the arrays that it reads."""
        return named(self.kernel.inputs)

    @property
    def outputs(self) -> tuple[str, ...]:
        """The names of the arrays that it writes."""
        return named(self.kernel.outputs)

    @property
    def arrays(self) -> list[tuple[str, int]]:
        """Names and lengths of all arrays, inputs first."""
        sizes = (*self.kernel.inputs.values(), *self.kernel.outputs.values())
        return list(zip((*self.inputs, *self.outputs), sizes, strict=True))


def named(arrays: Mapping[str, int]) -> tuple[str, ...]:
    """The names of a kernel's arrays in C."""
    return tuple(NAMES.get(name, name) for name in arrays)


def routines(mechanism: Mechanism, output: Output) -> tuple[Routine, ...]:
    """All functions of a robot; the projection where the closure is a condition on its state."""
    found = (
        Routine(
            models.direct(mechanism),
            "Direct model: accelerations and contact forces under actuator forces u and loads w.",
        ),
        Routine(
            models.inverse(mechanism, output),
            "Inverse model: actuator forces for a wanted acceleration, and what goes with them. With "
            "more actuators than rows of the target they are the nearest to preload.",
        ),
        Routine(
            derivative(mechanism),
            "Derivative of the state in time, for simulation. It does not complain of states off the "
            "closure, which the stages of an integrator are.",
            closure=False,
        ),
    )
    if mechanism.closed:
        return found
    closing = Routine(
        projection(mechanism),
        "One step of Newton's method from x towards the closure of the legs, in the metric of the robot's "
        "mass. health is that of x; it does not complain of its gaps. Call it after each step of an "
        "integrator, with x as projected, too, until the gaps are small: once or twice.",
        closure=False,
    )
    return (*found, closing)


def tips(robot: Robot) -> list[tuple[int, int]]:
    """Leg and attachment of each tip, in the order of the legs."""
    return [(number, tip.attachment) for number, leg in enumerate(robot.legs) for tip in leg.tips]
