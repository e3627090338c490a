"""Rest of flexures that nobody gives: the rotation in which their two sections stand at home, undeformed."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from parflex.base.array import stack, transpose
from parflex.mechanics import chain
from parflex.mechanics.closure import ALL, POSE, closed
from parflex.mechanics.flat_state import flat_state
from parflex.mechanics.leg_terms import LegTerms
from parflex.mechanics.legs import ALL_LEG_TYPES, LegGroup, LegType
from parflex.mechanics.mechanism import Mechanism, mechanism_of
from parflex.mechanics.system import assembled
from parflex.robot.robot import Robot


def rested(robot: Robot, leg_types: Sequence[LegType] = ALL_LEG_TYPES) -> Mechanism:
    """The mechanism of a robot, whose flexures have the rests that are given, or those at home.

    At a home that the legs do not reach, or only nearly, rests are those of the nearest pose that was found.
    """
    mechanism = mechanism_of(robot, leg_types)
    held = [group.flexures for group in mechanism.groups if group.flexures is not None]
    if all(np.all(flexures.given) for flexures in held):
        return mechanism
    x = flat_state(mechanism, robot.home)
    if not mechanism.closed:
        for freedom in (POSE, ALL):
            x, _ = closed(mechanism, x, freedom)
    with np.errstate(invalid="ignore", divide="ignore"):
        legs = assembled(mechanism, x).legs
    return replace(mechanism, groups=tuple(at_rest(leg) for leg in legs))


def at_rest(leg: LegTerms) -> LegGroup:
    """The leg's group with rests R_secᵀ R_leg where none is given; R_sec is Σp, undeformed."""
    group = leg.group
    if group.flexures is None:
        return group
    R_leg = stack([chain.tip_rotation(leg.bent, tip) for tip in group.points(leg.joints.bend)], axis=-3)
    home = transpose(leg.R_ip) @ R_leg
    home = np.where(np.isfinite(home), home, np.eye(3))
    rest = np.where(group.flexures.given[..., None, None], group.flexures.rest, home)
    return group._replace(flexures=group.flexures._replace(rest=rest))
