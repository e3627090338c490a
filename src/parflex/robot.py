"""A robot: a fixed base, legs, a flexible platform, gravity."""

import os
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from parflex.array import Array, Given
from parflex.body import FlexibleBody
from parflex.chain import Chain
from parflex.check import all_of_type, exactly, of_type
from parflex.errors import InputError
from parflex.legs import ALL_LEG_TYPES, Leg, LegType
from parflex.state import State


class LegGroup(NamedTuple):
    """L legs of one type and equal structure, their tables side by side."""

    type: LegType
    legs: tuple[int, ...]  # their numbers in the robot
    chain: Chain
    rotation: Array  # (L, 3, 3)
    origin: Array  # (L, 3)
    tip_frames: tuple[int, ...]  # index of the link that carries each of the t tips
    offsets: Array  # (L, t, 3)
    attachments: Array  # (L, t) int
    actuated: tuple[int, ...]  # joint indices
    forces: Array  # (L, actuated) int, positions in Γ


@dataclass(frozen=True, eq=False)
class Robot:
    """Legs on a fixed base that hold a flexible platform.

    gravity (3,) m/s² in Σ0; home is the (position, rotation) of Σp at which `robot.home` stands.
    Forces Γ are ordered by leg, and by joint within a leg.

    Raises InputError for a leg no leg type knows, and where tips and attachments do not match.
    """

    legs: tuple[Leg, ...]
    platform: FlexibleBody
    gravity: Given = (0.0, 0.0, -9.81)
    home_pose: tuple[ArrayLike, ArrayLike] = ((0.0, 0.0, 0.0), np.eye(3))

    def __post_init__(self) -> None:
        object.__setattr__(self, "legs", all_of_type("Robot.legs", self.legs, Leg))
        of_type("Robot.platform", self.platform, FlexibleBody)
        object.__setattr__(self, "gravity", exactly("Robot.gravity", self.gravity, (3,)))
        if State(*self.home_pose).batch:
            raise InputError("Robot.home_pose is a batch; give one position (3,) and rotation (3, 3)")
        held: dict[int, int] = {}
        count = len(self.platform.attachments)
        for number, leg in enumerate(self.legs):
            leg_type(number, leg)
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

    def to_file(self, path: str | os.PathLike[str]) -> Path:
        """Write the robot as a robot file (docs/robot-files.md) that `load_robot` reads to the same bits.

        The modes of a flexible platform go to a NetCDF-4 file beside it. Raises InputError where a
        file cannot be written.
        """
        from parflex.files.robot_writing import save_robot

        return save_robot(self, path)

    @property
    def home(self) -> State:
        """The platform at its home pose, undeformed and at rest."""
        still = np.zeros(self.platform.modes)
        return State(*self.home_pose, np.zeros(6), still, still)

    @cached_property
    def groups(self) -> tuple[LegGroup, ...]:
        """The legs, gathered by type and structure."""
        gathered: dict[object, list[int]] = {}
        for number, leg in enumerate(self.legs):
            gathered.setdefault((leg_type(number, leg).name, leg.structure), []).append(number)
        return tuple(self._group(tuple(numbers)) for numbers in gathered.values())

    @cached_property
    def n_forces(self) -> int:
        """m, the number of actuated joints."""
        return sum(joint.mu for leg in self.legs for joint in leg.joints)

    @cached_property
    def tip_attachments(self) -> Array:
        """The attachment each tip holds, in the order of the groups."""
        parts = [group.attachments.reshape(-1) for group in self.groups]
        return np.concatenate([np.zeros(0, dtype=int), *parts])

    @cached_property
    def force_order(self) -> Array:
        """For each entry of Γ, its place in the order of the groups."""
        parts = [group.forces.reshape(-1) for group in self.groups]
        return np.argsort(np.concatenate([np.zeros(0, dtype=int), *parts]))

    def _group(self, numbers: tuple[int, ...]) -> LegGroup:
        legs = [self.legs[i] for i in numbers]
        first = legs[0]
        actuated = tuple(j for j, joint in enumerate(first.joints) if joint.mu)
        start = np.cumsum([0] + [sum(j.mu for j in leg.joints) for leg in self.legs])
        return LegGroup(
            type=leg_type(numbers[0], first),
            legs=numbers,
            chain=chain_of(legs),
            rotation=np.stack([leg.rotation for leg in legs]),
            origin=np.stack([leg.origin for leg in legs]),
            tip_frames=tuple(tip.frame - 1 for tip in first.tips),
            offsets=np.array([[tip.offset for tip in leg.tips] for leg in legs]),
            attachments=np.array([[tip.attachment for tip in leg.tips] for leg in legs]),
            actuated=actuated,
            forces=start[list(numbers), None] + np.arange(len(actuated)),
        )


def chain_of(legs: list[Leg]) -> Chain:
    """The tables of legs of equal structure, side by side."""

    def table(field: str) -> Array:
        return np.array([[getattr(joint, field) for joint in leg.joints] for leg in legs])

    first = legs[0].joints
    fields = ("gamma", "b", "alpha", "d", "theta", "r", "M", "MS", "I", "IA")
    return Chain(
        tuple(joint.antecedent - 1 for joint in first),
        tuple(joint.sigma for joint in first),
        *(table(field) for field in fields),
    )


def leg_type(number: int, leg: Leg) -> LegType:
    """The type whose inverse geometry holds for the leg."""
    for known in ALL_LEG_TYPES:
        if known.recognises(leg):
            return known
    names = ", ".join(known.name for known in ALL_LEG_TYPES)
    raise InputError(
        f"legs[{number}] is a {leg.word} chain whose table fits no leg type with closed-form inverse "
        f"geometry; known types: {names} (their tables are described in parflex.legs)"
    )
