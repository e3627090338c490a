"""Outputs that the inverse model can prescribe: accelerations of Σp, of a point of the platform, or of the
actuated joints."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

import numpy as np

from parflex.base.array import Array, block_diagonal, cross, join, mv, transpose
from parflex.base.check import exactly, integer, whole_numbers
from parflex.base.errors import InputError
from parflex.mechanics.closure import actuated_rows
from parflex.mechanics.contact import Contact
from parflex.mechanics.kinematics import PointMotion, node_wrench_map, point_motion
from parflex.mechanics.leg_terms import leg_response
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.system import System, actuated, diagonal, leg_accelerations
from parflex.robot.body import FlexibleBody
from parflex.robot.layout import Coordinates
from parflex.robot.robot import Robot

THROUGH_DRIVES = (
    "a compliance lies between motors and platform, which forces do not accelerate at once: take "
    'output=JointOutput(), the accelerations of the motors, or legs="static", legs that give with the load '
    "and do not swing"
)

THROUGH_SOFT_TIPS = (
    "soft tips give between motors and platform, which forces do not accelerate at once: take "
    "output=JointOutput(), the accelerations of the actuated joints"
)

Moved = tuple[Array, Array]  # V̇_p and q̈_e, (…, 6, c) and (…, N, c)


def check_rows(name: str, rows: Any, count: int | None = None) -> tuple[int, ...]:
    """The rows as integers; raises InputError where one is none of so many (None: any), or named twice."""
    found = tuple(whole_numbers(name, rows).tolist())
    strange = set() if count is None else set(found) - set(range(count))
    if not found or len(set(found)) < len(found) or strange:
        last = "" if count is None else f" {count - 1}"
        raise InputError(f"{name} is {rows}; name some of 0 …{last}, each once")
    return found


@dataclass(frozen=True)
class Output(ABC):
    """An acceleration that the inverse model can prescribe; it is affine in Γ."""

    @property
    @abstractmethod
    def size(self) -> int:
        """o, the number of rows."""

    @abstractmethod
    def of(self, robot: Robot) -> "Output":
        """The output of a robot; raises InputError where the robot does not have it."""

    @abstractmethod
    def gain(self, system: System, contact: Contact, F: Array, moved: Moved) -> Array:
        """∂output/∂Γ (…, o, m), for columns of Γ that give contact forces F (…, 3k, m) and these motions."""

    @abstractmethod
    def free(self, system: System, f: Array, moved: Moved) -> Array:
        """The acceleration (…, o) without Γ, at contact forces f (…, 3k); c = 1 in the platform's motion."""

    @abstractmethod
    def seen(self, mechanism: Mechanism, x: Coordinates) -> Array:
        """(o, 6 + N + z), the displacement of the output by those of platform, modes and legs."""

    @abstractmethod
    def lengths(self, mechanism: Mechanism) -> Array:
        """The lengths (o,) m that make rows comparable, the platform's size for those that are angular."""


@dataclass(frozen=True)
class PlatformOutput(Output):
    """Rows of an acceleration of the platform resolved in Σp: 0, 1, 2 linear, 3, 4, 5 angular."""

    @property
    @abstractmethod
    def axes(self) -> tuple[int, ...]:
        """The rows."""

    @property
    def size(self) -> int:
        return len(self.axes)

    def of(self, robot: Robot) -> Output:
        self.check(robot.platform)
        return self

    @abstractmethod
    def linear(self, body: FlexibleBody, x: Coordinates, Vd: Array, qdd_e: Array) -> Array:
        """The part that is linear in V̇_p (…, 6, c) and q̈_e (…, N, c): (…, o, c)."""

    @abstractmethod
    def drift(self, body: FlexibleBody, x: Coordinates) -> Array:
        """The acceleration (…, o) where V̇_p and q̈_e are zero."""

    def check(self, body: FlexibleBody) -> None:
        """Nothing where the body has the point that is prescribed; raises InputError where it lacks it."""
        return

    def gain(self, system: System, contact: Contact, F: Array, moved: Moved) -> Array:
        return self.linear(system.mechanism.platform.body, system.x, *moved)

    def free(self, system: System, f: Array, moved: Moved) -> Array:
        body, x = system.mechanism.platform.body, system.x
        return self.linear(body, x, *moved)[..., 0] + self.drift(body, x)

    def seen(self, mechanism: Mechanism, x: Coordinates) -> Array:
        every = np.eye(6 + mechanism.platform.modes)
        platform = self.linear(mechanism.platform.body, x, every[:6], every[6:])
        return np.hstack([platform, np.zeros((self.size, len(mechanism.driven)))])

    def lengths(self, mechanism: Mechanism) -> Array:
        return np.where(np.array(self.axes) < 3, 1.0, mechanism.size)


