"""A robot: a fixed base, legs, a flexible platform, gravity."""

import os
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import all_of_type, exactly, of_type, rotation_matrix
from parflex.base.doors import opened
from parflex.base.errors import InputError
from parflex.base.held import Given, Held
from parflex.robot.body import FlexibleBody
from parflex.robot.fields import check_fields, exact, held
from parflex.robot.leg import Joint, Leg
from parflex.robot.state import State
from parflex.robot.words import counted, listed, modal


def single_pose(name: str, given: Any) -> tuple[Array, Array]:
    """A position (3,) m and a rotation (3, 3)."""
    if not isinstance(given, (tuple, list)) or len(given) != 2:
        raise InputError(f"{name} is {type(given).__name__}; give a pair, position (3,) and rotation (3, 3)")
    rotation = exactly(f"{name}[1]", given[1], (3, 3))
    return exactly(f"{name}[0]", given[0], (3,)), rotation_matrix(f"{name}[1]", rotation)


@dataclass(frozen=True, eq=False)
class Robot:
    """Legs on a fixed base that hold a flexible platform.

    gravity (3,) m/s² in Σ0; home is the (position, rotation) of Σp at which `robot.home` stands.
    Forces Γ are ordered by leg, and by joint within a leg.

    Raises InputError where tips and attachments do not match, or a tip with a flexure is on a platform that
    bends without rotation shapes.
    """

    legs: Held[Sequence[Leg], tuple[Leg, ...]] = held(partial(all_of_type, kind=Leg))
    platform: Held[FlexibleBody, FlexibleBody] = held(partial(of_type, kind=FlexibleBody))
    gravity: Given = held(exact((3,)), default=(0.0, 0.0, -9.81))
    home_pose: Held[tuple[ArrayLike, ArrayLike], tuple[Array, Array]] = held(
        single_pose, default=((0.0, 0.0, 0.0), np.eye(3))
    )

    def __post_init__(self) -> None:
        check_fields(self)
        held: dict[int, int] = {}
        count = len(self.platform.attachments)
        for number, leg in enumerate(self.legs):
            for tip in leg.tips:
                if tip.attachment >= count:
                    raise InputError(
                        f"legs[{number}] holds attachment {tip.attachment}, but the platform has "
                        f"{count} (0 … {count - 1}); give the body {tip.attachment + 1} attachments"
                    )
                if tip.attachment in held:
                    raise InputError(
                        f"legs[{number}] and legs[{held[tip.attachment]}] both hold attachment "
                        f"{tip.attachment}; list the node twice among the body's attachments"
                    )
                held[tip.attachment] = number
        check_sections(self)

    def __repr__(self) -> str:
        chains = Counter(leg.word for leg in self.legs)
        legs = ", ".join(f"{counted(number, 'leg')} {word}" for word, number in chains.items())
        body, home = self.platform, listed(self.home_pose[0])
        return (
            f"Robot: {legs or 'no legs'}, {counted(self.n_forces, 'motor')}, platform of "
            f"{body.moments.m:.4g} kg, {modal(body.frequencies)}, home {home} m"
        )

    def to_file(self, path: str | os.PathLike[str]) -> Path:
        """Write the robot as a robot file (docs/robot-files.md) that `load_robot` reads to the same bits.

        The modes of a flexible platform go to a NetCDF-4 file beside it, and so do flexible links that are no
        beams. Raises InputError where a file cannot be written.
        """
        written: Path = opened("Robot.to_file")(self, path)
        return written

    @property
    def home(self) -> State:
        """The platform at its home pose, undeformed and at rest."""
        still = np.zeros(self.platform.modes)
        return State(*self.home_pose, np.zeros(6), still, still)

    @cached_property
    def n_forces(self) -> int:
        """m, the number of actuated joints."""
        return len(self.actuated)

    @property
    def actuated(self) -> tuple[Joint, ...]:
        """The actuated joints, in the order of the forces."""
        return tuple(joint for leg in self.legs for joint in leg.joints if joint.mu)

    @cached_property
    def springs(self) -> tuple[str, ...]:
        """The names of the joints with springs (k > 0), by leg, and by joint within a leg."""
        legs = enumerate(self.legs, start=1)
        each = ((i, j, joint) for i, leg in legs for j, joint in enumerate(leg.joints, start=1))
        return tuple(f"leg {i}, joint {j}" for i, j, joint in each if joint.k > 0)


def check_sections(robot: Robot) -> None:
    """Raise InputError where a flexure holds a platform that does not tell how its sections turn."""
    body = robot.platform
    if not body.modes or body.rotation_shapes is not None:
        return
    for i, leg in enumerate(robot.legs):
        for t, tip in enumerate(leg.tips):
            if tip.flexure is not None:
                raise InputError(
                    f"legs[{i}].tips[{t}] has a flexure, but the platform has no rotation shapes, which tell "
                    f"how it turns there; give rotation_shapes to the body"
                )
