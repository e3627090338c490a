"""Computed torque: forces from the inverse model along a trajectory, with feedback of the pose."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from parflex.analysis.posed import well_posed
from parflex.analysis.watch import Watch
from parflex.analysis.zero_dynamics import output_report
from parflex.base import kinds
from parflex.base.array import Array, block, join, mtv, mv, skew, transpose
from parflex.base.check import finite, of_type
from parflex.base.dual import jacobian
from parflex.base.errors import InputError
from parflex.base.held import Given
from parflex.base.spatial import axial
from parflex.kernels import models
from parflex.kernels.kernel import Kernel
from parflex.kernels.motion import Driven, motion
from parflex.kernels.motion_jacobian import ForceChange, motion_jacobian
from parflex.kernels.segment import SEGMENT, along
from parflex.mechanics import dynamics
from parflex.mechanics.derivatives import sensitivity
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.output import FrameOutput, PlatformOutput
from parflex.mechanics.stiffening import stiffened
from parflex.mechanics.system import System
from parflex.mechanics.wrench import Place
from parflex.model.core import core_of
from parflex.model.inverting import MOVING, STATIC, check_legs_word
from parflex.model.model import Model
from parflex.robot.fields import held
from parflex.robot.layout import Coordinates
from parflex.robot.state import State
from parflex.simulation.laws.controller import INDEX, Controller, Start, TableEntry, stacked_row
from parflex.simulation.laws.law import Law
from parflex.simulation.laws.verdict import Verdict, frame_verdict
from parflex.simulation.trajectory import Trajectory

GAINS = 12  # kp 6, kd 6


def tracking(mechanism: Mechanism, output: PlatformOutput, places: tuple[Place, ...]) -> Kernel:
    """The motion under computed torque; the row is (segment, gains 12, preload m).

    The law computes its forces without the wrenches; the feedback alone answers them.
    """

    def law(system: System, t: Array, row: Array, load: Array) -> Driven:
        target, preload = tracking_target(system.x, t, row, output), row[..., SEGMENT + GAINS :]
        none = np.zeros(6 + mechanism.platform.modes)
        found = dynamics.inverse_of(system, target, none, output, preload, unforeseen=load)
        return Driven(found.forces, found.acceleration)

    return motion("tracking", mechanism, SEGMENT + GAINS + mechanism.n_forces, law, places, output)


def tracking_static(mechanism: Mechanism, output: PlatformOutput, places: tuple[Place, ...]) -> Kernel:
    """The motion under computed torque of legs that do not accelerate in their bend; the row is that of
    `tracking`."""

    def law(system: System, t: Array, row: Array, load: Array) -> Driven:
        target, preload = tracking_target(system.x, t, row, output), row[..., SEGMENT + GAINS :]
        none = np.zeros(6 + mechanism.platform.modes)
        forces = dynamics.inverse_of(stiffened(system), target, none, output, preload).forces
        return Driven(forces, dynamics.direct_of(system, forces, load))

    return motion("tracking_static", mechanism, SEGMENT + GAINS + mechanism.n_forces, law, places, output)


def tracking_jacobian(mechanism: Mechanism, output: PlatformOutput, places: tuple[Place, ...]) -> Kernel:
    """The derivative of the motion under computed torque, of as many outputs as actuators."""
    none, unloaded = np.zeros(mechanism.n_forces), np.zeros(6 + mechanism.platform.modes)

    def drive(system: System, t: Array, row: Array) -> ForceChange:
        target = tracking_target(system.x, t, row, output)
        u = dynamics.inverse_of(system, target, unloaded, output, none).forces
        found = sensitivity.inverse_sensitivity(system, target, lambda x: unloaded, output)
        by_state, by_target, _ = found
        return u, by_state + by_target @ target_tangent(system.x, t, row, output)

    return motion_jacobian(tracking(mechanism, output, places), places, drive)


def tracking_target(now: Coordinates, t: Array, row: Array, output: PlatformOutput) -> Array:
    """The target (…, o) at times (…,): the output's rows of V̇_d + kd (V_d − V) + kp e, resolved in Σp.

    The wanted motion is that of `segment.along`, gains are (kp 6, kd 6). The attitude error is the
    axial part of RᵀR_d, which for small angles is their rotation vector.
    """
    wanted, gains = along(row[..., :SEGMENT], t), row[..., SEGMENT : SEGMENT + GAINS]
    R_pd = np.matmul(transpose(now.rotation), wanted.rotation)
    place = mtv(now.rotation, wanted.position - now.position)
    error = join([place, 0.5 * axial(R_pd)])
    twist, acceleration = (
        join([mv(R_pd, part[..., :3]), mv(R_pd, part[..., 3:])])
        for part in (wanted.twist, wanted.acceleration)
    )
    kp, kd = gains[..., :6], gains[..., 6:]
    return (acceleration + kd * (twist - now.twist) + kp * error)[..., list(output.axes)]


def target_tangent(x: Coordinates, t: Array, row: Array, output: PlatformOutput) -> Array:
    """∂ of the target (…, o, 12 + 2 N + 2 n) by the small motions."""

    def target(seeds: Array) -> Array:
        turned = x.rotation @ (np.eye(3) + skew(seeds[..., 3:6]))
        now = x._replace(position=seeds[..., :3], rotation=turned, twist=seeds[..., 6:])
        return tracking_target(now, t, row, output)

    moving = jacobian(target, join([x.position, 0.0 * x.position, x.twist]))
    return block([[moving, np.zeros((output.size, 2 * (x.elastic.shape[-1] + x.s.shape[-1])))]])


@dataclass(frozen=True, eq=False)
class ComputedTorque(Controller):
    """Forces from the inverse model along a trajectory, with feedback of the platform's pose.

    V̇ = V̇_d + kd (V_d − V) + kp e, with e the position and rotation error of Σp; kp (1/s²) and kd
    (1/s) are scalars or (6,). With zero gains this is the paper's Fig. 3. A robot of fewer freedoms
    follows the rows of `output`, as many as it has; one with more actuators stays nearest to
    `preload` (m,).

    The trajectory is one in the world, also where the base moves (`simulate`): the base's motion is known,
    and so are the rests of springs that move.

    legs is "moving", or "static" where legs bend between motors and platform: the forces then are those that
    the legs would need if they did not accelerate in their bend. The pose is not seen where the motors are:
    legs without any damping swing up under this, and `Servo` does without it.

    A run that starts beyond a dynamic singularity of the output, where this control is unstable,
    warns of it (DynamicSingularity).

    Raises InputError for wrong shapes, negative gains, more freedoms than actuators, and moving legs by
    which the inverse model at home means nothing (`Model.inverse`).
    """

    kind = "computed-torque"
    about = "Forces from the inverse model, with feedback of the pose: computed torque."
    entries = (
        TableEntry("rows", INDEX, "the rows of the pose that it follows; all six", None),
        TableEntry("kp", kinds.POSE_GAIN, "stiffness of the feedback, 1/s²; one, or six", 0.0),
        TableEntry("kd", kinds.RATE_GAIN, "damping of the feedback, 1/s; one, or six", 0.0),
    )

    model: Model
    trajectory: Trajectory
    kp: Given = held(default=0.0)
    kd: Given = held(default=0.0)
    output: FrameOutput = field(default_factory=FrameOutput)
    preload: Given = held(default=0.0)
    legs: str = "moving"

    def __post_init__(self) -> None:
        for name in ("kp", "kd"):
            gain = finite(f"ComputedTorque.{name}", getattr(self, name))
            if gain.shape not in ((), (6,)) or np.any(gain < 0):
                raise InputError(f"ComputedTorque.{name} is {gain}; give one value ≥ 0, or six")
            object.__setattr__(self, name, gain)
        of_type("ComputedTorque.trajectory", self.trajectory, Trajectory)
        of_type("ComputedTorque.output", self.output, FrameOutput)
        core = core_of(self.model)
        m = core.robot.n_forces
        preload = finite("ComputedTorque.preload", self.preload)
        if preload.shape not in ((), (m,)):
            raise InputError(f"ComputedTorque.preload has shape {preload.shape}; give ({m},)")
        object.__setattr__(self, "preload", preload)
        if m < self.output.size:
            raise InputError(
                f"ComputedTorque follows {self.output.size} freedoms, but the robot has {m} actuators; "
                f"name as many with output=FrameOutput(rows=…), or use JointPD or a function of your own"
            )
        check_legs_word("ComputedTorque.legs", self.legs)
        if self.legs == MOVING and not well_posed(core.readable, self.output, core.flat(core.robot.home)):
            raise InputError(
                "ComputedTorque asks for the platform's acceleration at once, but legs or tips give between "
                f'motors and platform: use Servo, or ComputedTorque(…, legs="{STATIC}") with gains low '
                f"beside their frequencies"
            )

    def verdict(self, state: State | None = None) -> Verdict | None:
        """The verdict on the modes while the frame is held in the pose of a state, by default home; None with
        legs="static".

        Raises as `Model.output_report`.
        """
        if self.legs == STATIC:
            return None
        core = core_of(self.model)
        report = output_report(core.readable, core.robot.home if state is None else state, self.output)
        return frame_verdict("computed torque", report.poles)

    def law(self, model: Model) -> Law:
        way, m = self.trajectory, model.robot.n_forces
        constant = [stacked_row(6, self.kp, self.kd), stacked_row(m, self.preload)]
        rows = np.stack([np.concatenate([segment, *constant]) for segment in way.segments])
        moving, functions = self.legs == MOVING, core_of(model).functions
        return Law(
            tracking if moving else tracking_static,
            tracking_jacobian,
            rows,
            way.starts[1:],
            (self.output,),
            differentiable=moving and self.output.size == m,
            watch=Watch(functions, self.output, models.gains if moving else models.platform_gains),
        )

    @classmethod
    def planned(cls, table: Any, model: Model, start: Start, way: Trajectory) -> "ComputedTorque":
        """The controller along the trajectory, in the rows that the file names."""
        output = FrameOutput() if table.rows is None else FrameOutput(tuple(table.rows))
        return cls(model, way, kp=table.kp, kd=table.kd, output=output)
