"""The dynamic models of a robot, on the backend of one's choice: the comfortable door."""

import warnings
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import wraps
from threading import Lock
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from parflex import assembly, cartesian, closure, geometry, singular
from parflex.answers import Accelerations, Forces, Legs, Reactions, by_attachment, by_leg, legs_of
from parflex.array import Array
from parflex.branches import on_branches, other_branches
from parflex.cartesian import Cartesian
from parflex.check import exactly, finite, integer, of_type
from parflex.compiled import choose, kernels
from parflex.compiled.backend import Function
from parflex.compiled.flat import Compiled
from parflex.compiled.kernels import Kernel
from parflex.errors import DynamicSingularity, InputError, NotConverged
from parflex.mobility import Mobility, mobility, reached
from parflex.output import FrameOutput, Output
from parflex.robot import Robot
from parflex.state import State, Wrench, coordinates, unpack
from parflex.wrench import generalised_force

if TYPE_CHECKING:
    from parflex.zero_dynamics import OutputReport


Answer = TypeVar("Answer")


def on_branch(method: Callable[..., Answer]) -> Callable[..., Answer]:
    """The method, on the assembly branch that its state names."""

    @wraps(method)
    def redirected(self: "Model", state: State, *given: Any, **named: Any) -> Answer:
        return method(self.of(state), state, *given, **named)

    return redirected


