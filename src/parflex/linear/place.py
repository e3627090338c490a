"""A point of the platform: a node, or a point that is fixed to it."""

from dataclasses import dataclass

from parflex.base.array import Array
from parflex.base.check import exactly, integer
from parflex.base.errors import InputError
from parflex.linear.point import Point
from parflex.linear.signal import Signal
from parflex.mechanics.kinematics import node_wrench_map
from parflex.robot.robot import Robot


@dataclass(frozen=True)
class NodePlace(Signal):
    """A node of the platform, and an offset (3,) m in Σp from it."""

    node: int
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        name = type(self).__name__
        object.__setattr__(self, "node", integer(f"{name}.node", self.node))
        offset = exactly(f"{name}.offset", self.offset, (3,))
        object.__setattr__(self, "offset", tuple(float(v) for v in offset))

    @property
    def name(self) -> str:
        """The name in labels; an offset in millimetres is told."""
        if not any(self.offset):
            return f"node[{self.node}]"
        return f"node[{self.node}]+[{' '.join(f'{1e3 * v:g}' for v in self.offset)}]mm".replace(".", ",")

    def check(self, robot: Robot) -> None:
        body, name = robot.platform, type(self).__name__
        if not 0 <= self.node < len(body.nodes):
            raise InputError(f"{name}.node is {self.node}; the platform has nodes 0 … {len(body.nodes) - 1}")
        if body.modes and body.rotation_shapes is None and any(self.offset):
            raise InputError(
                f"{name}.offset is {list(self.offset)}, but the platform has no rotation shapes, which tell "
                f"how it turns there; give rotation_shapes to the body, or name a node at the point"
            )

    def wrench_map(self, point: Point) -> Array:
        """W_a (6 + N, 6), from a wrench in Σp to the generalised force."""
        body = point.mechanism.platform.body
        return node_wrench_map(body, self.node, point.system.x.elastic, self.offset)

    def position(self, point: Point) -> Array:
        """(3,) m, where it is in the world at the equilibrium."""
        x, body = point.system.x, point.mechanism.platform.body
        own = body.nodes[self.node] + self.offset + body.shapes_at(self.node, self.offset)[0] @ x.elastic
        found: Array = x.position + x.rotation @ own
        return found

    def motion(self, point: Point) -> Array:
        """(6, d), ζ to the displacement and the turn of the point, in Σp."""
        found: Array = self.wrench_map(point).T @ point.T[: 6 + point.mechanism.platform.modes]
        return found
