"""A robot as the mechanics reads it: legs gathered, tables side by side, and the orders that undo this."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.mechanics.health_places import Health
from parflex.mechanics.legs import ALL_LEG_TYPES, LegGroup, LegType
from parflex.mechanics.legs.gathered import alone, side_by_side
from parflex.mechanics.platform import Platform, platform_of
from parflex.robot.carrying import Base
from parflex.robot.layout import Layout, spans
from parflex.robot.robot import Robot


class Rows(NamedTuple):
    """Closure rows by number: independent ones, those that depend on them, those of soft tips, where no force
    is sought, and the way back."""

    kept: Array
    dropped: Array
    released: Array
    order: Array


@dataclass(frozen=True, eq=False)
class Mechanism:
    """The data of a robot as the mechanics reads them.

    Legs of one type and equal structure are a group, and inside the mechanics tips, joints and forces stand
    group by group; `force_order`, `joint_order` and `tip_order` put them in the order of the legs, in which
    everybody else has them. With other numbers in its tables, or on a base that moves, it is another
    mechanism, `dataclasses.replace`; without a base Σ0 is the world's frame.
    `rows`, of which the models solve the independent ones, those of legs that do not bend, and those of a
    robot of which nothing bends are found by `redundancy.with_rows`. `elimination` forms the contact system
    in another order than `contact.eliminated` does, where that is quicker.
    """

    robot: Robot
    groups: tuple[LegGroup, ...]
    platform: Platform
    gravity: Array  # (3,) in the world
    rows: Rows | None = None
    rows_stiff: Rows | None = None
    rows_unbent: Rows | None = None
    elimination: Callable[[Any, Array], Any] | None = None
    base: Base | None = None

    @property
    def solved_rows(self) -> Rows:
        """The rows of the closure that the models solve."""
        assert self.rows is not None, "the models need redundancy.with_rows(mechanism)"
        return self.rows

    @cached_property
    def n_forces(self) -> int:
        """m, the number of actuated joints."""
        return self.robot.n_forces

    @cached_property
    def layout(self) -> Layout:
        """The layout of the flat state."""
        joints, elastic, branched = [0] * len(self.robot.legs), [0] * len(self.robot.legs), []
        for group in self.groups:
            for number in group.legs:
                joints[number] = sum(z < group.chain.n for z in group.kept)
                elastic[number] = len(group.kept) - joints[number]
                branched += [number] * group.branched.shape[1]
        return Layout(self.platform.modes, tuple(joints), tuple(sorted(branched)), tuple(elastic))

    @cached_property
    def soft(self) -> bool:
        """True where a tip is soft."""
        return any(any(group.soft) for group in self.groups)

    @property
    def gives(self) -> bool:
        """True where a link or a tip gives between motors and platform."""
        return self.soft or bool(np.any(self.bends))

    @cached_property
    def firm(self) -> Array:
        """The rows of the closure, of 3 for each tip group by group, that tips have which are not soft."""
        soft = np.concatenate([np.zeros(0, dtype=bool), *(np.tile(g.soft, len(g.legs)) for g in self.groups)])
        return np.flatnonzero(np.repeat(~soft, 3))

    @cached_property
    def tight(self) -> "Mechanism":
        """The mechanism of the robot whose soft tips hold the platform: its legs may close by themselves."""
        return mechanism_of(replace(self.robot, legs=[leg.holding for leg in self.robot.legs]))

    @cached_property
    def closed(self) -> bool:
        """True where every state is on the closure: each tip is soft, or at its point by itself."""
        return all(group.closed for group in self.groups)

    @cached_property
    def flexed(self) -> bool:
        """True where a tip has a flexure, which reads how the platform's sections turn."""
        return any(group.flexures is not None for group in self.groups)

    @cached_property
    def size(self) -> float:
        """Root mean square distance of the attachments from their centre, m."""
        return self.platform.body.size

    @cached_property
    def legs(self) -> Array:
        """The numbers of the legs, group by group."""
        return np.array([number for group in self.groups for number in group.legs], dtype=int)

    @cached_property
    def attachments(self) -> Array:
        """The attachment that each tip holds."""
        return stacked(group.attachments for group in self.groups)

    @cached_property
    def held(self) -> Array:
        """(attachments, tips in the order of the legs): 1 where the tip holds the attachment."""
        count = len(self.platform.body.attachments)
        by_leg = [tip.attachment for leg in self.robot.legs for tip in leg.tips]
        return (np.arange(count)[:, None] == np.array(by_leg, dtype=int)).astype(float)

    @cached_property
    def tip_order(self) -> Array:
        """The place of each tip, by leg, among the tips by group."""
        numbers = [n for group in self.groups for n in np.repeat(group.legs, len(group.tip_frames))]
        return np.argsort(np.array(numbers, dtype=int), kind="stable")

    @cached_property
    def force_order(self) -> Array:
        """The place of each entry of Γ among the actuated joints by group."""
        return np.argsort(stacked(group.forces for group in self.groups))

    @cached_property
    def carried_order(self) -> Array:
        """The place of each coordinate carried in the state among the carried ones by group."""
        return np.argsort(stacked(group.carried for group in self.groups))

    @cached_property
    def kept(self) -> Array:
        """The coordinates z that the state carries, in its order, by number among those of all legs, group
        by group."""
        found, first = [np.zeros(0, dtype=int)], 0
        for group in self.groups:
            legs = first + group.chain.size * np.arange(len(group.legs))
            found.append((legs[:, None] + np.array(group.kept, dtype=int)).reshape(-1))
            first += group.chain.size * len(group.legs)
        return np.concatenate(found)[self.carried_order]

    @cached_property
    def contact_order(self) -> Array:
        """The place of each contact force component, by leg and tip, among those by group."""
        return (3 * self.tip_order[:, None] + np.arange(3)).reshape(-1)

    @cached_property
    def health(self) -> Health:
        """The places of reach, regularity, flexures and gaps of the legs in `system.health`."""
        gaps = [n for g in self.groups if not g.closed for n in np.repeat(g.legs, len(g.firm))]
        flexed = [n for g in self.groups if g.flexures for n in np.repeat(g.legs, len(g.tip_frames))]
        parts = spans(len(self.legs), len(self.legs), len(flexed), len(gaps), len(gaps))
        reach, regularity, opening, gap, gap_rate = parts
        numbers = [np.array(each, dtype=int) for each in (flexed, gaps)]
        orders = [np.argsort(each, kind="stable") for each in (self.legs, *numbers)]
        legs = [np.sort(each) for each in numbers]
        return Health(reach, regularity, opening, gap, gap_rate, *orders, *legs)

    @cached_property
    def slides(self) -> Array:
        """The prismatic joints, True, among the coordinates z of all legs, group by group."""
        return self._of_joints("sigma")

    @cached_property
    def driven(self) -> Array:
        """The actuated joints, True, among the coordinates z of all legs, group by group."""
        return self._of_joints("mu")

    @cached_property
    def bends(self) -> Array:
        """The elastic ones, True, among the coordinates z of all legs, group by group."""
        legs = [self.robot.legs[n] for n in self.legs]
        return np.array([z >= len(leg.joints) for leg in legs for z in range(leg.size)], dtype=bool)

    @cached_property
    def roots(self) -> Array:
        """√m (kg^½) of the link to each elastic one of the coordinates z of all legs; 0 of joints. Of drives
        it is 1 for sliding ones, and 1/m, by the platform's size, for those that turn."""
        found: list[float] = []
        for leg in (self.robot.legs[n] for n in self.legs):
            found += [0.0] * len(leg.joints)
            for body in (joint.body for joint in leg.joints if joint.body is not None):
                found += [np.sqrt(body.moments.m)] * body.modes
            found += [1.0 if leg.joints[j].sigma else 1.0 / self.size for j in leg.drives]
        return np.array(found)

    def _of_joints(self, flag: str) -> Array:
        """A flag of the joints, False of elastic coordinates, group by group."""
        legs = [self.robot.legs[n] for n in self.legs]
        flags = [[bool(getattr(j, flag)) for j in leg.joints] + [False] * leg.bends for leg in legs]
        return np.array([each for leg in flags for each in leg], dtype=bool)


def stacked(parts: Any) -> Array:
    """Numbers of all groups, one after the other."""
    return np.concatenate([np.zeros(0, dtype=int), *(part.reshape(-1) for part in parts)])


def mechanism_of(robot: Robot, leg_types: Sequence[LegType] = ALL_LEG_TYPES) -> Mechanism:
    """The mechanism of a robot, each leg of the first type that knows it; the last type takes every leg."""
    gathered: dict[object, list[LegGroup]] = {}
    forces = joints = branches = 0
    for number, leg in enumerate(robot.legs):
        group = alone(number, leg, leg_types)
        group = group._replace(
            forces=forces + group.forces, carried=joints + group.carried, branched=branches + group.branched
        )
        forces, joints = forces + group.forces.size, joints + group.carried.size
        branches += group.branched.size
        gathered.setdefault((group.type.name, leg.structure, group.branched.size), []).append(group)
    groups = tuple(side_by_side(groups) for groups in gathered.values())
    return Mechanism(robot, groups, platform_of(robot.platform), np.asarray(robot.gravity))
