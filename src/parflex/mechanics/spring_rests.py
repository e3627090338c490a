"""Springs of joints whose rest moves: k (q − r) + Fv (q̇ − ṙ) acts in place of k (q − q_0) + Fv q̇.

The springs are the joints with k > 0, leg by leg, joint by joint.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from parflex.base.array import Array, join
from parflex.mechanics.chain import REST_RATE
from parflex.mechanics.legs.base import LegGroup
from parflex.mechanics.mechanism import Mechanism
from parflex.robot.robot import Robot


def springs(robot: Robot) -> Iterator[tuple[int, int]]:
    """The springs of a robot, by leg and joint, from 0."""
    for i, leg in enumerate(robot.legs):
        for j, joint in enumerate(leg.joints):
            if joint.k > 0:
                yield i, j


def rests_move(mechanism: Mechanism) -> bool:
    """True for a mechanism that `with_rests` has made."""
    return any(REST_RATE in group.chain.tables for group in mechanism.groups)


def own_rests(mechanism: Mechanism) -> Array:
    """(2 s,): the rests q_0 of the springs, m or rad, and their rates, which are zero."""
    legs = mechanism.robot.legs
    rests = [legs[i].joints[j].q_0 for i, j in springs(mechanism.robot)]
    return np.array([*rests, *(0.0 for _ in rests)])


def with_rests(mechanism: Mechanism, rest: Array) -> Mechanism:
    """The mechanism whose springs have these rests and rates (…, 2 s), r then ṙ, in place of their own."""
    number = {spring: place for place, spring in enumerate(springs(mechanism.robot))}
    return replace(mechanism, groups=tuple(moved(group, number, rest) for group in mechanism.groups))


def moved(group: LegGroup, number: dict[tuple[int, int], int], rest: Array) -> LegGroup:
    """A group of legs with these rests and rates (…, 2 s) of its springs, whose places are those of `number`;
    other joints keep theirs."""
    chain, s = group.chain, len(number)
    own = np.asarray(chain.q_0).reshape(-1)
    every = np.arange(own.size).reshape(len(group.legs), chain.n)
    places = [[number.get((i, j), -1) for j in range(chain.n)] for i in group.legs]
    at = np.array(places, dtype=int).reshape(every.shape)
    rests = join([rest[..., :s], own])[..., np.where(at < 0, s + every, at)]
    rates = join([rest[..., s:], np.zeros(1)])[..., np.where(at < 0, s, at)]
    return group._replace(chain=chain.with_moving_rests(rests, rates))
