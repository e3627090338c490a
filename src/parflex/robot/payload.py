"""A payload: a rigid body on the platform."""

from dataclasses import dataclass, replace

import numpy as np

from parflex.base import kinds
from parflex.base.array import Array, skew
from parflex.base.check import POSITIVE, SYMMETRIC, of_type
from parflex.base.errors import InputError
from parflex.base.held import Given
from parflex.base.plausible import doubt
from parflex.robot.body import FlexibleBody
from parflex.robot.fields import check_fields, given, index
from parflex.robot.moments import with_body
from parflex.robot.words import told

HEAVY = 100.0  # times the platform that carries it: hardly meant
FIT = 6  # nodes from which the turning of a place is found where shapes have no rotations


@dataclass(frozen=True, eq=False)
class Payload:
    """A rigid body on the platform: mass kg, centre of mass `com` (3,) m in Σp, inertia (3, 3) kg m² there.

    On a platform that bends it moves and turns with a node, by its number, by default the one nearest to
    `com`.

    Raises InputError for a mass that is not positive or an inertia that no body has.
    """

    mass: float = given(kinds.MASS, "the mass, in kg", POSITIVE)
    com: Given = given(
        kinds.LENGTH, "centre of mass in the platform's frame", default=(0.0, 0.0, 0.0), shape=(3,)
    )
    inertia: Given = given(
        kinds.INERTIA,
        "about the centre of mass: XX YY ZZ XY XZ YZ; by default a point",
        SYMMETRIC,
        default=((0.0,) * 3,) * 3,
        shape=(3, 3),
    )
    node: int | None = index("of the platform, that it moves with; by default the nearest to com")

    def __post_init__(self) -> None:
        check_fields(self)
        second = self.second
        if np.linalg.eigvalsh(second)[0] < -1e-9 * np.trace(second):
            raise InputError(
                f"Payload.inertia is {np.asarray(self.inertia).tolist()}, which no body has; its principal "
                f"values are positive, none larger than the sum of the other two"
            )

    __repr__ = told

    @property
    def second(self) -> Array:
        """∫ s sᵀ dm (3, 3) about the centre of mass: ½ tr(I) 1 − I."""
        inertia = np.asarray(self.inertia)
        return 0.5 * np.trace(inertia) * np.eye(3) - inertia

    def on(self, body: FlexibleBody) -> FlexibleBody:
        """The body with the payload; stiffness and damping stay those of the bare one.

        Raises InputError for a node that the body does not have; doubts a payload that outweighs the body
        a hundred times.
        """
        of_type("body", body, FlexibleBody)
        if HEAVY * body.moments.m < self.mass <= kinds.MASS.most:
            doubt(
                f"Payload.mass is {self.mass:.10g} kg, on a platform of {body.moments.m:.4g} kg; "
                f'if it is in g, give {self.mass / 1000:.10g} kg, in files "{self.mass:.10g} g"; if it is '
                f"right, give the platform's own mass"
            )
        if self.node is not None and self.node >= len(body.nodes):
            raise InputError(f"Payload.node is {self.node}; this body has nodes 0 … {len(body.nodes) - 1}")
        com = np.asarray(self.com)
        Phi, turn = carried_by(body, self.node, com)
        return replace(body, moments=with_body(body.moments, self.mass, com, self.second, Phi, turn))


def carried_by(body: FlexibleBody, node: int | None, place: Array) -> tuple[Array, Array]:
    """Displacement and turning (N, 3) of a place that is fixed to a node, or to the nearest one.

    A node without rotations turns as its neighbours move, by least squares.
    """
    if body.modes == 0:
        return np.zeros((0, 3)), np.zeros((0, 3))
    at = int(np.argmin(np.linalg.norm(body.nodes - place, axis=1))) if node is None else node
    turn = None if body.rotation_shapes is None else body.rotation_shapes[:, at]
    if turn is None or not np.any(turn):
        turn = fitted_turn(body, at)
    return body.shapes[:, at] + np.cross(turn, place - body.nodes[at]), turn


def fitted_turn(body: FlexibleBody, node: int) -> Array:
    """Θ (N, 3) for which u_i − u ≈ Θ × (r_i − r) of the nodes nearest to a node."""
    arms = body.nodes - body.nodes[node]
    near = np.argsort(np.linalg.norm(arms, axis=1))[: FIT + 1]
    rows = -skew(arms[near]).reshape(-1, 3)
    moved = (body.shapes[:, near] - body.shapes[:, [node]]).reshape(body.modes, -1)
    return np.linalg.lstsq(rows, moved.T, rcond=1e-9)[0].T
