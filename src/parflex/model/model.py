"""The dynamic models of a robot, on the backend of one's choice: the comfortable door."""

from collections.abc import Mapping, Sequence
from copy import copy
from functools import partial
from typing import Any

from numpy.typing import ArrayLike

from parflex.analysis import health, zero_dynamics
from parflex.base.array import Array
from parflex.base.check import broadcast_together
from parflex.kernels import models as kernels
from parflex.linear.inputs import Actuators
from parflex.linear.outputs import FramePose
from parflex.linear.signal import Input
from parflex.linear.signal import Output as Seen
from parflex.linear.system import LinearModel
from parflex.mechanics.cartesian import Cartesian, cartesian
from parflex.mechanics.energy import Energies, energies
from parflex.mechanics.ordering import by_attachment, by_leg
from parflex.mechanics.output import Output
from parflex.model import inputs, inverting
from parflex.model.carried_rest import carried_equilibrium
from parflex.model.core import legs_moved, made
from parflex.model.derivatives import direct_jacobian_of, inverse_jacobian_of
from parflex.model.flat import Compiled
from parflex.model.geometry import Geometry
from parflex.model.inputs import Floor, Values, Wrenches
from parflex.model.linearising import linearise
from parflex.model.renamed import renamed
from parflex.model.results import Accelerations, DirectJacobian, Forces, InverseJacobian, Reactions
from parflex.robot.base_motion import BaseMotion
from parflex.robot.robot import Robot
from parflex.robot.state import State


