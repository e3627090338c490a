"""A move to a pose: a polynomial of fifth order, at rest at both ends."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import POSITIVE, scalar, single_rotation
from parflex.base.held import Held
from parflex.kernels.segment import Segment, path
from parflex.robot.fields import about, exact, held, optional
from parflex.simulation.moves.move import Move, Pose

QUINTIC = np.array([0.0, 0.0, 0.0, 10.0, -15.0, 6.0])  # 10 τ³ − 15 τ⁴ + 6 τ⁵


@dataclass(frozen=True, eq=False, repr=False)
class MoveTo(Move):
    """Go to the pose position (3,) m, rotation (3, 3) of Σp in Σ0, in `duration` seconds.

    Position or rotation stays as it is where it is not given. The position goes along a straight line and
    the orientation along the geodesic of SO(3), both as 10 τ³ − 15 τ⁴ + 6 τ⁵.

    Raises InputError for wrong shapes, a matrix that is no rotation, or a duration that is not positive.
    """

    position: Held[ArrayLike | None, Array | None] = held(optional(exact((3,))), default=None)
    rotation: Held[ArrayLike | None, Array | None] = held(optional(single_rotation), default=None)
    duration: float = field(kw_only=True, metadata=about(scalar, rule=POSITIVE))

    def end(self, start: Pose) -> Pose:
        return Pose(
            start.position if self.position is None else self.position,
            start.rotation if self.rotation is None else self.rotation,
        )

    def segments(self, start: Pose) -> list[Segment]:
        from scipy.spatial.transform import Rotation

        end = self.end(start)
        turn = Rotation.from_matrix(start.rotation.T @ end.rotation).as_rotvec()
        angle = np.linalg.norm(turn)
        way = np.array([*(end.position - start.position), angle])
        axis = turn / (angle if angle > 0 else 1.0)
        line = path(start.position, way, QUINTIC)
        return [Segment(np.asarray(self.duration), start.rotation, line, axis)]
