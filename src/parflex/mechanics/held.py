"""Soft tips that hold the platform: the mechanism that a robot would be if its joints did not give."""

from dataclasses import replace
from functools import lru_cache

from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.redundancy import solvable
from parflex.robot.robot import Robot


def held(mechanism: Mechanism) -> Mechanism:
    """The mechanism on a base at rest whose soft tips hold the platform, each leg of the type that this makes
    it; itself where no tip is soft. Raises OutOfReach where the legs do not meet the platform at home."""
    if not mechanism.soft:
        return mechanism
    firm, chains = holding(mechanism.robot), {group.legs: group.chain for group in mechanism.groups}
    groups = tuple(group._replace(chain=chains.get(group.legs, group.chain)) for group in firm.groups)
    return replace(firm, groups=groups, platform=mechanism.platform, gravity=mechanism.gravity)


@lru_cache(maxsize=32)
def holding(robot: Robot) -> Mechanism:
    """The mechanism of a robot whose soft tips hold the platform."""
    return solvable(replace(robot, legs=[leg.holding for leg in robot.legs]))
