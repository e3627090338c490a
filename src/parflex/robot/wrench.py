"""A wrench on a node of the platform."""

from dataclasses import dataclass, field

from parflex.base.check import integer
from parflex.base.errors import InputError
from parflex.base.held import Given
from parflex.robot.fields import about, batched, check_fields, held
from parflex.robot.words import told


@dataclass(frozen=True, eq=False)
class Wrench:
    """A force (…, 3) N and a moment (…, 3) N m on platform node `node`, in world or platform axes.

    Raises InputError for wrong shapes or another frame name.
    """

    node: int = field(metadata=about(integer))
    force: Given = held(batched((3,)), default=(0.0, 0.0, 0.0))
    moment: Given = held(batched((3,)), default=(0.0, 0.0, 0.0))
    frame: str = "world"

    def __post_init__(self) -> None:
        check_fields(self)
        if self.frame not in ("world", "platform"):
            raise InputError(f'Wrench.frame is {self.frame!r}; choose "world" or "platform"')

    __repr__ = told
