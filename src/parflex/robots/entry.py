"""An entry of the gallery: a robot, how it may move, and its source."""

from collections.abc import Callable
from typing import NamedTuple

from parflex.robot.robot import Robot

Moves = tuple[tuple[tuple[float, float, float], tuple[float, float, float]], ...]


class Entry(NamedTuple):
    """A robot of the gallery.

    `build(modes=…)` makes it, with 0 modes rigid; `output` are the rows of V̇_p that its actuators
    command, as many as it has freedoms; `moves` are displacements (m) and rotation vectors (rad) from
    home for `Trajectory.through`.
    """

    name: str
    build: Callable[..., Robot]
    output: tuple[int, ...]
    moves: Moves
    source: str
