"""Springs and dampers on the actuated joints."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from parflex.analysis.small_motions import about
from parflex.base import kinds
from parflex.base.array import Array
from parflex.base.check import finite, of_type
from parflex.base.errors import InputError
from parflex.base.held import Given
from parflex.kernels import models
from parflex.kernels.kernel import Kernel
from parflex.kernels.motion import Driven, motion
from parflex.kernels.motion_jacobian import ForceChange, motion_jacobian
from parflex.mechanics import dynamics
from parflex.mechanics import system as assembly
from parflex.mechanics.derivatives.joint_tangent import joint_tangent
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.wrench import Place
from parflex.model.core import core_of
from parflex.model.model import Model
from parflex.robot.fields import held
from parflex.robot.state import State
from parflex.simulation.laws.controller import Controller, Start, TableEntry, stacked_row
from parflex.simulation.laws.law import Law
from parflex.simulation.laws.verdict import Verdict, servo_verdict
from parflex.simulation.trajectory import Trajectory


def springs(mechanism: Mechanism, places: tuple[Place, ...]) -> Kernel:
    """The motion under springs and dampers; the row is (Γ_0 m, kp m, kd m, reference m)."""

    def law(system: assembly.System, t: Array, row: Array, load: Array) -> Driven:
        u = spring_forces(system, row)
        return Driven(u, dynamics.direct_of(system, u, load))

    return motion("springs", mechanism, 4 * mechanism.n_forces, law, places)


def springs_jacobian(mechanism: Mechanism, places: tuple[Place, ...]) -> Kernel:
    """The derivative of the motion under springs and dampers."""

    def drive(system: assembly.System, t: Array, row: Array) -> ForceChange:
        _, kp, kd, _ = quarters(row)
        positions, rates = joint_tangent(system)
        change = -kp[..., None] * positions - kd[..., None] * rates
        return spring_forces(system, row), change

    return motion_jacobian(springs(mechanism, places), places, drive)


def spring_forces(system: assembly.System, row: Array) -> Array:
    """Γ (…, m) of springs and dampers; angles are known up to full turns."""
    preload, kp, kd, wanted = quarters(row)
    return preload + kp * joints_ahead(system, wanted) - kd * assembly.joint_rates(system)


def joints_ahead(system: assembly.System, wanted: Array) -> Array:
    """The ways (…, m) from the actuated joints to where they are wanted; angles within half a turn."""
    return way_to(system.mechanism, wanted - assembly.actuated_positions(system))


def way_to(mechanism: Mechanism, ahead: Array) -> Array:
    """Differences (…, m) of actuated joints, of angles within half a turn."""
    slides = mechanism.slides[mechanism.driven][mechanism.force_order]
    return slides * ahead + (1 - slides) * np.arctan2(np.sin(ahead), np.cos(ahead))


def quarters(row: Array) -> list[Array]:
    """Γ_0, kp, kd and the reference (…, m) in a row."""
    m = row.shape[-1] // 4
    return [row[..., i * m : (i + 1) * m] for i in range(4)]


@dataclass(frozen=True, eq=False)
class JointPD(Controller):
    """Springs and dampers on the actuated joints: Γ = Γ_0 + kp (q_ref − q) − kd q̇.

    The reference is the actuated joints' position in a state, which of a base that moves is one that is seen
    from it; kp (N/m or N m/rad) and kd (N s/m or
    N m s/rad) are scalars or (m,); forces Γ_0 (m,) is added.

    Raises InputError for wrong shapes, and for a reference that the robot cannot take.
    """

    kind = "joint-pd"
    seen_from_base = True
    about = "Springs and dampers on the actuated joints, which hold the start."
    entries = (
        TableEntry("kp", kinds.NUMBER, "N/m or N m/rad; one, or one for each motor"),
        TableEntry("kd", kinds.NUMBER, "N s/m or N m s/rad; one, or one for each motor"),
    )

    model: Model
    reference: State
    kp: Given = held()
    kd: Given = held()
    forces: Given = held(default=0.0)

    def __post_init__(self) -> None:
        m = core_of(self.model).robot.n_forces
        of_type("JointPD.reference", self.reference, State)
        if self.reference.batch:
            raise InputError(f"JointPD.reference is a batch {self.reference.batch}; give one state")
        core_of(self.model).system(self.reference)
        for name in ("kp", "kd", "forces"):
            value = finite(f"JointPD.{name}", getattr(self, name))
            if value.shape not in ((), (m,)):
                raise InputError(f"JointPD.{name} has shape {value.shape}; give one value, or ({m},)")
            object.__setattr__(self, name, value)

    def verdict(self, state: State | None = None) -> Verdict:
        """The verdict on the springs about the equilibrium in the pose of a state, by default theirs."""
        motions = about(core_of(self.model).readable, self.reference if state is None else state)
        m = self.model.robot.n_forces
        return servo_verdict("joint PD", motions, self.kp + np.zeros(m), self.kd + np.zeros(m), np.zeros(m))

    def wanted_joints(self, t: Array) -> Array:
        return np.tile(self._wanted, (len(t), 1))

    def law(self, model: Model) -> Law:
        row = stacked_row(model.robot.n_forces, self.forces, self.kp, self.kd, self._wanted)
        return Law(springs, springs_jacobian, row)

    @cached_property
    def _wanted(self) -> Array:
        """The actuated joints (m,) in the reference."""
        core = core_of(self.model)
        return core.readable(models.actuators)(x=core.flat(self.reference))["positions"]

    @classmethod
    def planned(cls, table: Any, model: Model, start: Start, way: Trajectory) -> "JointPD":
        """The controller that holds the start; raises InputError for a trajectory that leaves it."""
        if not way.still:
            raise InputError(
                'kind is "joint-pd", which holds the start, but a move leaves it; give a '
                'move that stays, hold = "1 s", or kind = "computed-torque"'
            )
        return cls(model, start.state, table.kp, table.kd, start.forces)
