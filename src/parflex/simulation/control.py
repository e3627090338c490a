"""Control laws: what moves the robot in a simulation."""

from abc import ABC, abstractmethod
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from parflex.analysis import singularities as singular
from parflex.base.array import Array, Given
from parflex.base.check import finite, of_type
from parflex.base.errors import InputError
from parflex.compiled.backend import Trigger
from parflex.kernels import models as kernels
from parflex.kernels import motion_jacobians, motions
from parflex.kernels.kernel import Kernel
from parflex.mechanics.output import FrameOutput, Output
from parflex.robot.state import State
from parflex.simulation.loads import Loads, at_times
from parflex.simulation.trajectory import Trajectory

if TYPE_CHECKING:
    from parflex.model.model import Model


class Motion(NamedTuple):
    """What a law did at times (T,): all rows (T, …)."""

    forces: Array  # Γ (T, m)
    rate: Array  # ẋ (T, size)
    contact: Array  # contact forces by tip (T, 3k)
    load: Array  # external generalised forces (T, 6 + N)


class Law:
    """A controller bound to a model and the loads on its platform, on flat vectors, for one simulation.

    The law and the motion it causes are one kernel of `compiled.motions`. What the kernel reads of
    the law is a row of a table: the first, and from each of the times `starts` on the next.
    """

    def __init__(
        self, model: "Model", loads: Loads, build: Callable[..., Kernel], rows: Array, starts: ArrayLike = (),
        *chosen: Output,
    ) -> None:  # fmt: skip
        self.function = model.function(build, *chosen, loads.places)
        self._build_jacobian = partial(model.function, motion_jacobians.KNOWN[build], *chosen, loads.places)
        self.loads, self.rows = loads, np.atleast_2d(rows)
        self.starts = [float(start) for start in np.asarray(starts)]
        self.inputs = [np.zeros(n) for n in self.function.kernel.inputs]
        self.inputs[4][:] = loads.pushes
        self.results = [np.zeros(n) for n in self.function.kernel.outputs]
        self._run = self.function.bind(self.inputs, self.results)
        self.robot = model.robot

    @property
    def alone(self) -> bool:
        """Whether forces and loads are known without calling anybody."""
        return self.loads.steady

    def row(self, t: float, x: Array) -> Array:
        """What the kernel reads of the law at a time and flat state."""
        found: Array = self.rows[self.stretch(t)[0]]
        return found

    def stretch(self, t: float) -> tuple[int, float]:
        """Which row of the table holds at a time, and until when; steps do not go beyond."""
        row = bisect_right(self.starts, t)
        return row, self.starts[row] if row < len(self.starts) else np.inf

    def rate(self, t: float, x: Array) -> tuple[Array, Array]:
        """ẋ and the powers of actuators, wrenches and damping, under the law's forces and the loads.

        Raises as `Model.direct` where a leg's inverse geometry fails.
        """
        self._read(t, x)
        self._run()
        _, moved, powers, _, health = self.results
        singular.check_legs(self.robot, health)
        return moved, powers

    @property
    def differentiable(self) -> bool:
        """Whether its derivative is compiled: nobody is called, and the state carries no joints."""
        return self.alone and self.robot.layout.carried == 0

    def jacobian(self, t: float, x: Array) -> Array:
        """∂ẋ/∂x (size, size): exact where the law is differentiable, else by differences."""
        if not self.differentiable:
            return differences(lambda x: self.rate(t, x)[0].copy(), x)
        run, found = self._slopes
        self._read(t, x)
        run()
        return found.reshape(len(x), len(x))

    def forces(self, t: float, x: Array) -> Array:
        """Γ (m,) at a time and flat state."""
        self.rate(t, x)
        return self.results[0].copy()

    def at(self, t: Array, x: Array) -> Motion:
        """Forces and motion at times (T,) and flat states (T, size); not numbers where they fail."""
        rows = at_times(self.row, t, x, self.rows.shape[1])
        applied = self.loads.at(t, x)
        u, moved, _, f, _ = self.function.each(x, t[:, None], rows, applied, self.loads.pushes)
        return Motion(u, moved, f, applied + self.loads.constant(x))

    @cached_property
    def _slopes(self) -> tuple[Trigger, Array]:
        """The compiled Jacobian, and where it leaves its answer."""
        function = self._build_jacobian()
        found = np.zeros(function.kernel.outputs[0])
        return function.bind(self.inputs, [found]), found

    def _read(self, t: float, x: Array) -> None:
        """Fill the kernel's inputs."""
        own_x, own_t, own_row, own_w, _ = self.inputs
        own_row[:] = self.row(t, x)
        own_x[:], own_t[0], own_w[:] = x, t, self.loads(t, x)

    def watch(self, x: Array) -> tuple[int, str]:
        """How many of the flat states (T, size) of a motion come before it crosses a singularity, and
        which that is; all of them where it crosses none, or the law does not mind."""
        return len(x), ""

    def explain(self) -> str:
        """Why the motion may have failed after the last call; empty where the law knows nothing."""
        return ""