@dataclass(frozen=True)
class FrameOutput(PlatformOutput):
    """Rows of V̇_p, the acceleration of Σp resolved in Σp: 0, 1, 2 linear, 3, 4, 5 angular.

    Raises InputError where a row is none of these or is named twice.
    """

    rows: tuple[int, ...] = (0, 1, 2, 3, 4, 5)

    def __post_init__(self) -> None:
        object.__setattr__(self, "rows", check_rows(f"{type(self).__name__}.rows", self.rows, 6))

    @property
    def axes(self) -> tuple[int, ...]:
        return self.rows

    def linear(self, body: FlexibleBody, x: Coordinates, Vd: Array, qdd_e: Array) -> Array:
        return Vd[..., list(self.rows), :]

    def drift(self, body: FlexibleBody, x: Coordinates) -> Array:
        return np.zeros(self.size)


@dataclass(frozen=True)
class PointOutput(PlatformOutput):
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
        object.__setattr__(self, "rows", check_rows(f"{type(self).__name__}.rows", self.rows, 6))

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


@dataclass(frozen=True)
class JointOutput(Output):
    """Accelerations q̈_a of the actuated joints, m/s² or rad/s², in the order of the forces.

    Where a drive gives they are those of the motor, q̈ − δ̈. rows (o,) names some of them, by default all:
    q̈_a = Sᵀ A⁻¹ (S Γ − c − Jᵀ f). Motor and output are in one place, so that ∂q̈_a/∂Γ is symmetric and not
    negative, however legs and platform bend.

    Raises InputError where a row is named twice, or is none of the robot's actuated joints.
    """

    rows: tuple[int, ...] | None = None

    def __post_init__(self) -> None:
        if self.rows is not None:
            object.__setattr__(self, "rows", check_rows("JointOutput.rows", self.rows))

    @property
    def joints(self) -> list[int]:
        """The rows; raises InputError where nobody has said of which robot."""
        if self.rows is None:
            raise InputError("JointOutput.rows is None, all joints, of no robot yet; take output.of(robot)")
        return list(self.rows)

    @property
    def size(self) -> int:
        return len(self.joints)

    def of(self, robot: Robot) -> Output:
        every = range(robot.n_forces)
        return JointOutput(
            check_rows("JointOutput.rows", every if self.rows is None else self.rows, len(every))
        )

    def gain(self, system: System, contact: Contact, F: Array, moved: Moved) -> Array:
        alone = driven_mobility(system)
        return (alone - transpose(contact.JAS) @ F)[..., self.joints, :]

    def free(self, system: System, f: Array, moved: Moved) -> Array:
        none = np.zeros(system.mechanism.n_forces)
        return actuated(system, leg_accelerations(system, none, f))[..., self.joints]

    def seen(self, mechanism: Mechanism, x: Coordinates) -> Array:
        found: Array = actuated_rows(mechanism)[self.joints]
        return found

    def lengths(self, mechanism: Mechanism) -> Array:
        slides = mechanism.slides[mechanism.driven][mechanism.force_order]
        return np.where(slides, 1.0, mechanism.size)[self.joints]


def driven_mobility(system: System) -> Array:
    """Sᵀ A⁻¹ S (…, m, m): how the motors move their joints where the platform gives no forces."""
    parts = []
    for leg in system.legs:
        S, z = leg.group.S, leg.A.shape[:-1]
        found = leg_response(leg.group, leg.A, np.broadcast_to(S, (*z, S.shape[-1])))
        parts.append(block_diagonal(S.T @ found))
    order = system.mechanism.force_order
    return diagonal(parts)[..., order, :][..., order]


def check_at_once(mechanism: Mechanism, output: Output) -> None:
    """Raise InputError where an output of the platform has more rows than there are motors that drive without
    a compliance: others do not accelerate it at once."""
    at_once = sum(len(leg.legs) * (len(leg.actuated) - len(leg.chain.drives)) for leg in mechanism.groups)
    given = any(group.chain.drives for group in mechanism.groups)
    if given and at_once < output.size and isinstance(output, PlatformOutput):
        raise InputError(f"output is a {type(output).__name__}, but {THROUGH_DRIVES}")
