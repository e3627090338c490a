"""A variable of a result: its labels, how it is computed, and who needs it."""

from collections.abc import Callable
from dataclasses import dataclass

from parflex.base.array import Array
from parflex.robot.robot import Robot
from parflex.simulation.variables.recorded import Recorded


@dataclass(frozen=True)
class Variable:
    """One variable of the dataset of a run.

    `of` computes its values, or gives None where the run has none. A view that lacks the variable says
    so in the words `missed`; without such words it does not need it.
    """

    name: str
    dims: tuple[str, ...]
    units: str | Callable[[Robot], str]
    words: str  # its long name
    of: Callable[[Recorded], Array | None]
    missed: str = ""
    pictured: bool = False  # whether the picture of the robot needs it
    text: bool = False  # whether it holds words, not numbers
    numbers: tuple[str, int] | None = None  # the dimension whose entries it numbers, and its first number

    @property
    def changes(self) -> bool:
        """True where it has a value for each instant."""
        return self.dims[:1] == ("time",) and self.name != "time"

    def units_for(self, robot: Robot) -> str:
        """The unit, which may depend on what moves the robot."""
        return self.units if isinstance(self.units, str) else self.units(robot)
