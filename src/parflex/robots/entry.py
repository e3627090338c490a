"""An entry of the gallery: a robot, how it may move, and its source."""

from collections.abc import Callable
from typing import NamedTuple

from parflex.robot.robot import Robot

Moves = tuple[tuple[tuple[float, float, float], tuple[float, float, float]], ...]


class Entry(NamedTuple):
    """A robot of the gallery.

    `build(modes=…)` makes it, with 0 modes on a rigid platform; `output` are the rows of V̇_p that its
    actuators command, as many as it has freedoms, or none where what lies between them and the platform
    yields, so that they command their own joints alone; `moves` are displacements (m) and rotation vectors
    (rad) from home for `Trajectory.through`.
    """

    name: str
    build: Callable[..., Robot]
    output: tuple[int, ...]
    moves: Moves
    source: str
