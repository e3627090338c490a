"""What a kernel is: a function of flat vectors, with named sizes."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from parflex.base.array import Array
from parflex.mechanics.closure import flat_state
from parflex.robot.robot import Robot


@dataclass(frozen=True)
class Kernel:
    """A function of flat vectors (…, n_i), with the sizes of its inputs and outputs.

    It is determined by its name and its subject, a robot and what else was chosen; the first input
    is a flat state of the robot.
    """

    name: str
    function: Callable[..., tuple[Array, ...]]
    inputs: tuple[int, ...]
    outputs: tuple[int, ...]
    subject: tuple[Any, ...]

    def probe(self, count: int) -> list[Array]:
        """Inputs (count, n_i) near home, in motion, to try an implementation on."""
        rng, robot = np.random.default_rng(0), self.subject[0]
        home = flat_state(robot, robot.home)
        x = home + np.where(np.arange(len(home)) < 7, 0.0, 1e-3) * rng.normal(size=(count, len(home)))
        return [x, *(rng.normal(size=(count, n)) for n in self.inputs[1:])]


def sizes(robot: Robot) -> tuple[int, int, int, int]:
    """Lengths of the flat state, the elastic coordinates, the forces and the contact forces."""
    return robot.layout.size, robot.platform.modes, robot.n_forces, 3 * len(robot.tip_attachments)
