"""A caller's function of time and state."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import finite
from parflex.base.errors import InputError
from parflex.model.model import Model
from parflex.robot.state import State
from parflex.simulation.laws.bound import BoundLaw
from parflex.simulation.laws.constant_forces import given_forces, given_forces_jacobian
from parflex.simulation.laws.controller import Controller
from parflex.simulation.laws.law import Law
from parflex.simulation.loads import Loads

ForceFunction = Callable[[float, State], ArrayLike]


@dataclass(frozen=True, eq=False)
class Called(Controller):
    """The forces (m,) that a function of time and state gives."""

    model: Model
    function: ForceFunction

    def law(self, model: Model) -> Law:
        return Law(given_forces, given_forces_jacobian, np.zeros(model.robot.n_forces))

    def bind(self, model: Model, loads: Loads) -> BoundLaw:
        return BoundCall(self.law(model), model, loads, self.function)


class BoundCall(BoundLaw):
    """A function on flat vectors: it is called wherever its forces are needed."""

    def __init__(self, law: Law, model: Model, loads: Loads, function: ForceFunction) -> None:
        super().__init__(law, model, loads)
        self._function = function

    @property
    def known(self) -> bool:
        return False

    def row(self, t: float, x: Array) -> Array:
        found = finite("controller(t, state)", self._function(t, self.loads.state(t, x)))
        m = self.mechanism.n_forces
        if found.shape != (m,):
            raise InputError(f"controller(t, state) gave shape {found.shape}; expected ({m},)")
        return found
