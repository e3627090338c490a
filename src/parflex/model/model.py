"""The dynamic models of a robot, on the backend of one's choice: the comfortable door."""

import warnings
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import replace
from threading import Lock

import numpy as np
from numpy.typing import ArrayLike

from parflex.analysis import search
from parflex.analysis import singularities as singular
from parflex.analysis.mobility import Mobility, mobility, reached
from parflex.analysis.zero_dynamics import OutputReport, output_report
from parflex.base.array import Array
from parflex.base.check import broadcast_together, finite, of_type
from parflex.base.errors import DynamicSingularity, InputError
from parflex.compiled import choose
from parflex.compiled.at import At
from parflex.compiled.backend import Function
from parflex.kernels import jacobians
from parflex.kernels import models as kernels
from parflex.kernels.kernel import Kernel
from parflex.kernels.parametrised import parametrised
from parflex.mechanics import cartesian, closure
from parflex.mechanics import system as assembly
from parflex.mechanics.cartesian import Cartesian
from parflex.mechanics.designs import rebuilt
from parflex.mechanics.dynamics import Acceleration
from parflex.mechanics.energy import Energies, energies
from parflex.mechanics.ordering import Joints, by_attachment, by_leg, by_rows, joints_of
from parflex.mechanics.output import FrameOutput, Output
from parflex.mechanics.system import System, examined
from parflex.mechanics.wrench import generalised_force, places_of, pushes_of
from parflex.model.family import Family, on_branch
from parflex.model.flat import Compiled
from parflex.model.renamed import renamed
from parflex.model.results import Accelerations, DirectJacobian, Forces, InverseJacobian, Reactions
from parflex.robot.layout import unpack
from parflex.robot.parameters import Parameters
from parflex.robot.robot import Robot
from parflex.robot.state import State
from parflex.robot.wrench import Wrench


