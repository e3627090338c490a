"""Control laws: what moves the robot in a simulation."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from parflex import singular
from parflex.array import Array
from parflex.check import finite
from parflex.errors import InputError
from parflex.output import FrameOutput
from parflex.state import State, pack, unpack
from parflex.trajectory import Trajectory

if TYPE_CHECKING:
    from parflex.model import Model

Law = Callable[[float, Array, Array], Array]  # (t, flat state, external wrench) -> forces (m,)


class Controller(ABC):
    """Actuator forces as a function of time and state."""

    trajectory: Trajectory | None = None  # what the platform is to follow, for the record

    @abstractmethod
    def bind(self, model: "Model") -> Law:
        """The law on flat vectors, for one simulation."""


@dataclass(frozen=True, eq=False)
class ComputedTorque(Controller):
    """Forces from the inverse model along a trajectory, with feedback of the platform's pose.

    V̇ = V̇_d + kd (V_d − V) + kp e, with e the position and rotation error of Σp; kp (1/s²) and kd
    (1/s) are scalars or (6,). With zero gains this is the paper's Fig. 3.
    """

    model: "Model"
    trajectory: Trajectory
    kp: ArrayLike = 0.0
    kd: ArrayLike = 0.0

    def __post_init__(self) -> None:
        for name in ("kp", "kd"):
            gain = finite(f"ComputedTorque.{name}", getattr(self, name))
            if gain.shape not in ((), (6,)) or np.any(gain < 0):
                raise InputError(f"ComputedTorque.{name} is {gain}; give one value ≥ 0, or six")
            object.__setattr__(self, name, gain)

    def __call__(self, t: float, state: State) -> Array:
        """Forces (m,) at a time and state."""
        modes = self.model.robot.platform.modes
        return self.bind(self.model)(t, pack(state, modes), np.zeros(6 + modes))

    def bind(self, model: "Model") -> Law:
        robot, output = model.robot, FrameOutput()
        function = model.function("tracking", output)
        x, wanted, gains, w = inputs = [np.zeros(n) for n in function.kernel.inputs]
        forces, gain, Jp_invT, margins = results = [np.zeros(n) for n in function.kernel.outputs]
        trigger = function.bind(inputs, results)
        gains[:6], gains[6:] = self.kp, self.kd
        watch = singular.Watch(robot.n_forces)

        def law(t: float, state: Array, wrench: Array) -> Array:
            x[:], w[:] = state, wrench
            sample = self.trajectory.sample(t)
            np.concatenate([part.reshape(-1) for part in sample], out=wanted)
            trigger()
            singular.check_legs(robot, margins)
            if not watch(gain, Jp_invT):
                singular.check_gain(robot, output, gain, Jp_invT)
            return forces

        return law


@dataclass(frozen=True, eq=False)
class JointPD(Controller):
    """Springs and dampers on the actuated joints: Γ = Γ_0 + kp (q_ref − q) − kd q̇.

    The reference is the actuated joints' position in a state; kp (N/m or N m/rad) and kd (N s/m or
    N m s/rad) are scalars or (m,); forces Γ_0 (m,) is added.
    """

    model: "Model"
    reference: State
    kp: ArrayLike
    kd: ArrayLike
    forces: ArrayLike = 0.0

    def __post_init__(self) -> None:
        m = self.model.robot.n_forces
        for name in ("kp", "kd", "forces"):
            value = finite(f"JointPD.{name}", getattr(self, name))
            if value.shape not in ((), (m,)):
                raise InputError(f"JointPD.{name} has shape {value.shape}; give one value, or ({m},)")
            object.__setattr__(self, name, value)

    def bind(self, model: "Model") -> Law:
        function = model.function("actuators")
        x, q, qd = np.zeros(function.kernel.inputs[0]), *(np.zeros(n) for n in function.kernel.outputs)
        trigger = function.bind([x], [q, qd])
        x[:] = pack(self.reference, model.robot.platform.modes)
        trigger()
        wanted = q.copy()

        def law(t: float, state: Array, wrench: Array) -> Array:
            x[:] = state
            trigger()
            return self.forces + self.kp * (wanted - q) - self.kd * qd

        return law


def as_law(model: "Model", given: Any) -> Law:
    """The law of a controller, of given forces (m,), or of a callable (t, state) -> forces."""
    m = model.robot.n_forces
    if isinstance(given, Controller):
        return given.bind(model)
    if callable(given):
        modes = model.robot.platform.modes

        def called(t: float, state: Array, wrench: Array) -> Array:
            forces = finite("controller(t, state)", given(t, unpack(state, modes)))
            if forces.shape != (m,):
                raise InputError(f"controller(t, state) gave shape {forces.shape}; expected ({m},)")
            return forces

        return called
    constant = finite("forces_or_controller", given)
    if constant.shape != (m,):
        raise InputError(
            f"forces_or_controller has shape {constant.shape}; give forces ({m},), a Controller, or "
            f"a function (t, state) -> forces ({m},)"
        )
    return lambda t, state, wrench: constant