class Model(Geometry):
    """The direct and inverse dynamic models of a robot.

    backend is "numpy" (the readable reference), "vm" (CasADi's virtual machine), "native" (machine
    code by LLVM) or "auto", the fastest there is. Nothing is traced or compiled before the first call.
    Immutable, shared by threads.

    States must be on the closure of the legs, which for robots of fewer than six freedoms is a
    condition (`project` finds the nearest); joints that are carried in the state are closed here.
    parameters names numbers of the robot that may change without compiling anew, by Python's path to
    them (docs/parameters.md): "gravity", "legs[0].joints[2].M", "platform.payload[12]" … `direct`,
    `inverse` and their Jacobians take values for them, batches too; `with_parameters` makes the model of
    a robot that has other values. All else is at the robot's own.

    Raises InputError for an unknown backend or parameter.
    """

    def __init__(self, robot: Robot, backend: str = "auto", parameters: Sequence[str] = ()) -> None:
        self._core = made(robot, backend, parameters)

    @property
    def robot(self) -> Robot:
        """The robot, with the values of the parameters."""
        return self._core.robot

    @property
    def backend(self) -> str:
        """The name of the backend."""
        return self._core.functions.backend.name

    def __repr__(self) -> str:
        names = ", ".join(self.parameters)
        return f"Model: {self.backend}{names and f', parameters {names}'}\n  {self.robot!r}"

    @property
    def parameters(self) -> dict[str, Array]:
        """The values of the parameters, by name."""
        functions = self._core.functions
        return {item.name: value.copy() for item, value in functions.parameters.split(functions.theta)}

    def with_parameters(self, values: Mapping[str, ArrayLike]) -> "Model":
        """The model of the robot with other values of some parameters; it shares all compiled code.

        Raises InputError for names that are not among the parameters, a batch of values, and values
        that the robot itself would refuse.
        """
        theta = inputs.single_values(inputs.theta(self._core, values))
        other = copy(self)
        other._core = self._core.at(theta)
        return other

    def direct(
        self,
        state: State,
        forces: ArrayLike,
        wrenches: Wrenches = (),
        *,
        parameters: Values = None,
        base: Floor = None,
    ) -> Accelerations:
        """Accelerations and contact forces for given actuator forces (…, m) (Sec. 5.2).

        Leading axes of state, forces, wrenches, values of parameters and base broadcast. Where contact forces
        are not unique (see `mobility`) they are the shortest. A base is the motion of the floor; the state is
        in the world then as well.

        Raises InputError for wrong shapes and states off the closure, OutOfReach and SingularPose
        where a leg's inverse geometry fails or the closure loses a row.
        """
        core = self._core.on(base)
        x, u = core.flat(state), inputs.forces(core, forces)
        load, theta = inputs.load(core, state, wrenches), inputs.theta(core, parameters)
        broadcast_together(state=x, forces=u, wrenches=load, parameters=theta)
        found = core.functions(kernels.direct, theta=theta).run(x=x, forces=u, load=load)
        core.check(x, found["health"])
        health.check_finite(found["platform"])
        contact = by_attachment(core.mechanism, found["contact"])
        legs = partial(legs_moved, core, state, u, contact, theta)
        return Accelerations(found["platform"], found["elastic"], contact).with_legs(legs)

    def inverse(
        self,
        state: State,
        target: ArrayLike,
        output: Output | None = None,
        wrenches: Wrenches = (),
        *,
        preload: ArrayLike | None = None,
        parameters: Values = None,
        legs: str = "moving",
        allow_ill_posed: bool = False,
        base: Floor = None,
    ) -> Forces:
        """Actuator forces for a wanted acceleration (…, o) of the output (Sec. 5.1).

        The output is all of V̇_p by default; with fewer freedoms name independent rows,
        `FrameOutput(rows=…)`, or a material point, `PointOutput`, or the actuated joints, `JointOutput`. With
        more actuators than outputs the forces are the nearest to preload (…, m), by default the shortest.

        With legs="static" flexible legs bend under their loads and do not swing: the answer says how
        (`leg_elastic`), and a state bent like that, at rest in its bend, gets the target from `direct`. Legs
        that would buckle under it are told by `equilibrium`, not here.

        Raises InputError for wrong shapes, states off the closure, fewer actuators than outputs, or where
        legs that bend leave less than half of a gain, unless allow_ill_posed; OutOfReach, NotConverged
        (static legs), and SingularPose: of a leg, of J_p⁻¹, or dynamic. Warns (DynamicSingularity)
        beyond a dynamic singularity, where the platform accelerates against its actuators.
        """
        core = self._core.on(base)
        asked = inverting.wanted(core, state, target, output, wrenches, preload, parameters)
        return inverting.inverse(core, asked, legs, allow_ill_posed)

    def direct_jacobian(
        self,
        state: State,
        forces: ArrayLike,
        wrenches: Wrenches = (),
        *,
        parameters: Values = None,
        base: Floor = None,
    ) -> DirectJacobian:
        """Derivatives of the accelerations of `direct` by state, forces, loads, parameters and base; exact.

        The wrenches are held in the frame they are given in. The derivatives are those of the formulas:
        for robots of fewer freedoms they hold for motions that the closure allows.

        Raises as `direct`, and InputError for a batch of wrenches.
        """
        return direct_jacobian_of(self._core.on(base), state, forces, wrenches, parameters)

    def inverse_jacobian(
        self,
        state: State,
        target: ArrayLike,
        output: Output | None = None,
        wrenches: Wrenches = (),
        *,
        parameters: Values = None,
        base: Floor = None,
    ) -> InverseJacobian:
        """Derivatives of the forces of `inverse` by state, target and base; exact.

        Ill-posed outputs are differentiated as they are. Raises as `inverse` otherwise, and InputError for a
        batch of wrenches, and where the output has not as many rows as there are actuators.
        """
        return inverse_jacobian_of(self._core.on(base), state, target, output, wrenches, parameters)

    def cartesian(self, state: State) -> Cartesian:
        """The Cartesian form A V̇_p + c = J_sys⁻ᵀ Γ of Eqs. 44–49.

        Raises InputError where a leg has not as many joints as contact force components, or no J⁻¹.
        """
        return cartesian(self._core.mechanism, self._core.system(state).x)[0]

    def joint_accelerations(
        self, state: State, forces: ArrayLike, wrenches: Wrenches = (), *, base: Floor = None
    ) -> tuple[Array, ...]:
        """q̈ (…, n_i) of each leg under given actuator forces (…, m); m/s² and rad/s²; raises as `direct`."""
        return self.direct(state, forces, wrenches, base=base).leg_joints

    def reactions(
        self, state: State, forces: ArrayLike, wrenches: Wrenches = (), *, base: Floor = None
    ) -> Reactions:
        """Forces and moments at every joint of the legs under given actuator forces (…, m).

        Raises as `direct`.
        """
        contact = self.direct(state, forces, wrenches, base=base).contact_forces
        pairs = legs_moved(self._core.on(base), state, forces, contact).reactions
        return Reactions(*(by_leg(self._core.mechanism, [p[i] for p in pairs], core=2) for i in (0, 1)))

    def energies(self, state: State, *, base: Floor = None) -> Energies:
        """Kinetic, gravitational and strain energy of the robot in the world, and that of its springs."""
        return energies(self._core.on(base).system(state))

    def output_report(self, state: State, output: Output | None = None) -> zero_dynamics.OutputReport:
        """The report on how well the actuators command an output about the equilibrium in a pose.

        The report gives the conditioning, what bending makes of the gains, and the poles of the
        elastic zero dynamics: the motion of the modes while the output is held.

        Raises InputError for a batch, and as `equilibrium` and `inverse` do.
        """
        health.single("state", self._core.flat(state))
        return zero_dynamics.output_report(self._core.functions, state, inputs.commanded(self._core, output))

    def equilibrium(
        self,
        position: ArrayLike | None = None,
        rotation: ArrayLike | None = None,
        *,
        forces: ArrayLike | None = None,
        guess: State | None = None,
        wrenches: Wrenches = (),
        parameters: Values = None,
        base: Floor = None,
    ) -> tuple[State, Array]:
        """The equilibrium under gravity, springs and wrenches at a pose of Σp: the state, platform and legs
        bent, and the forces (…, m) that hold it; or the one under given forces (…, m) that is found from a
        guess at rest, by default home.

        Leading axes of position (…, 3) m, rotation (…, 3, 3), forces, guess, wrenches, values of parameters
        and base broadcast. Many at once take a small part of the time of each by itself; code is compiled
        for 64 and more. Where the legs do not allow the pose with the platform bent, it is the nearest they
        allow. On a base that accelerates steadily the state goes with it.

        Raises InputError for bases that turn, OutOfReach and SingularPose as `direct`, NotConverged where
        nothing is found near, where no forces hold the platform, where it is too soft for a small deflection
        or a leg buckles. Of a batch the first that fails is told, with its index and how many do.
        """
        asked = position, rotation, forces, guess, wrenches, parameters
        return carried_equilibrium(self._core, base, *asked)

    def linearise(
        self,
        state: State,
        forces: ArrayLike,
        *,
        inputs: Sequence[Input] = (Actuators(),),
        outputs: Sequence[Seen] = (FramePose(),),
        wrenches: Wrenches = (),
        friction: str = "viscous",
        controller: Any = None,
        base: BaseMotion | None = None,
        parameters: Values = None,
    ) -> LinearModel:
        """The small motions about an equilibrium as a linear system in minimal coordinates, exact, with what
        preload and gravity do to the stiffness.

        state and forces (m,) are those of `equilibrium`. Coulomb friction is left out ("viscous"), smoothed
        as it is ("smoothed"), or holds its joints ("stuck"). A controller with gains kp, kd and ki closes the
        loop of the actuated joints, its force added to the inputs'; "locked" holds them where they are. On a
        base that accelerates steadily all is seen from it, in its axes.

        Raises InputError where the state moves or is no equilibrium, for a signal that the robot does not
        have, a controller without gains, a motion without inertia, and batches.
        """
        given = (inputs, outputs, wrenches, friction, controller, base, parameters)
        return linearise(self._core, state, forces, *given)

    static = renamed("static", equilibrium)

    def compiled(self, output: Output | None = None) -> Compiled:
        """The models on flat arrays, without allocation; one per thread.

        The inverse model prescribes the output, all of V̇_p by default. Raises InputError for an
        output that the platform does not have.
        """
        return Compiled(self._core, inputs.output_of(self._core, output))