class Model:
    """The direct and inverse dynamic models of a robot.

    backend is "numpy" (the readable reference), "vm" (CasADi's virtual machine) or "auto", the
    fastest there is. Nothing is traced before the first call. Immutable, shared by threads.

    States must be on the closure of the legs, which for robots of fewer than six freedoms is a
    condition (`project` finds the nearest); joints that are carried in the state are closed here.

    parameters names numbers of the robot that may change without compiling anew, by Python's path to
    them (docs/parameters.md): "gravity", "legs[0].joints[2].M", "platform.payload[12]" … `direct` and
    `inverse` take values for them, batches too; `with_parameters` makes the model of a robot that has
    other values. All else is at the robot's own.

    Raises InputError for an unknown backend or parameter.
    """

    def __init__(self, robot: Robot, backend: str = "auto", parameters: Sequence[str] = ()) -> None:
        self.robot = robot
        self.backend = choose(backend)
        self._parameters = Parameters(robot, parameters)
        self._theta = self._parameters.own
        self._functions: dict[object, Function] = {}
        self._lock = Lock()
        self.family = Family(self)

    def __repr__(self) -> str:
        names = ", ".join(self.parameters)
        return f"Model: {self.backend.name}{names and f', parameters {names}'}\n  {self.robot!r}"

    @property
    def parameters(self) -> dict[str, Array]:
        """The values of the parameters, by name."""
        return {item.name: value.copy() for item, value in self._parameters.split(self._theta)}

    def with_parameters(self, values: Mapping[str, ArrayLike]) -> "Model":
        """The model of the robot with other values of some parameters; it shares all compiled code.

        Raises InputError for names that are not among the parameters, a batch of values, and values
        that the robot itself would refuse.
        """
        theta = self._parameters.vector(values, self._theta)
        if theta.ndim > 1:
            raise InputError(
                f"parameters are a batch {theta.shape[:-1]}; a model has one value of each: pass batches to "
                f"model.direct or model.inverse"
            )
        other = copy(self)
        other.robot, other._theta = rebuilt(self._parameters, theta), theta
        other.family = Family(other, self.family)
        return other

    @on_branch
    def direct(
        self,
        state: State,
        forces: ArrayLike,
        wrenches: Sequence[Wrench] = (),
        parameters: Mapping[str, ArrayLike] | None = None,
    ) -> Accelerations:
        """Accelerations and contact forces for given actuator forces (…, m) (Sec. 5.2).

        Leading axes of state, forces, wrenches and values of parameters broadcast. Where contact forces
        are not unique (see `mobility`) they are the shortest.

        Raises InputError for wrong shapes and states off the closure, OutOfReach and SingularPose
        where a leg's inverse geometry fails or the closure loses a row.
        """
        _, _, (Vd, qdd_e, f) = self._moved(state, forces, wrenches, parameters)
        return Accelerations(Vd, qdd_e, by_attachment(self.robot, f))

    @on_branch
    def inverse(
        self,
        state: State,
        target: ArrayLike,
        output: Output | None = None,
        wrenches: Sequence[Wrench] = (),
        preload: ArrayLike | None = None,
        parameters: Mapping[str, ArrayLike] | None = None,
    ) -> Forces:
        """Actuator forces for a wanted acceleration (…, o) of the output (Sec. 5.1).

        The output is all of V̇_p by default; with fewer freedoms name independent rows,
        `FrameOutput(rows=…)`, or a material point, `PointOutput`. With more actuators than outputs
        the forces are the nearest to preload (…, m), by default the shortest.

        Raises InputError for wrong shapes, states off the closure, or fewer actuators than outputs,
        OutOfReach, and SingularPose: of a leg, of J_p⁻¹, or dynamic. Warns (DynamicSingularity)
        beyond a dynamic singularity, where the platform accelerates against its actuators.
        """
        output = self._commanded(output)
        x, m = self.flat(state), self.robot.n_forces
        wanted = finite("target", target, (output.size,))
        w = generalised_force(self.robot.platform, state, wrenches)
        bias = np.zeros(m) if preload is None else finite("preload", preload, (m,))
        theta = self._values(parameters)
        broadcast_together(state=x, target=wanted, wrenches=w, preload=bias, parameters=theta)
        function = self.function(kernels.inverse, output, at=theta)
        forces, Vd, qdd_e, f, gain, health = function.run(x, wanted, w, bias)
        self.check(x, health)
        singular.check_finite(gain)
        rigid = self.function(kernels.gains, output, at=theta).run(x)[1]
        beyond = singular.check_gain(self.robot, output, *singular.spread(x, gain, rigid))
        if np.any(beyond):
            warnings.warn(singular.beyond_words(beyond), DynamicSingularity, stacklevel=3)
        return Forces(forces, qdd_e, Vd, by_attachment(self.robot, f))

    @on_branch
    def direct_jacobian(
        self, state: State, forces: ArrayLike, wrenches: Sequence[Wrench] = ()
    ) -> DirectJacobian:
        """Derivatives of the accelerations of `direct` by state, forces, loads and parameters; exact.

        The wrenches are held in the frame they are given in. The derivatives are those of the formulas:
        for robots of fewer freedoms they hold for motions that the closure allows.

        Raises as `direct`, and InputError for a batch of wrenches.
        """
        x = self.flat(state)
        u = finite("forces", forces, (self.robot.n_forces,))
        given = self._jacobian_inputs(x, state, wrenches, forces=u)
        places = places_of(wrenches)
        *found, health = self.function(jacobians.direct_jacobian, places)(x, u, *given)
        self.check(x, health)
        by_parameter = np.zeros((*found[0].shape[:-1], 0))
        if self._parameters.items:
            by_parameter = self.function(jacobians.parameter_jacobian, places)(x, u, *given)[0]
        rows = 6 + self.robot.platform.modes
        return DirectJacobian(*(by_rows(part, rows) for part in (*found, by_parameter)))

    @on_branch
    def inverse_jacobian(
        self,
        state: State,
        target: ArrayLike,
        output: Output | None = None,
        wrenches: Sequence[Wrench] = (),
    ) -> InverseJacobian:
        """Derivatives of the forces of `inverse` by state and target; exact.

        Raises as `inverse`, and InputError for a batch of wrenches, and where the output has not as many
        rows as there are actuators.
        """
        output, m = self._commanded(output), self.robot.n_forces
        if output.size != m:
            raise InputError(
                f"output has {output.size} rows and the robot {m} actuators; the derivative is known for "
                f"as many rows as actuators: choose another output"
            )
        x, wanted = self.flat(state), finite("target", target, (m,))
        given = self._jacobian_inputs(x, state, wrenches, target=wanted)
        run = self.function(jacobians.inverse_jacobian, output, places_of(wrenches))
        *found, health = run(x, wanted, *given)
        self.check(x, health)
        singular.check_finite(found[0])
        return InverseJacobian(*(by_rows(part, m) for part in found))

    @on_branch
    def cartesian(self, state: State) -> Cartesian:
        """The Cartesian form A V̇_p + c = J_sys⁻ᵀ Γ of Eqs. 44–49.

        Raises InputError where a leg has not as many joints as contact force components.
        """
        return cartesian.cartesian(self.robot, self.system(state).x)[0]

    @on_branch
    def joints(self, state: State) -> Joints:
        """Joint positions and rates of the legs: inverse geometry and kinematics."""
        return joints_of(self.robot, self.system(state))

    @on_branch
    def joint_accelerations(
        self, state: State, forces: ArrayLike, wrenches: Sequence[Wrench] = ()
    ) -> tuple[Array, ...]:
        """q̈ (…, n_i) of each leg under given actuator forces (…, m); m/s² and rad/s².

        Raises as `direct`.
        """
        return by_leg(self.robot, self._joints_moved(state, forces, wrenches)[1])

    @on_branch
    def reactions(self, state: State, forces: ArrayLike, wrenches: Sequence[Wrench] = ()) -> Reactions:
        """Forces and moments at every joint of the legs under given actuator forces (…, m).

        Raises as `direct`.
        """
        system, qdd, f = self._joints_moved(state, forces, wrenches)
        force, moment = zip(*assembly.joint_reactions(self.robot, system, qdd, f), strict=True)
        return Reactions(by_leg(self.robot, force, core=2), by_leg(self.robot, moment, core=2))

    @on_branch
    def energies(self, state: State) -> Energies:
        """Kinetic, gravitational and strain energy of the robot, and that of its joints' springs."""
        return energies(self.robot, self.system(state))

    @on_branch
    def mobility(self, state: State) -> Mobility:
        """Freedoms, redundant constraints, and singularities of both kinds with their directions.

        Raises InputError for a batch or a state off the closure, OutOfReach.
        """
        x = reached(self.robot, search.single("state", self.flat(state)))
        health = examined(self.robot, x)[1]
        singular.check_reach(self.robot, health)
        singular.check_gaps(self.robot, health)
        return mobility(self.robot, x)

    @on_branch
    def output_report(self, state: State, output: Output | None = None) -> OutputReport:
        """How well the actuators command an output about the equilibrium in a pose.

        The report gives the conditioning, what bending makes of the gains, and the poles of the
        elastic zero dynamics: the motion of the modes while the output is held.

        Raises InputError for a batch, and as `equilibrium` and `inverse` do.
        """
        search.single("state", self.flat(state))
        return output_report(self, state, self._commanded(output))

    @on_branch
    def project(self, state: State) -> State:
        """The state on the closure nearest to a state: what the legs allow.

        The platform's pose and twist are moved, and its bend only where they do not suffice.

        Raises NotConverged where there is none near, OutOfReach where a leg does not reach its tip
        at the given one.
        """
        return self.state(search.on_closure(self.robot, state))

    def forward(self, joints: ArrayLike, guess: State | None = None, *, sag: bool = False) -> State:
        """Forward geometry: the state at rest whose actuated joints are as given (m,), m and rad.

        It is looked for from the guess, by default home, with the guess's bend; with sag the
        platform bends under its own weight.

        Raises NotConverged where no pose is found from there.
        """
        model = self.of(guess)
        return model.state(search.pose(model.robot, joints, guess, sag))

    def forward_all(
        self, joints: ArrayLike, guess: State | None = None, *, starts: int = 200, seed: int = 0
    ) -> list[State]:
        """All poses found whose actuated joints are as given (m,), the nearest to the guess first.

        Newton's method is started at the guess and at random about it; on the branches of the legs'
        inverse geometry that the robot states. An empty list says that none was found.
        """
        model = self.of(guess)
        return [model.state(x) for x in search.poses(model.robot, joints, guess, starts, seed)]

    def equilibrium(self, position: ArrayLike, rotation: ArrayLike) -> tuple[State, Array]:
        """The equilibrium under gravity at a pose of Σp: the bent platform, and the forces (m,).

        Where the legs do not allow the pose with the platform bent, it is the nearest they allow.

        Raises NotConverged where the platform is too soft for a small deflection.
        """
        x, forces = search.at_rest(self, "position and rotation", State(position, rotation))
        return self.state(x), forces

    legs = renamed("legs", joints)
    pose = renamed("pose", forward)
    poses = renamed("poses", forward_all)
    static = renamed("static", equilibrium)

    def compiled(self, output: Output | None = None) -> Compiled:
        """The models on flat arrays, without allocation; one per thread.

        The inverse model prescribes the output, all of V̇_p by default. Raises InputError for an
        output that the platform does not have.
        """
        return Compiled(self, self._output(output))

    def function(self, build: Callable[..., Kernel], *chosen: object, at: Array | None = None) -> Function:
        """What `build`, of `compiled.kernels` or `motions`, makes of the robot and of what else it takes.

        A function of flat float arrays (…, n_i), compiled by the backend at first use and kept; for
        parameters θ (…, P), by default the model's.
        """
        with self._lock:
            key = (build, *chosen)
            if key not in self._functions:
                self._functions[key] = self.backend.compile(self._kernel(build, *chosen))
            found = self._functions[key]
        if not self._parameters.items:
            return found
        return At(found, self._theta if at is None else at)

    @on_branch
    def system(self, state: State) -> System:
        """The mechanics at a state or a batch of them: legs, platform, closure.

        Raises InputError for a state off the closure, OutOfReach and SingularPose where a leg's inverse
        geometry fails.
        """
        system, health = examined(self.robot, self.flat(state))
        singular.check_health(self.robot, health)
        return system

    def of(self, state: State | None) -> "Model":
        """This model, or one on the assembly branch that the joints of a state name.

        They name the branches of legs without a posture.

        Raises InputError where the joints are not those of the legs.
        """
        if not isinstance(state, State) or state.joints is None:
            return self
        return self.family.on(state)

    def is_of(self, other: "Model") -> bool:
        """Whether this is the other model, or one of its branches."""
        return self is other or self.family.first is other

    def flat(self, state: State) -> Array:
        """The flat state (…, size); joints that it carries are closed by Newton's method.

        Raises InputError where the state does not fit the robot, or its joints are on another branch.
        """
        return closure.flat_state(self.robot, state)

    def state(self, x: Array) -> State:
        """The state of a flat vector (…, size); with all joints where they name the branch.

        Raises InputError for a wrong length, values that are not finite, or a quaternion of length zero.
        """
        found = unpack(x, self.robot.layout)
        if self.family.first is self:
            return found
        legs = joints_of(self.robot, examined(self.robot, np.asarray(x, dtype=float))[0])
        return replace(found, joints=legs.q, joint_rates=legs.qd)

    def check(self, x: Array, health: Array) -> None:
        """Nothing where the flat state (…, size), whose `assembly.health` (…, h) is given, is one.

        Raises OutOfReach and SingularPose where a leg's inverse geometry fails, InputError off the
        closure, SingularPose where the closure loses a row.
        """
        singular.check_health(self.robot, health)
        if not self.robot.closed:
            singular.check_locking(self.robot, self.function(kernels.contact_matrix).run(x)[0])

    def _kernel(self, build: Callable[..., Kernel], *chosen: object) -> Kernel:
        """The kernel, which takes θ where the model has parameters."""
        if not self._parameters.items:
            return build(self.robot, *chosen)
        if build is jacobians.parameter_jacobian:
            return build(self._parameters, *chosen)
        return parametrised(self._parameters, build, *chosen)

    def _jacobian_inputs(
        self, x: Array, state: State, wrenches: Sequence[Wrench], **argument: Array
    ) -> tuple[Array, Array]:
        """No generalised force, and single wrenches side by side (6 L,)."""
        w = generalised_force(self.robot.platform, state, wrenches)
        pushes = pushes_of(wrenches)
        if pushes.ndim > 1:
            raise InputError(f"wrenches are a batch {pushes.shape[:-1]}; derivatives take single ones")
        broadcast_together(state=x, **argument)
        return np.zeros(w.shape[-1]), pushes

    def _values(self, parameters: Mapping[str, ArrayLike] | None) -> Array:
        """θ (…, P), by default the model's."""
        return self._theta if parameters is None else self._parameters.vector(parameters, self._theta)

    def _output(self, output: Output | None) -> Output:
        """The output, all of V̇_p by default, checked against the platform."""
        output = FrameOutput() if output is None else output
        of_type("output", output, Output, "an")
        output.check(self.robot.platform)
        return output

    def _commanded(self, output: Output | None) -> Output:
        """The output, checked against the platform and the actuators."""
        output = self._output(output)
        if self.robot.n_forces < output.size:
            raise InputError(
                f"output asks for {output.size} accelerations, but the robot has "
                f"{self.robot.n_forces} actuators; name as many with FrameOutput(rows=…)"
            )
        return output

    def _moved(
        self,
        state: State,
        forces: ArrayLike,
        wrenches: Sequence[Wrench],
        parameters: Mapping[str, ArrayLike] | None = None,
    ) -> tuple[Array, Array, Acceleration]:
        """The direct model: the flat state and the forces (…, m), checked, and what they cause."""
        x = self.flat(state)
        u = finite("forces", forces, (self.robot.n_forces,))
        w = generalised_force(self.robot.platform, state, wrenches)
        theta = self._values(parameters)
        broadcast_together(state=x, forces=u, wrenches=w, parameters=theta)
        Vd, qdd_e, f, health = self.function(kernels.direct, at=theta).run(x, u, w)
        self.check(x, health)
        singular.check_finite(Vd)
        return x, u, Acceleration(Vd, qdd_e, f)

    def _joints_moved(
        self, state: State, forces: ArrayLike, wrenches: Sequence[Wrench]
    ) -> tuple[System, list[Array], Array]:
        """The mechanics at a state, q̈ (…, L, n) of each group, and the contact forces (…, 3k)."""
        x, u, (_, _, f) = self._moved(state, forces, wrenches)
        system = examined(self.robot, x)[0]
        return system, assembly.joint_accelerations(self.robot, system, u, f), f
