"""The servos of the legs: each actuated joint follows the length or angle that the trajectory asks for."""

from dataclasses import KW_ONLY, dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from parflex.analysis.small_motions import about
from parflex.base import kinds
from parflex.base.array import Array
from parflex.base.check import NOT_NEGATIVE, finite, obeying, of_type, positive
from parflex.base.errors import InputError
from parflex.base.held import Given
from parflex.mechanics.held import held as tips_held
from parflex.model.core import core_of
from parflex.model.model import Model
from parflex.robot.fields import held
from parflex.robot.state import State
from parflex.robot.words import span
from parflex.simulation.laws.controller import Controller, Start, TableEntry, stacked_row
from parflex.simulation.laws.law import Law
from parflex.simulation.laws.servo_gains import check_sampled, default_gains
from parflex.simulation.laws.servo_motion import servo, servo_jacobian, servo_with_integral
from parflex.simulation.laws.servo_path import check_reach, sagging, wanted
from parflex.simulation.laws.verdict import Verdict, servo_verdict
from parflex.simulation.trajectory import Trajectory

RATE = 4000.0  # Hz, of an ordinary servo drive


@dataclass(frozen=True, eq=False)
class Servo(Controller):
    """The legs' servos: Γ = Γ_r + kp (q_r − q) + kd (q̇_r − q̇) + ki ∫ (q_r − q) dt on the actuated joints.

    The references q_r are the joints of the trajectory's pose, of platform, legs and soft tips as they sag
    there at rest; Γ_r are the forces that a robot frozen in that bend would need. kp (N/m or N m/rad), kd
    and ki are scalars or (m,). By default they give each leg ζ = 0.7 at 20 Hz, or at half the lowest elastic
    frequency of the robot with its legs locked where that is lower, on the joint's effective mass at home;
    ki is 0.

    On a base that moves (`simulate`) the trajectory is one that is seen from the base, of which encoders
    know nothing else: Γ_r are the forces on a base at rest. The rests of springs that move are known.

    Joint feedback is collocated: it makes no mode unstable by itself. It cannot hold a platform that buckles
    on locked legs (`verdict` tells). `rate` (Hz) is that of the controller that will run it: gains that are
    unstable there are refused; the law itself is continuous.

    Raises InputError for wrong shapes, negative gains, gains that are unstable when sampled, and legs without
    closed-form inverse geometry; OutOfReach and SingularPose for trajectories that a leg cannot follow.
    """

    kind = "servo"
    seen_from_base = True
    about = "The legs' servos: they track the leg lengths of the trajectory, with feed-forward."
    entries = (
        TableEntry("kp", kinds.NUMBER, "N/m or N m/rad; one, or one for each motor; by default 20 Hz", None),
        TableEntry(
            "kd", kinds.NUMBER, "N s/m or N m s/rad; one, or one for each motor; default ζ = 0.7", None
        ),
        TableEntry("ki", kinds.NUMBER, "N/(m s) or N m/(rad s); one, or one for each motor", 0.0),
        TableEntry("rate", kinds.FREQUENCY, "Hz, of the samples of the controller that will run it", RATE),
    )

    model: Model
    trajectory: Trajectory
    _: KW_ONLY
    kp: Given = held(default=None)
    kd: Given = held(default=None)
    ki: Given = held(default=0.0)
    rate: float = RATE

    def __post_init__(self) -> None:
        of_type("Servo.trajectory", self.trajectory, Trajectory)
        object.__setattr__(self, "rate", positive("Servo.rate", self.rate))
        core = core_of(self.model)
        if any(tips_held(core.mechanism).layout.joints):
            raise InputError(
                "Servo asks the legs for their joints in closed form, which legs that Newton's method solves "
                "do not give; use ComputedTorque, JointPD or a function of your own"
            )
        if self.kp is None or self.kd is None:
            found = default_gains(core)
            for name in ("kp", "kd"):
                if getattr(self, name) is None:
                    object.__setattr__(self, name, getattr(found, name))
        for name in ("kp", "kd", "ki"):
            object.__setattr__(self, name, checked_gain(name, getattr(self, name), core.mechanism.n_forces))
        check_sampled(core, self.kp, self.kd, self.ki, self.rate)
        check_reach(core, self.trajectory, self._rows)

    def verdict(self, state: State | None = None) -> Verdict:
        """The verdict on the servos about the equilibrium in the pose of a state, by default home."""
        core = core_of(self.model)
        motions = core.at_home if state is None else about(core.readable, state)
        found = servo_verdict("servo", motions, self.kp, self.kd, self.ki)
        return replace(found, words=f"{found.words} (kp {span(self.kp)}, kd {span(self.kd)})")

    def law(self, model: Model) -> Law:
        way = self.trajectory
        if np.any(self.ki):
            rows = np.hstack([self._rows, np.tile(self.ki, (len(self._rows), 1))])
            none: Any = servo_jacobian  # never asked for
            return Law(
                servo_with_integral, none, rows, way.starts[1:], differentiable=False, memory=len(self.ki)
            )
        return Law(servo, servo_jacobian, self._rows, way.starts[1:])

    @classmethod
    def planned(cls, table: Any, model: Model, start: Start, way: Trajectory) -> "Servo":
        """The servos along the trajectory."""
        return cls(model, way, kp=table.kp, kd=table.kd, ki=table.ki, rate=table.rate)

    def wanted_joints(self, t: Array) -> Array:
        """The actuated joints q_r (T, m) at times (T,)."""
        return wanted(core_of(self.model), self.trajectory, self._rows, t).joints

    @cached_property
    def _rows(self) -> Array:
        """The rows that the compiled law reads, one for each segment, without ki."""
        way, gains = self.trajectory, stacked_row(self.model.robot.n_forces, self.kp, self.kd)
        gains = np.tile(gains, (len(way.segments), 1))
        return np.hstack([way.segments, sagging(core_of(self.model), way), gains])


def checked_gain(name: str, value: Any, m: int) -> Array:
    """A gain of every actuator (m,)."""
    gain = finite(f"Servo.{name}", value)
    if gain.shape not in ((), (m,)):
        raise InputError(f"Servo.{name} has shape {gain.shape}; give one value, or ({m},)")
    return obeying(f"Servo.{name}", np.zeros(m) + gain, NOT_NEGATIVE)
