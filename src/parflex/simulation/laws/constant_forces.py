"""Constant forces."""

from dataclasses import dataclass

import numpy as np

from parflex.base.array import Array
from parflex.base.check import finite
from parflex.base.errors import InputError
from parflex.base.held import Given
from parflex.kernels.kernel import Kernel
from parflex.kernels.motion import Driven, motion
from parflex.kernels.motion_jacobian import ForceChange, motion_jacobian
from parflex.mechanics import dynamics
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.system import System
from parflex.mechanics.wrench import Place
from parflex.model.model import Model
from parflex.robot.fields import held
from parflex.simulation.laws.controller import Controller
from parflex.simulation.laws.law import Law


def given_forces(mechanism: Mechanism, places: tuple[Place, ...]) -> Kernel:
    """The motion under forces that stand in the row (m)."""

    def law(system: System, t: Array, row: Array, load: Array) -> Driven:
        return Driven(row, dynamics.direct_of(system, row, load))

    return motion("given_forces", mechanism, mechanism.n_forces, law, places)


def given_forces_jacobian(mechanism: Mechanism, places: tuple[Place, ...]) -> Kernel:
    """The derivative of the motion under forces that stand in the row."""

    def drive(system: System, t: Array, row: Array) -> ForceChange:
        return row, np.zeros((mechanism.n_forces, mechanism.layout.motion_size))

    return motion_jacobian(given_forces(mechanism, places), places, drive)


@dataclass(frozen=True, eq=False)
class ConstantForces(Controller):
    """The same forces (m,) at all times.

    Raises InputError for another shape.
    """

    model: Model
    forces: Given = held()

    def __post_init__(self) -> None:
        m, forces = self.model.robot.n_forces, finite("forces_or_controller", self.forces)
        if forces.shape != (m,):
            raise InputError(
                f"forces_or_controller has shape {forces.shape}; give forces ({m},), a Controller, or "
                f"a function (t, state) -> forces ({m},)"
            )
        object.__setattr__(self, "forces", forces)

    def law(self, model: Model) -> Law:
        return Law(given_forces, given_forces_jacobian, self.forces)