class Controller(ABC):
    """Actuator forces as a function of time and state."""

    model: "Model"
    trajectory: Trajectory | None = None  # what the platform is to follow, for the record

    def __call__(self, t: float, state: State) -> Array:
        """Forces (m,) at a time and state."""
        model = self.model.of(state)
        return self.bind(model, Loads(model, ())).forces(t, model.flat(state))

    @abstractmethod
    def bind(self, model: "Model", loads: Loads) -> Law:
        """The law on flat vectors under loads, for one simulation."""


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

    def bind(self, model: "Model", loads: Loads) -> Law:
        same_model(self.model, model)
        return Tracking(model, loads, self)


class Tracking(Law):
    """Computed torque, which looks out for singularities of its output."""

    def __init__(self, model: "Model", loads: Loads, control: ComputedTorque) -> None:
        way, m = control.trajectory, model.robot.n_forces
        constant = np.concatenate([np.zeros(6) + part for part in (control.kp, control.kd)])
        constant = np.concatenate([constant, np.zeros(m) + control.preload])
        rows = np.hstack([way.segments, np.tile(constant, (len(way.segments), 1))])
        super().__init__(model, loads, motions.tracking, rows, way.starts[1:], control.output)
        self._watch = singular.Watch(model, control.output)
        self._square = control.output.size == m

    @property
    def differentiable(self) -> bool:
        return self._square and super().differentiable

    def watch(self, x: Array) -> tuple[int, str]:
        return self._watch.look(x)

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
        self.model.joints(self.reference)  # refuses a reference that the robot cannot take
        for name in ("kp", "kd", "forces"):
            value = finite(f"JointPD.{name}", getattr(self, name))
            if value.shape not in ((), (m,)):
                raise InputError(f"JointPD.{name} has shape {value.shape}; give one value, or ({m},)")
            object.__setattr__(self, name, value)

    def bind(self, model: "Model", loads: Loads) -> Law:
        same_model(self.model, model)
        wanted = model.function(kernels.actuators)(model.flat(self.reference))[0]
        constant = [np.zeros(len(wanted)) + part for part in (self.forces, self.kp, self.kd)]
        return Law(model, loads, motions.springs, np.concatenate([*constant, wanted]))


class Called(Law):
    """A caller's function (t, state) -> forces (m,)."""

    def __init__(self, model: "Model", loads: Loads, function: Callable[[float, State], ArrayLike]) -> None:
        super().__init__(model, loads, motions.steady, np.zeros(model.robot.n_forces))
        self._function, self._state = function, model.state

    @property
    def alone(self) -> bool:
        return False

    def row(self, t: float, x: Array) -> Array:
        found = finite("controller(t, state)", self._function(t, self._state(x)))
        m = self.robot.n_forces
        if found.shape != (m,):
            raise InputError(f"controller(t, state) gave shape {found.shape}; expected ({m},)")
        return found


def differences(function: Callable[[Array], Array], x: Array) -> Array:
    """∂function/∂x by steps of 1.5e-8 ahead."""
    from scipy.optimize import approx_fprime

    found: Array = approx_fprime(x, function)
    return found


def same_model(own: "Model", simulated: "Model") -> None:
    """A controller runs on the model it was made for."""
    if not simulated.is_of(own):
        raise InputError(
            "the controller was made for another model than the one simulated; make it with that model, or "
            "pass a function (t, state) -> forces that calls the other model's inverse"
        )


def as_law(model: "Model", given: Any, loads: Loads) -> Law:
    """The law of a controller, of given forces (m,), or of a callable (t, state) -> forces."""
    m = model.robot.n_forces
    if isinstance(given, Controller):
        return given.bind(model, loads)
    if callable(given):
        return Called(model, loads, given)
    constant = finite("forces_or_controller", given)
    if constant.shape != (m,):
        raise InputError(
            f"forces_or_controller has shape {constant.shape}; give forces ({m},), a Controller, or "
            f"a function (t, state) -> forces ({m},)"
        )
    return Law(model, loads, motions.steady, constant)
