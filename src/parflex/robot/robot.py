"""A robot: a fixed base, legs, a flexible platform, gravity."""

import os
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import all_of_type, exactly, of_type, rotation_matrix
from parflex.base.doors import opened
from parflex.base.errors import InputError
from parflex.base.held import Given, Held
from parflex.mechanics.chain import chain_of, joined
from parflex.mechanics.legs import ALL_LEG_TYPES, LegGroup
from parflex.mechanics.legs.base import settled
from parflex.robot.body import FlexibleBody
from parflex.robot.fields import check_fields, exact, held
from parflex.robot.layout import Layout
from parflex.robot.leg import Leg
from parflex.robot.state import State
from parflex.robot.words import counted, listed, modal

if TYPE_CHECKING:
    from parflex.mechanics.redundancy import Rows


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

    Raises InputError where tips and attachments do not match.
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

        The modes of a flexible platform go to a NetCDF-4 file beside it. Raises InputError where a
        file cannot be written.
        """
        written: Path = opened("Robot.to_file")(self, path)
        return written

    @property
    def home(self) -> State:
        """The platform at its home pose, undeformed and at rest."""
        still = np.zeros(self.platform.modes)
        return State(*self.home_pose, np.zeros(6), still, still)

    @cached_property
    def groups(self) -> tuple[LegGroup, ...]:
        """The legs, gathered by type and structure."""
        gathered: dict[object, list[LegGroup]] = {}
        forces = joints = 0
        for number, leg in enumerate(self.legs):
            group = alone(number, leg, forces, joints)
            gathered.setdefault((group.type.name, leg.structure), []).append(group)
            forces, joints = forces + group.forces.size, joints + group.carried.size
        return tuple(side_by_side(groups) for groups in gathered.values())

    @cached_property
    def closed(self) -> bool:
        """Whether every state is on the closure: each tip is where the platform has it by itself."""
        return all(group.closed for group in self.groups)

    @cached_property
    def layout(self) -> Layout:
        """What the flat state holds."""
        carried = [0] * len(self.legs)
        for group in self.groups:
            for number in group.legs:
                carried[number] = group.carried.shape[1]
        return Layout(self.platform.modes, tuple(carried))

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
    def held(self) -> Array:
        """(attachments, tips): 1 where the tip holds the attachment."""
        count = len(self.platform.attachments)
        return (np.arange(count)[:, None] == self.tip_attachments).astype(float)

    @cached_property
    def force_order(self) -> Array:
        """For each entry of Γ, its place in the order of the groups."""
        parts = [group.forces.reshape(-1) for group in self.groups]
        return np.argsort(np.concatenate([np.zeros(0, dtype=int), *parts]))

    @cached_property
    def carried_order(self) -> Array:
        """For each joint carried in the state, its place in the order of the groups."""
        parts = [group.carried.reshape(-1) for group in self.groups]
        return np.argsort(np.concatenate([np.zeros(0, dtype=int), *parts]))

    @cached_property
    def rows(self) -> "Rows":
        """Which rows of the closure the models solve, and which depend on them."""
        from parflex.mechanics.redundancy import closure_rows

        return closure_rows(self)


def alone(number: int, leg: Leg, forces: int, joints: int) -> LegGroup:
    """A group of one leg, of the first type that knows it; its first entries in Γ and in q."""
    n = len(leg.joints)
    actuated = tuple(j for j, joint in enumerate(leg.joints) if joint.mu)
    bare = LegGroup(
        type=ALL_LEG_TYPES[-1],
        legs=(number,),
        chain=chain_of(leg),
        rotation=np.asarray(leg.rotation)[None],
        origin=np.asarray(leg.origin)[None],
        tip_frames=tuple(tip.frame - 1 for tip in leg.tips),
        offsets=np.array([[tip.offset for tip in leg.tips]]),
        attachments=np.array([[tip.attachment for tip in leg.tips]]),
        actuated=actuated,
        forces=forces + np.arange(len(actuated))[None],
        posture=np.zeros((1, n)) if leg.posture is None else np.asarray(leg.posture)[None],
        branch=np.ones(1),
        carried=np.zeros((1, 0), dtype=int),
    )
    for known in ALL_LEG_TYPES:
        group: LegGroup | None = bare._replace(type=known)
        if known.recognises(leg) and group is not None:
            if known.carries:
                return group._replace(carried=joints + np.arange(n)[None])
            group = group if leg.posture is None else settled(group)
            if group is not None:
                return group
    raise AssertionError("the last leg type takes every leg")


def side_by_side(groups: list[LegGroup]) -> LegGroup:
    """Groups of one type and equal structure as one."""
    first = groups[0]
    if len(groups) == 1:
        return first

    arrays = [name for name, value in first._asdict().items() if isinstance(value, np.ndarray)]
    together = {name: np.concatenate([getattr(group, name) for group in groups]) for name in arrays}
    chain = joined([group.chain for group in groups])
    legs = tuple(number for group in groups for number in group.legs)
    same: dict[str, Any] = {**together, "chain": chain, "legs": legs}
    return first._replace(**same)
