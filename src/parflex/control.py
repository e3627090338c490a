"""Control laws: what moves the robot in a simulation."""

from abc import ABC, abstractmethod
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from parflex import singular
from parflex.array import Array, Given
from parflex.check import finite, of_type
from parflex.compiled import kernels
from parflex.errors import InputError
from parflex.output import FrameOutput
from parflex.state import State
from parflex.trajectory import Trajectory

if TYPE_CHECKING:
    from parflex.model import Model


class Law(ABC):
    """A controller bound to a model, on flat vectors, for one simulation."""

    @abstractmethod
    def __call__(self, t: float, x: Array) -> Array:
        """Forces (m,) for the flat state; what acts on the platform from outside is not known."""

    @abstractmethod
    def rate(self, t: float, x: Array, w: Array) -> tuple[Array, Array]:
        """ẋ and the powers of actuators, wrenches and damping, under the law's forces and the
        external generalised force w (6 + N,)."""

    def watch(self, x: Array) -> None:
        """Raise SingularPose where the motion that has led to a flat state crossed a singularity."""
        return

    def explain(self) -> str:
        """Why the motion may have failed after the last call; empty where the law knows nothing."""
        return ""


class Driven(Law):
    """A law that gives forces only; the direct model turns them into motion."""

    def __init__(self, model: "Model") -> None:
        function = model.function(kernels.derivative)
        self._inputs = [np.zeros(n) for n in function.kernel.inputs]
        self._results = [np.zeros(n) for n in function.kernel.outputs]
        self._run = function.bind(self._inputs, self._results)
        self._robot = model.robot

    def rate(self, t: float, x: Array, w: Array) -> tuple[Array, Array]:
        for own, given in zip(self._inputs, (x, self(t, x), w), strict=True):
            own[:] = given
        self._run()
        moved, powers, health = self._results
        singular.check_legs(self._robot, health)
        return moved, powers


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
    (1/s) are scalars or (6,). With zero gains this is the paper's Fig. 3. A robot of fewer freedoms
    follows the rows of `output`, as many as it has; one with more actuators stays nearest to
    `preload` (m,).

    A run that starts beyond a dynamic singularity of the output, where this control is unstable,
    warns of it (DynamicSingularity).
    """

    model: "Model"
    trajectory: Trajectory
    kp: Given = 0.0
    kd: Given = 0.0
    output: FrameOutput = field(default_factory=FrameOutput)
    preload: Given = 0.0

    def __post_init__(self) -> None:
        for name in ("kp", "kd"):
            gain = finite(f"ComputedTorque.{name}", getattr(self, name))
            if gain.shape not in ((), (6,)) or np.any(gain < 0):
                raise InputError(f"ComputedTorque.{name} is {gain}; give one value ≥ 0, or six")
            object.__setattr__(self, name, gain)
        of_type("ComputedTorque.trajectory", self.trajectory, Trajectory)
        of_type("ComputedTorque.output", self.output, FrameOutput)
        m = self.model.robot.n_forces
        preload = finite("ComputedTorque.preload", self.preload)
        if preload.shape not in ((), (m,)):
            raise InputError(f"ComputedTorque.preload has shape {preload.shape}; give ({m},)")
        object.__setattr__(self, "preload", preload)
        if m < self.output.size:
            raise InputError(
                f"ComputedTorque follows {self.output.size} freedoms, but the robot has {m} actuators; "
                f"name as many with output=FrameOutput(rows=…), or use JointPD or a function of your own"
            )

    def __call__(self, t: float, state: State) -> Array:
        """Forces (m,) at a time and state."""
        return self.bind(self.model)(t, self.model.flat(state))

    def bind(self, model: "Model") -> Law:
        same_model(self.model, model)
        return Tracking(model, self)


class Tracking(Law):
    """Computed torque: inverse and direct model in one kernel, on buffers of its own."""

    def __init__(self, model: "Model", control: ComputedTorque) -> None:
        function = model.function(kernels.tracking, control.output)
        self._inputs = [np.zeros(n) for n in function.kernel.inputs]
        self._results = [np.zeros(n) for n in function.kernel.outputs]
        self._run = function.bind(self._inputs, self._results)
        self._inputs[3][:] = np.concatenate([np.zeros(6) + control.kp, np.zeros(6) + control.kd])
        self._inputs[5][:] = control.preload
        self._robot, way = model.robot, control.trajectory
        self._starts, self._segments = way.starts.tolist(), way.segments
        self._watch = singular.Watch(model, control.output)

    def __call__(self, t: float, x: Array) -> Array:
        self.rate(t, x, np.zeros_like(self._inputs[4]))
        return self._results[0]

    def rate(self, t: float, x: Array, w: Array) -> tuple[Array, Array]:
        own_x, own_t, segment, _, own_w, _ = self._inputs
        _, moved, powers, health = self._results
        own_x[:], own_t[0], own_w[:] = x, t, w
        segment[:] = self._segments[bisect_right(self._starts, t) - 1]
        self._run()
        singular.check_legs(self._robot, health)
        return moved, powers

    def watch(self, x: Array) -> None:
        self._watch.look(x)

    def explain(self) -> str:
        return self._watch.explain()


@dataclass(frozen=True, eq=False)
class JointPD(Controller):
    """Springs and dampers on the actuated joints: Γ = Γ_0 + kp (q_ref − q) − kd q̇.

    The reference is the actuated joints' position in a state; kp (N/m or N m/rad) and kd (N s/m or
    N m s/rad) are scalars or (m,); forces Γ_0 (m,) is added.
    """

    model: "Model"
    reference: State
    kp: Given
    kd: Given
    forces: Given = 0.0

    def __post_init__(self) -> None:
        m = self.model.robot.n_forces
        of_type("JointPD.reference", self.reference, State)
        if self.reference.batch:
            raise InputError(f"JointPD.reference is a batch {self.reference.batch}; give one state")
        self.model.legs(self.reference)  # refuses a reference that the robot cannot take
        for name in ("kp", "kd", "forces"):
            value = finite(f"JointPD.{name}", getattr(self, name))
            if value.shape not in ((), (m,)):
                raise InputError(f"JointPD.{name} has shape {value.shape}; give one value, or ({m},)")
            object.__setattr__(self, name, value)

    def bind(self, model: "Model") -> Law:
        same_model(self.model, model)
        return Springs(model, self)


class Springs(Driven):
    """Joint springs and dampers on buffers of their own."""

    def __init__(self, model: "Model", control: JointPD) -> None:
        super().__init__(model)
        function = model.function(kernels.actuators)
        self._x = np.zeros(function.kernel.inputs[0])
        self._q, self._qd = (np.zeros(n) for n in function.kernel.outputs)
        self._trigger = function.bind([self._x], [self._q, self._qd])
        self._control = control
        self._x[:] = model.flat(control.reference)
        self._trigger()
        self._wanted = self._q.copy()
        joints = [joint for leg in model.robot.legs for joint in leg.joints if joint.mu]
        self._turn = np.array([0.0 if joint.sigma else 2 * np.pi for joint in joints])
        self._turns = np.array([0.0 if joint.sigma else 1 / (2 * np.pi) for joint in joints])

    def __call__(self, t: float, x: Array) -> Array:
        self._x[:] = x
        self._trigger()
        c = self._control
        ahead = self._wanted - self._q
        ahead = ahead - self._turn * np.round(ahead * self._turns)  # angles are known up to full turns
        return c.forces + c.kp * ahead - c.kd * self._qd


class Called(Driven):
    """A caller's function (t, state) -> forces (m,)."""

    def __init__(self, model: "Model", function: Callable[[float, State], ArrayLike]) -> None:
        super().__init__(model)
        self._function, self._state = function, model.state

    def __call__(self, t: float, x: Array) -> Array:
        found = finite("controller(t, state)", self._function(t, self._state(x)))
        m = self._robot.n_forces
        if found.shape != (m,):
            raise InputError(f"controller(t, state) gave shape {found.shape}; expected ({m},)")
        return found


class Constant(Driven):
    """The same forces (m,) at all times."""

    def __init__(self, model: "Model", forces: Array) -> None:
        super().__init__(model)
        self._forces = forces

    def __call__(self, t: float, x: Array) -> Array:
        return self._forces


def same_model(own: "Model", simulated: "Model") -> None:
    """A controller runs on the model it was made for."""
    if not simulated.is_of(own):
        raise InputError(
            "the controller was made for another model than the one simulated; make it with that model, or "
            "pass a function (t, state) -> forces that calls the other model's inverse"
        )


def as_law(model: "Model", given: Any) -> Law:
    """The law of a controller, of given forces (m,), or of a callable (t, state) -> forces."""
    m = model.robot.n_forces
    if isinstance(given, Controller):
        return given.bind(model)
    if callable(given):
        return Called(model, given)
    constant = finite("forces_or_controller", given)
    if constant.shape != (m,):
        raise InputError(
            f"forces_or_controller has shape {constant.shape}; give forces ({m},), a Controller, or "
            f"a function (t, state) -> forces ({m},)"
        )
    return Constant(model, constant)
