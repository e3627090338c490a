"""The dynamic models of a robot, on the backend of one's choice: the comfortable door."""

from collections.abc import Callable, Sequence
from threading import Lock
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from parflex import assembly, cartesian, singular
from parflex.array import Array
from parflex.cartesian import Cartesian
from parflex.check import finite, of_type
from parflex.compiled import choose, kernels
from parflex.compiled.backend import Function
from parflex.compiled.flat import Compiled
from parflex.compiled.kernels import Kernel
from parflex.errors import InputError
from parflex.output import FrameOutput
from parflex.robot import Robot
from parflex.state import Coordinates, State, Wrench, coordinates, pack
from parflex.wrench import generalised_force


class Accelerations(NamedTuple):
    """The direct model's answer, all in Σp.

    platform V̇_p (…, 6) m/s², rad/s²; elastic q̈_e (…, N); contact_forces (…, k, 3) N on the
    platform, by attachment.
    """

    platform: Array
    elastic: Array
    contact_forces: Array


class Forces(NamedTuple):
    """The inverse model's answer.

    forces Γ (…, m) N or N m; elastic q̈_e (…, N), platform V̇_p (…, 6) and contact_forces
    (…, k, 3) N that go with them, in Σp.
    """

    forces: Array
    elastic: Array
    platform: Array
    contact_forces: Array


class Legs(NamedTuple):
    """Joint positions and rates, one (…, n_i) per leg; m and rad."""

    q: tuple[Array, ...]
    qd: tuple[Array, ...]


class Model:
    """The direct and inverse dynamic models of a robot.

    backend is "numpy" (the readable reference), "vm" (CasADi's virtual machine) or "auto", the
    fastest there is. Nothing is traced before the first call. Immutable, shared by threads.

    Raises InputError for an unknown backend.
    """

    def __init__(self, robot: Robot, backend: str = "auto") -> None:
        self.robot = robot
        self.backend = choose(backend)
        self._functions: dict[object, Function] = {}
        self._lock = Lock()

    def direct(self, state: State, forces: ArrayLike, wrenches: Sequence[Wrench] = ()) -> Accelerations:
        """Accelerations and contact forces for given actuator forces (…, m) (Sec. 5.2).

        Leading axes of state, forces and wrenches broadcast. Raises InputError for wrong shapes,
        OutOfReach and SingularPose where a leg's inverse geometry fails.
        """
        x = self._pack(state)
        u = finite("forces", forces, (self.robot.n_forces,))
        w = generalised_force(self.robot.platform, state, wrenches)
        check_batch(x, u, w, "forces")
        Vd, qdd_e, f, margins = self.function("direct")(x, u, w)
        singular.check_legs(self.robot, margins)
        singular.check_finite(Vd)
        return Accelerations(Vd, qdd_e, by_attachment(self.robot, f))

    def inverse(
        self,
        state: State,
        target: ArrayLike,
        output: FrameOutput | None = None,
        wrenches: Sequence[Wrench] = (),
    ) -> Forces:
        """Actuator forces for a wanted acceleration (…, o) of the output (Sec. 5.1).

        The output is all of V̇_p by default. Raises InputError for wrong shapes or fewer actuators
        than outputs, OutOfReach, and SingularPose: of a leg, of J_p⁻¹, or dynamic.
        """
        output = FrameOutput() if output is None else output
        of_type("output", output, FrameOutput)
        x = self._pack(state)
        wanted = finite("target", target, (output.size,))
        if self.robot.n_forces < output.size:
            raise InputError(
                f"output asks for {output.size} accelerations, but the robot has "
                f"{self.robot.n_forces} actuators; name as many with FrameOutput(rows=…)"
            )
        w = generalised_force(self.robot.platform, state, wrenches)
        check_batch(x, wanted, w, "target")
        found = self.function("inverse", output)(x, wanted, w)
        forces, Vd, qdd_e, f, gain, Jp_invT, margins = found
        singular.check_legs(self.robot, margins)
        singular.check_finite(gain)
        singular.check_gain(self.robot, output, gain, Jp_invT)
        return Forces(forces, qdd_e, Vd, by_attachment(self.robot, f))

    def cartesian(self, state: State) -> Cartesian:
        """The Cartesian form A V̇_p + c = J_sys⁻ᵀ Γ of Eqs. 44–49.

        Raises InputError where a leg has not as many joints as contact force components.
        """
        return cartesian.cartesian(self.robot, self._coordinates(state))[0]

    def legs(self, state: State) -> Legs:
        """Joint positions and rates of the legs: inverse geometry and kinematics."""
        system = assembly.assemble(self.robot, self._coordinates(state))
        q: list[Array] = [np.zeros(0)] * len(self.robot.legs)
        qd = list(q)
        for leg in system.legs:
            joints = range(leg.group.chain.n)
            positions = np.stack([assembly.joint_position(leg, j) for j in joints], axis=-1)
            for place, number in enumerate(leg.group.legs):
                q[number], qd[number] = positions[..., place, :], leg.qd[..., place, :]
        return Legs(tuple(q), tuple(qd))

    def static(self, position: ArrayLike, rotation: ArrayLike) -> tuple[State, Array]:
        """The equilibrium under gravity at a pose of Σp: the bent platform, and the forces (m,).

        Raises NotConverged where the platform is too soft for a small deflection.
        """
        from parflex.statics import equilibrium

        pose = State(position, rotation)
        self._coordinates(pose)  # every leg reaches it
        return equilibrium(self, pose)

    def compiled(self) -> Compiled:
        """The models on flat arrays, without allocation; one per thread."""
        return Compiled(self)

    def function(self, name: str, output: FrameOutput | None = None) -> Function:
        """The kernel of that name, compiled at first use."""
        with self._lock:
            key = (name, output)
            if key not in self._functions:
                self._functions[key] = self.backend.compile(self._kernel(name, output))
            return self._functions[key]

    def _kernel(self, name: str, output: FrameOutput | None) -> Kernel:
        build: Callable[..., Kernel] = getattr(kernels, name)
        return build(self.robot) if output is None else build(self.robot, output)

    def _pack(self, state: State) -> Array:
        return pack(state, self.robot.platform.modes)

    def _coordinates(self, state: State) -> Coordinates:
        """A checked state for the mechanics itself."""
        x = coordinates(self._pack(state), self.robot.platform.modes)
        with np.errstate(invalid="ignore", divide="ignore"):
            margins = assembly.leg_margins(assembly.assemble(self.robot, x))
        singular.check_legs(self.robot, margins)
        return x


def check_batch(x: Array, second: Array, w: Array, name: str) -> None:
    """The leading axes of state, second argument and wrenches must broadcast."""
    shapes = [a.shape[:-1] for a in (x, second, w)]
    try:
        np.broadcast_shapes(*shapes)
    except ValueError:
        raise InputError(
            f"the leading (batch) axes of state, {name} and wrenches are {shapes[0]}, {shapes[1]} "
            f"and {shapes[2]}; they must broadcast together"
        ) from None


def by_attachment(robot: Robot, f: Array) -> Array:
    """Contact forces (…, k, 3) by attachment, zero where no leg holds, from (…, 3 tips)."""
    by_tip = f.reshape(f.shape[:-1] + (len(robot.tip_attachments), 3))
    count = len(robot.platform.attachments)
    chosen = np.arange(count)[:, None] == robot.tip_attachments
    return np.einsum("at,...tc->...ac", chosen.astype(float), by_tip)