class Model:
    """The direct and inverse dynamic models of a robot.

    backend is "numpy" (the readable reference), "vm" (CasADi's virtual machine) or "auto", the
    fastest there is. Nothing is traced before the first call. Immutable, shared by threads.

    States must be on the closure of the legs, which for robots of fewer than six freedoms is a
    condition (`project` finds the nearest); joints that are carried in the state are closed here.

    Raises InputError for an unknown backend.
    """

    def __init__(self, robot: Robot, backend: str = "auto") -> None:
        self.robot = robot
        self.backend = choose(backend)
        self._functions: dict[object, Function] = {}
        self._siblings: dict[tuple[int, ...], Model] = {}
        self._origin: Model | None = None
        self._lock = Lock()

    @on_branch
    def direct(self, state: State, forces: ArrayLike, wrenches: Sequence[Wrench] = ()) -> Accelerations:
        """Accelerations and contact forces for given actuator forces (…, m) (Sec. 5.2).

        Leading axes of state, forces and wrenches broadcast. Where contact forces are not unique
        (see `mobility`) they are the shortest.

        Raises InputError for wrong shapes and states off the closure, OutOfReach and SingularPose
        where a leg's inverse geometry fails or the closure loses a row.
        """
        x = self.flat(state)
        u = finite("forces", forces, (self.robot.n_forces,))
        w = generalised_force(self.robot.platform, state, wrenches)
        check_batch(x, u, w, "forces")
        Vd, qdd_e, f, health = self.function(kernels.direct)(x, u, w)
        self.check(x, health)
        singular.check_finite(Vd)
        return Accelerations(Vd, qdd_e, by_attachment(self.robot, f))

    @on_branch
    def inverse(
        self,
        state: State,
        target: ArrayLike,
        output: Output | None = None,
        wrenches: Sequence[Wrench] = (),
        preload: ArrayLike | None = None,
    ) -> Forces:
        """Actuator forces for a wanted acceleration (…, o) of the output (Sec. 5.1).

        The output is all of V̇_p by default; with fewer freedoms name independent rows,
        `FrameOutput(rows=…)`, or a material point, `PointOutput`. With more actuators than outputs
        the forces are the nearest to preload (…, m), by default the shortest.

        Raises InputError for wrong shapes, states off the closure, or fewer actuators than outputs,
        OutOfReach, and SingularPose: of a leg, of J_p⁻¹, or dynamic. Warns (DynamicSingularity)
        beyond a dynamic singularity, where the platform accelerates against its actuators.
        """
        output = self._output(output)
        x, m = self.flat(state), self.robot.n_forces
        wanted = finite("target", target, (output.size,))
        w = generalised_force(self.robot.platform, state, wrenches)
        bias = np.zeros(m) if preload is None else finite("preload", preload, (m,))
        check_batch(x, wanted, w, "target", bias)
        found = self.function(kernels.inverse, output)(x, wanted, w, bias)
        forces, Vd, qdd_e, f, gain, health = found
        self.check(x, health)
        singular.check_finite(gain)
        rigid = self.function(kernels.gains, output)(x)[1]
        beyond = singular.check_gain(self.robot, output, *singular.spread(x, gain, rigid))
        if np.any(beyond):
            warnings.warn(singular.beyond_words(beyond), DynamicSingularity, stacklevel=2)
        return Forces(forces, qdd_e, Vd, by_attachment(self.robot, f))

    @on_branch
    def cartesian(self, state: State) -> Cartesian:
        """The Cartesian form A V̇_p + c = J_sys⁻ᵀ Γ of Eqs. 44–49.

        Raises InputError where a leg has not as many joints as contact force components.
        """
        return cartesian.cartesian(self.robot, self._system(state).x)[0]

    @on_branch
    def legs(self, state: State) -> Legs:
        """Joint positions and rates of the legs: inverse geometry and kinematics."""
        return legs_of(self.robot, self._system(state))

    @on_branch
    def joint_accelerations(
        self, state: State, forces: ArrayLike, wrenches: Sequence[Wrench] = ()
    ) -> tuple[Array, ...]:
        """q̈ (…, n_i) of each leg under given actuator forces (…, m); m/s² and rad/s².

        Raises as `direct`.
        """
        system, u, f = self._driven(state, forces, wrenches)
        return by_leg(self.robot, assembly.joint_accelerations(self.robot, system, u, f))

    @on_branch
    def reactions(self, state: State, forces: ArrayLike, wrenches: Sequence[Wrench] = ()) -> Reactions:
        """Forces and moments at every joint of the legs under given actuator forces (…, m).

        Raises as `direct`.
        """
        system, u, f = self._driven(state, forces, wrenches)
        qdd = assembly.joint_accelerations(self.robot, system, u, f)
        force, moment = zip(*assembly.joint_reactions(self.robot, system, qdd, f), strict=True)
        return Reactions(by_leg(self.robot, force, core=2), by_leg(self.robot, moment, core=2))

    @on_branch
    def mobility(self, state: State) -> Mobility:
        """Freedoms, redundant constraints, and singularities of both kinds with their directions.

        Raises InputError for a batch or a state off the closure, OutOfReach.
        """
        x = reached(self.robot, self._single("state", self.flat(state)))
        health = self._assembled(x)[1]
        singular.check_reach(self.robot, health)
        singular.check_gaps(self.robot, health)
        return mobility(self.robot, x)

    @on_branch
    def output_report(self, state: State, output: Output | None = None) -> "OutputReport":
        """How well the actuators command an output about the equilibrium in a pose.

        The report gives the conditioning, what bending makes of the gains, and the poles of the
        elastic zero dynamics: the motion of the modes while the output is held.

        Raises InputError for a batch, and as `static` and `inverse` do.
        """
        from parflex.zero_dynamics import output_report

        self._single("state", self.flat(state))
        return output_report(self, state, self._output(output))

    @on_branch
    def project(self, state: State) -> State:
        """The state on the closure nearest to a state: what the legs allow.

        The platform's pose and twist are moved, and its bend only where they do not suffice.

        Raises NotConverged where there is none near, OutOfReach where a leg does not reach its tip
        at the given one.
        """
        return self.state(self._projected(state))

    def pose(self, joints: ArrayLike, guess: State | None = None, sag: bool = False) -> State:
        """Forward geometry: the state at rest whose actuated joints are as given (m,), m and rad.

        It is looked for from the guess, by default home, with the guess's bend; with sag the
        platform bends under its own weight.

        Raises NotConverged where no pose is found from there.
        """
        from parflex.statics import equilibrium

        wanted = exactly("joints", joints, (self.robot.n_forces,))
        if guess is not None and self.of(guess) is not self:
            return self.of(guess).pose(joints, guess, sag)
        x = self._guess(guess)
        if not sag:
            return self.state(geometry.pose(self, wanted, x))
        N = self.robot.platform.modes
        bent = lambda q_e: geometry.pose(self, wanted, np.concatenate([x[:13], q_e, x[13 + N :]]))  # noqa: E731
        return self.state(equilibrium(self, bent)[0])

    def poses(
        self, joints: ArrayLike, guess: State | None = None, starts: int = 200, seed: int = 0
    ) -> list[State]:
        """All poses found whose actuated joints are as given (m,), the nearest to the guess first.

        Newton's method is started at the guess and at random about it; on the branches of the legs'
        inverse geometry that the robot states. An empty list says that none was found.
        """
        wanted = exactly("joints", joints, (self.robot.n_forces,))
        if guess is not None and self.of(guess) is not self:
            return self.of(guess).poses(joints, guess, starts, seed)
        x = self._guess(guess)
        found = geometry.every_pose(self, wanted, x, integer("starts", starts, 1), seed)
        return [self.state(one) for one in found]

    def static(self, position: ArrayLike, rotation: ArrayLike) -> tuple[State, Array]:
        """The equilibrium under gravity at a pose of Σp: the bent platform, and the forces (m,).

        Where the legs do not allow the pose with the platform bent, it is the nearest they allow.

        Raises NotConverged where the platform is too soft for a small deflection.
        """
        return self.at_rest("position and rotation", State(position, rotation))

    def compiled(self, output: Output | None = None) -> Compiled:
        """The models on flat arrays, without allocation; one per thread.

        The inverse model prescribes the output, all of V̇_p by default. Raises InputError for an
        output that the platform does not have.
        """
        output = FrameOutput() if output is None else output
        of_type("output", output, Output, "an")
        output.check(self.robot.platform)
        return Compiled(self, output)

    def function(self, build: Callable[..., Kernel], *chosen: object) -> Function:
        """A kernel of `compiled.kernels`, compiled at first use."""
        with self._lock:
            key = (build, *chosen)
            if key not in self._functions:
                kernel = build(self.robot, *chosen)
                self._functions[key] = self.backend.compile(kernel)
            return self._functions[key]

    def of(self, state: State) -> "Model":
        """This model, or one on the assembly branch that a state names by its joints where the legs
        have no posture."""
        if not isinstance(state, State) or state.joints is None:
            return self
        closure.check_joints(self.robot, state)
        numbers = other_branches(self.robot, state.joints)
        if not numbers:
            return self
        with self._lock:
            if numbers not in self._siblings:
                sibling = Model(on_branches(self.robot, numbers, state.joints), self.backend.name)
                sibling._origin = self
                self._siblings[numbers] = sibling
            return self._siblings[numbers]

    def is_of(self, other: "Model") -> bool:
        """Whether this is the other model, or one of its branches."""
        return self is other or self._origin is other

    def state(self, x: Array) -> State:
        """The state of a flat vector; with all joints where they name the branch."""
        found = unpack(x, self.robot.layout)
        if self._origin is None:
            return found
        legs = legs_of(self.robot, self._assembled(np.asarray(x, dtype=float))[0])
        return replace(found, joints=legs.q, joint_rates=legs.qd)

    def flat(self, state: State) -> Array:
        """The flat state (…, size); joints that it carries are closed by Newton's method."""
        return closure.flat_state(self.robot, state)

    def _output(self, output: Output | None) -> Output:
        """The output, all of V̇_p by default, checked against the robot."""
        output = FrameOutput() if output is None else output
        of_type("output", output, Output, "an")
        output.check(self.robot.platform)
        if self.robot.n_forces < output.size:
            raise InputError(
                f"output asks for {output.size} accelerations, but the robot has "
                f"{self.robot.n_forces} actuators; name as many with FrameOutput(rows=…)"
            )
        return output

    def at_rest(self, name: str, state: State) -> tuple[State, Array]:
        """The equilibrium at the pose of a state, the joints it names as a start."""
        from parflex.statics import equilibrium

        layout = self.robot.layout
        pose = State(state.position, state.rotation, joints=state.joints)
        start = self._single(name, self._projected(pose))
        self.check(start, self.function(kernels.direct)(start, *self._nothing())[-1])
        N = layout.modes

        def bent(q_e: Array) -> Array:
            held = np.concatenate([start[:13], q_e, start[13 + N :]])
            return closure.projected(self.robot, unpack(held, layout))

        x, forces = equilibrium(self, bent)
        return self.state(x), forces

    def _projected(self, state: State) -> Array:
        """The flat state on the closure; where there is none, which leg does not reach."""
        try:
            return closure.projected(self.robot, state)
        except NotConverged:
            singular.check_legs(self.robot, self._assembled(self.flat(state))[1])
            raise

    def check(self, x: Array, health: Array) -> None:
        """Raise where a flat state is none, or the closure loses a row there."""
        singular.check_health(self.robot, health)
        if not all(group.closed for group in self.robot.groups):
            singular.check_locking(self.robot, self.function(kernels.contact_matrix)(x)[0])

    def _guess(self, guess: State | None) -> Array:
        """The flat state at rest to look for poses from, by default home."""
        start = self.robot.home if guess is None else guess
        of_type("guess", start, State)
        return self._single("guess", closure.flat_state(self.robot, replace_twist(start)))

    def _single(self, name: str, x: Array) -> Array:
        if x.ndim > 1:
            raise InputError(f"{name} is a batch {x.shape[:-1]}; give one state at a time")
        return x

    def _nothing(self) -> tuple[Array, Array]:
        """No actuator forces and no loads."""
        return np.zeros(self.robot.n_forces), np.zeros(6 + self.robot.platform.modes)

    def _system(self, state: State) -> assembly.System:
        """The mechanics at a checked state."""
        system, health = self._assembled(self.flat(state))
        singular.check_health(self.robot, health)
        return system

    def _assembled(self, x: Array) -> tuple[assembly.System, Array]:
        """The mechanics at a flat state, and its health."""
        with np.errstate(invalid="ignore", divide="ignore"):
            system = assembly.assemble(self.robot, coordinates(x, self.robot.layout))
            return system, assembly.health(system)

    def _driven(
        self, state: State, forces: ArrayLike, wrenches: Sequence[Wrench]
    ) -> tuple[assembly.System, Array, Array]:
        """The mechanics at a state, the forces Γ (…, m), and the contact forces (…, 3k) they cause."""
        self.direct(state, forces, wrenches)
        x, u = self.flat(state), np.asarray(forces, dtype=float)
        w = generalised_force(self.robot.platform, state, wrenches)
        return self._system(state), u, self.function(kernels.direct)(x, u, w)[2]


def check_batch(x: Array, second: Array, w: Array, name: str, preload: Array | None = None) -> None:
    """The leading axes of state, second argument, wrenches and preload must broadcast."""
    shapes = {"state": x, name: second, "wrenches": w} | ({} if preload is None else {"preload": preload})
    try:
        np.broadcast_shapes(*(a.shape[:-1] for a in shapes.values()))
    except ValueError:
        said = ", ".join(f"{a.shape[:-1]} of {what}" for what, a in shapes.items())
        raise InputError(f"the leading (batch) axes are {said}; they must broadcast together") from None


def replace_twist(state: State) -> State:
    """The state at rest."""
    return State(state.position, state.rotation, elastic=state.elastic, joints=state.joints)
