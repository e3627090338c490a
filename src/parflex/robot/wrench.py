"""A wrench on a node of the platform."""

from dataclasses import dataclass

from parflex.base.array import Given
from parflex.base.check import finite, integer
from parflex.base.errors import InputError
from parflex.robot.words import told


@dataclass(frozen=True, eq=False)
class Wrench:
    """A force (…, 3) N and a moment (…, 3) N m on platform node `node`, in world or platform axes.

    Raises InputError for wrong shapes or another frame name.
    """

    node: int
    force: Given = (0.0, 0.0, 0.0)
    moment: Given = (0.0, 0.0, 0.0)
    frame: str = "world"

    def __post_init__(self) -> None:
        object.__setattr__(self, "force", finite("Wrench.force", self.force, (3,)))
        object.__setattr__(self, "moment", finite("Wrench.moment", self.moment, (3,)))
        object.__setattr__(self, "node", integer("Wrench.node", self.node))
        if self.frame not in ("world", "platform"):
            raise InputError(f'Wrench.frame is {self.frame!r}; choose "world" or "platform"')

    __repr__ = told
