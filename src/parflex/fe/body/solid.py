"""The elements and materials of a solid, for its stresses."""

from typing import NamedTuple

from parflex.base.array import Array
from parflex.robot.material import Material


class Solid(NamedTuple):
    """The data that stresses are computed from: elements (E, 10) of node numbers, the part (E,) that each
    belongs to, and a material for all parts or one for each."""

    elements: Array
    parts: Array
    materials: tuple[Material, ...]

    def by_element(self, values: Array) -> Array:
        """The rows (E, …) of a table (1 or more, …) of values for each material."""
        return values[self.parts if len(values) > 1 else 0 * self.parts]
