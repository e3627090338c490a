"""What the inverse model can prescribe."""

from dataclasses import dataclass

import numpy as np

from parflex.array import Array
from parflex.check import integer
from parflex.errors import InputError


@dataclass(frozen=True)
class FrameOutput:
    """Rows of V̇_p, the acceleration of Σp resolved in Σp: 0, 1, 2 linear, 3, 4, 5 angular.

    Raises InputError where a row is none of these or is named twice.
    """

    rows: tuple[int, ...] = (0, 1, 2, 3, 4, 5)

    def __post_init__(self) -> None:
        rows = self.rows if isinstance(self.rows, (tuple, list, range)) else ()
        rows = tuple(integer("FrameOutput.rows", row) for row in rows)
        if not rows or len(set(rows)) < len(rows) or not set(rows) <= set(range(6)):
            raise InputError(f"FrameOutput.rows is {self.rows}; name some of 0 … 5, each once")
        object.__setattr__(self, "rows", rows)

    @property
    def size(self) -> int:
        """o, the number of rows."""
        return len(self.rows)

    def linear(self, Vd: Array, qdd_e: Array) -> Array:
        """The chosen rows of V̇_p (…, 6, c)."""
        return Vd[..., list(self.rows), :]

    def lengths(self, size: float) -> Array:
        """(o,) m: what makes the rows comparable, `size` for those that are angular."""
        return np.where(np.array(self.rows) < 3, 1.0, size)
