"""Leg types: the inverse geometry of one kind of leg, for all legs of equal structure."""

from abc import ABC, abstractmethod
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, stack
from parflex.mechanics.chain import Chain, Frames, Joints, Point, frames, seat_on, tip_position
from parflex.mechanics.flexures import Flexures
from parflex.robot.leg import Leg

REGULAR = 1e-5  # of the margin of regularity: round-off of 1e-16 leaves 1e-8 and more under a square root


class LegGroup(NamedTuple):
    """L legs of one type and equal structure, their tables side by side."""

    type: "LegType"
    legs: tuple[int, ...]  # their numbers in the robot
    chain: Chain
    rotation: Array  # (L, 3, 3)
    origin: Array  # (L, 3)
    tip_frames: tuple[int, ...]  # index of the link that carries each of the t tips
    tip_seats: tuple[int, ...]  # the attachment of its link that each tip is on; −1 on rigid ones
    offsets: Array  # (L, t, 3)
    attachments: Array  # (L, t) int
    actuated: tuple[int, ...]  # joint indices
    S: Array  # (z, actuated), what the motors move: the force of one acts at θ = Sᵀ z
    forces: Array  # (L, actuated) int, positions in Γ
    posture: Array  # (L, n)
    branch: Array  # (…, L), ±1: the solution of the inverse geometry
    branched: Array  # (L, 1) int, positions among the state's branches; (L, 0) where the branch is fixed
    kept: tuple[int, ...]  # the coordinates z of a leg that the state carries
    carried: Array  # (L, kept) int, their positions among all coordinates that the state carries
    flexures: Flexures | None  # of the tips
    soft: tuple[bool, ...]  # of each tip, whether it may leave the platform's point

    def on(self, branch: Array) -> "LegGroup":
        """The group on a branch (…, L, 1) of the state; as it is for (…, L, 0)."""
        return self._replace(branch=branch[..., 0]) if branch.shape[-1] else self

    @property
    def closed(self) -> bool:
        """True where the closure holds by itself: each tip is where the platform has it, or may leave it."""
        return all(self.soft) or (not self.type.carries and 3 * len(self.tip_frames) == self.chain.n)

    @property
    def firm(self) -> list[int]:
        """The rows, of 3 for each tip, of the tips that are not soft."""
        return [3 * t + i for t, soft in enumerate(self.soft) if not soft for i in range(3)]

    @property
    def reads_tips(self) -> bool:
        """True where the equations of the legs read where the platform has their tips."""
        return any(self.soft) or not self.type.carries

    def bend(self, kept: Array) -> Array:
        """Elastic coordinates (…, L, ΣN + d), those of d drives last, or rates, of all that the state
        carries (…, L, kept)."""
        return kept[..., kept.shape[-1] - (self.chain.size - self.chain.n) :]

    def points(self, bend: Array) -> list[Point]:
        """The tips on their links, which are bent by (…, L, ΣN)."""
        found = []
        for t, (j, attachment) in enumerate(zip(self.tip_frames, self.tip_seats, strict=True)):
            seat = seat_on(self.chain, j, attachment, bend)
            found.append(Point(j, self.offsets[:, t] if seat is None else seat.place, seat))
        return found


class LegType(ABC):
    """The inverse geometry of one kind of leg, found by its table.

    Of legs that carry no joints the state still carries the elastic coordinates e of flexible links: the
    formulas hold for the leg as it is bent. Where a leg has fewer joints than its tips have coordinates, they
    hold for tips that the leg can reach exactly, and are smooth about them.
    """

    name: str
    carries = False  # whether the legs' joints are carried in the state
    two_branches = False  # whether the inverse geometry has two solutions

    @abstractmethod
    def recognises(self, leg: Leg) -> bool:
        """True where the formulas of this type hold for the leg's table."""

    def branch(self, group: LegGroup, joints: Joints, tips: Array) -> Array:
        """The solution (L,), +1 or −1, that the joints belong to at their tips (L, t, 3) in Σ0i."""
        return np.ones(len(group.legs))

    @abstractmethod
    def joints(self, group: LegGroup, tips: Array, kept: Array) -> Joints:
        """Joint variables from the tip positions (…, L, t, 3) in Σ0i and carried coordinates (…, L, kept)."""

    @abstractmethod
    def rates(
        self, group: LegGroup, frames: Frames, joints: Joints, tips: Array, v: Array, kept: Array
    ) -> Array:
        """Joint rates q̇ (…, L, n) from positions and velocities (…, L, t, 3) of the tips in Σ0i, and carried
        rates.

        The velocities are those that joints give to the tips: without what the links' bending gives.
        """

    @abstractmethod
    def margins(self, group: LegGroup, joints: Joints, tips: Array) -> tuple[Array, Array]:
        """Reach and regularity (…, L), of order 1 where all is well: the first is not positive where
        the leg cannot reach its tips, the second is zero where its inverse geometry is singular."""


def joints_at(chain: Chain, q: Array, bend: Array | None = None) -> Joints:
    """Joint variables of given positions q (…, L, n), of links that are bent (…, L, ΣN) or not."""
    slides = chain.sigma
    still = np.zeros((*q.shape[:-1], chain.size - chain.n))
    one, zero = np.ones(()), np.zeros(())
    return Joints(
        cos=stack([one if slide else np.cos(q[..., j]) for j, slide in enumerate(slides)]),
        sin=stack([zero if slide else np.sin(q[..., j]) for j, slide in enumerate(slides)]),
        length=stack([q[..., j] if slide else zero for j, slide in enumerate(slides)]),
        bend=still if bend is None else bend,
    )


def tips_at(group: LegGroup, joints: Joints) -> Array:
    """Tip positions (…, L, t, 3) in Σ0i."""
    frame = frames(group.chain, joints)
    return stack([tip_position(frame, point) for point in group.points(joints.bend)], axis=-2)


def regular(group: LegGroup, q: Array) -> bool:
    """True where the inverse geometry is not singular at joints q (L, n)."""
    at = joints_at(group.chain, q)
    with np.errstate(invalid="ignore", divide="ignore"):
        regularity = group.type.margins(group, at, tips_at(group, at))[1]
    return bool(np.all(np.abs(regularity) > REGULAR))


def settled(group: LegGroup) -> LegGroup | None:
    """The group on the branch of its posture; None where the posture is on no branch of its type."""
    given = joints_at(group.chain, group.posture)
    tips = tips_at(group, given)
    with np.errstate(invalid="ignore", divide="ignore"):
        chosen = group._replace(branch=group.type.branch(group, given, tips))
        found = group.type.joints(chosen, tips, given.bend)
    agree = all(np.allclose(a, b, rtol=0, atol=1e-6) for a, b in zip(found, given, strict=True))
    return chosen if agree else None
