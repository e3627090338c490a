"""Outputs that the inverse model can prescribe: accelerations of Σp, or of a point of the platform."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

import numpy as np

from parflex.base.array import Array, cross, join, mv, transpose
from parflex.base.check import exactly, integer, whole_numbers
from parflex.base.errors import InputError
from parflex.mechanics.kinematics import PointMotion, node_wrench_map, point_motion
from parflex.robot.body import FlexibleBody
from parflex.robot.layout import Coordinates


@dataclass(frozen=True)
class Output(ABC):
    """Rows of an acceleration resolved in Σp: 0, 1, 2 linear, 3, 4, 5 angular.

    Raises InputError where a row is none of these or is named twice.
    """

    def check_rows(self, rows: Any) -> tuple[int, ...]:
        """The rows as integers; raises InputError where one is none of 0 … 5, or named twice."""
        name = f"{type(self).__name__}.rows"
        found = tuple(whole_numbers(name, rows).tolist())
        if not found or len(set(found)) < len(found) or not set(found) <= set(range(6)):
            raise InputError(f"{name} is {rows}; name some of 0 … 5, each once")
        return found

    @property
    @abstractmethod
    def axes(self) -> tuple[int, ...]:
        """The rows."""

    @property
    def size(self) -> int:
        """o, the number of rows."""
        return len(self.axes)

    @abstractmethod
    def linear(self, body: FlexibleBody, x: Coordinates, Vd: Array, qdd_e: Array) -> Array:
        """The part that is linear in V̇_p (…, 6, c) and q̈_e (…, N, c): (…, o, c)."""

    @abstractmethod
    def drift(self, body: FlexibleBody, x: Coordinates) -> Array:
        """The acceleration (…, o) where V̇_p and q̈_e are zero."""

    def check(self, body: FlexibleBody) -> None:
        """Nothing where the body has the point that is prescribed; raises InputError where it lacks it."""
        return

    def lengths(self, size: float) -> Array:
        """The lengths (o,) m that make the rows comparable, `size` for those that are angular."""
        return np.where(np.array(self.axes) < 3, 1.0, size)


@dataclass(frozen=True)
class FrameOutput(Output):
    """Rows of V̇_p, the acceleration of Σp resolved in Σp: 0, 1, 2 linear, 3, 4, 5 angular.

    Raises InputError where a row is none of these or is named twice.
    """

    rows: tuple[int, ...] = (0, 1, 2, 3, 4, 5)

    def __post_init__(self) -> None:
        object.__setattr__(self, "rows", self.check_rows(self.rows))

    @property
    def axes(self) -> tuple[int, ...]:
        return self.rows

    def linear(self, body: FlexibleBody, x: Coordinates, Vd: Array, qdd_e: Array) -> Array:
        return Vd[..., list(self.rows), :]

    def drift(self, body: FlexibleBody, x: Coordinates) -> Array:
        return np.zeros(self.size)


@dataclass(frozen=True)
class PointOutput(Output):
    """Rows of the acceleration of a material point, resolved in Σp: of a node, or of a tool's tip.

    The point bends with the platform: it sits at `offset` (3,) m, in Σp, from node `node`, rigidly
    fixed to it. Rows are as in FrameOutput; the angular ones, and an offset, need a body with
    rotation shapes.

    Raises InputError for rows, a node or an offset that there are not.
    """

    node: int
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rows: tuple[int, ...] = (0, 1, 2)

    def __post_init__(self) -> None:
        object.__setattr__(self, "node", integer("PointOutput.node", self.node))
        offset = exactly("PointOutput.offset", self.offset, (3,))
        object.__setattr__(self, "offset", tuple(float(v) for v in offset))
        object.__setattr__(self, "rows", self.check_rows(self.rows))

    @property
    def axes(self) -> tuple[int, ...]:
        return self.rows

    def check(self, body: FlexibleBody) -> None:
        if self.node >= len(body.nodes):
            raise InputError(
                f"PointOutput.node is {self.node}; the platform has nodes 0 … {len(body.nodes) - 1}"
            )
        turns = any(self.offset) or max(self.rows) > 2
        if turns and body.modes and body.rotation_shapes is None:
            raise InputError(
                "PointOutput asks for a rotation or an offset, but the platform has no rotation shapes; "
                "give rotation_shapes to the body, or name a node at the tool's tip"
            )

    def linear(self, body: FlexibleBody, x: Coordinates, Vd: Array, qdd_e: Array) -> Array:
        W_a = node_wrench_map(body, self.node, x.elastic, self.offset)
        every = transpose(W_a[..., :6, :]) @ Vd + transpose(W_a[..., 6:, :]) @ qdd_e
        return every[..., list(self.rows), :]

    def drift(self, body: FlexibleBody, x: Coordinates) -> Array:
        shapes, rotations = body.shapes_at(self.node, self.offset)
        moved = self._motion(body, shapes, x)
        turning = mv(rotations, x.elastic_rate)
        return join([moved.h[..., 0, :], cross(x.twist[..., 3:], turning)])[..., list(self.rows)]

    def _motion(self, body: FlexibleBody, shapes: Array, x: Coordinates) -> PointMotion:
        place = body.nodes[self.node] + np.asarray(self.offset)
        return point_motion(place[None], shapes[None], x)
