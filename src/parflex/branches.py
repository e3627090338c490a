"""Assembly branches that a state names by its joints, where the robot's legs name none."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from parflex.array import Array
from parflex.legs.base import LegGroup, joints_at, tips_at
from parflex.robot import Robot


def other_branches(robot: Robot, joints: Sequence[Array | None]) -> tuple[int, ...]:
    """Numbers of the legs without a posture whose joints (…, n_i) are on another branch than theirs.

    Of a batch the first state counts; whether the others agree is checked with the closure.
    """
    found: list[int] = []
    for group in robot.groups:
        places = [i for i, n in enumerate(group.legs) if joints[n] is not None]
        if group.type.carries or len(places) < len(group.legs):
            continue
        q = np.stack([first_of(joints[n]) for n in group.legs])
        found += [n for n in differing(group, q) if robot.legs[n].posture is None]
    return tuple(sorted(found))


def first_of(q: Array | None) -> Array:
    """One (n,) of a batch (…, n)."""
    every = np.asarray(q)
    return every.reshape(-1, every.shape[-1])[0] if every.size else np.zeros(every.shape[-1])


def differing(group: LegGroup, q: Array) -> list[int]:
    """Legs whose joints q (L, n) are on another branch than the group has them on."""
    at = joints_at(group.chain, q)
    with np.errstate(invalid="ignore", divide="ignore"):
        branch = group.type.branch(group, at, tips_at(group, at))
    return [group.legs[i] for i in np.flatnonzero(branch != group.branch)]


def on_branches(robot: Robot, numbers: Sequence[int], joints: Sequence[Array | None]) -> Robot:
    """The robot with these legs on the branch of the joints."""
    legs = tuple(
        replace(leg, posture=first_of(joints[n])) if n in numbers else leg for n, leg in enumerate(robot.legs)
    )
    return replace(robot, legs=legs)
