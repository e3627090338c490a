"""A controller: the data that a user writes, the law that is compiled of them, and their table in files.

A control law is one file: a `Controller` with its fields, the kernel of the motion it causes, the derivative
of that motion, and the entries of a trajectory file.
"""

import threading
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.base.kinds import Kind
from parflex.model.core import core_of
from parflex.model.model import Model
from parflex.robot.state import State
from parflex.simulation.laws.bound import BoundLaw
from parflex.simulation.laws.law import Law
from parflex.simulation.laws.verdict import Verdict
from parflex.simulation.loads import Loads
from parflex.simulation.trajectory import Trajectory

INDEX = Kind("a whole number, not negative", "", "0")
REQUIRED: Any = object()  # the default of an entry that a file must have


@dataclass(frozen=True)
class TableEntry:
    """One entry of a law's table in a trajectory file; its value is a number, or one for each freedom."""

    name: str
    measure: Kind  # what the number measures; INDEX for a list of whole numbers
    words: str
    default: Any = REQUIRED


class Start(NamedTuple):
    """The state at which a run starts, and the forces that hold the robot there."""

    state: State
    forces: Array  # (m,); zero where the start is not an equilibrium


class Controller(ABC):
    """Actuator forces as a function of time and state."""

    kind: ClassVar[str] = ""  # its name in trajectory files; empty where files do not offer it
    about: ClassVar[str] = ""  # a sentence on its table
    entries: ClassVar[tuple[TableEntry, ...]] = ()
    seen_from_base: ClassVar[bool] = False  # whether its trajectory is one that is seen from a moving base

    model: Model
    trajectory: Trajectory | None = None  # what the platform is to follow, for the record

    def __call__(self, t: float, state: State) -> Array:
        """Forces (m,) at a time and state."""
        return self._bound(self.model).forces(t, core_of(self.model).flat(state))

    def verdict(self, state: State | None = None) -> Verdict | None:
        """The verdict on the law's stability about the equilibrium in the pose of a state, by default home.

        None of a law that says nothing of it. Raises as `Model.equilibrium`.
        """
        return None

    def wanted_joints(self, t: Array) -> Array | None:
        """The actuated joints (T, m) that are wanted at times (T,); None where there are none."""
        return None

    @abstractmethod
    def law(self, model: Model) -> Law:
        """The law that is compiled of the controller for a model."""

    def bind(self, model: Model, loads: Loads) -> BoundLaw:
        """The law on flat vectors under loads, for one simulation.

        Raises InputError where the controller was made for another model.
        """
        if model is not self.model:
            raise InputError(
                "the controller was made for another model than the one simulated; make it with that model, "
                "or pass a function (t, state) -> forces that calls the other model's inverse"
            )
        return BoundLaw(self.law(model), model, loads)

    @classmethod
    def planned(cls, table: Any, model: Model, start: Start, way: Trajectory) -> "Controller":
        """The controller of a trajectory file, whose table has the values of `entries` as attributes.

        Raises InputError where the table does not fit the robot or the trajectory.
        """
        raise NotImplementedError(f"{cls.__name__} has a kind, but does not say how a file makes it")

    def _bound(self, model: Model) -> BoundLaw:
        """The law without loads, bound once for each thread."""
        own = vars(self).setdefault("_own", threading.local())
        if getattr(own, "model", None) is not model:
            own.law, own.model = self.bind(model, Loads(model, ())), model
        found: BoundLaw = own.law
        return found


def stacked_row(size: int, *parts: Any) -> Array:
    """One row of a law: each part, a number or `size` of them, in full length."""
    return np.concatenate([np.zeros(size) + part for part in parts])
