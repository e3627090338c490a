"""The 3-RPS platform: three jacks on hinges under a triangular plate."""

from typing import Any

import numpy as np

from parflex.base.array import Array
from parflex.robot.bar import Bar
from parflex.robot.body import FlexibleBody
from parflex.robot.leg import Leg
from parflex.robot.materials import named
from parflex.robot.robot import Robot
from parflex.robots.entry import Entry
from parflex.robots.legs import RPS
from parflex.robots.rings import THIRDS, cut_triangle, plate, short_sides, standing

BASE_RADIUS, PLATFORM_RADIUS = 0.40, 0.32  # m
HOME = (0.0, 0.0, 0.65)  # m
PLATE: dict[str, Any] = {"thickness": 6e-3, "material": "steel"}

JACK = RPS(  # its hinge lies along the base circle
    cylinder=Bar(outer=0.060, inner=0.048, length=0.40, density=named("steel").density),
    rod=Bar(outer=0.024, length=0.40, density=named("steel").density),
    rotor_inertia=4.0,  # kg, of the motor behind its screw
)


def corners() -> Array:
    """The corners (6, 2) m of the plate, a triangle without its tips."""
    return cut_triangle(PLATFORM_RADIUS)


def leg(number: int) -> Leg:
    """One of three equal legs."""
    return JACK.placed(*standing(BASE_RADIUS, THIRDS[number]), (number,))


def rps3(modes: int = 9, *, platform: FlexibleBody | None = None, damping_ratio: float = 0.02) -> Robot:
    """A platform on three jacks; it rises, rolls and pitches, and drifts a little as it does.

    modes is the number of elastic modes of the steel plate, 0 for a rigid one. A platform of your
    own replaces the plate; it needs three attachments. Parameters are invented but realistic.
    """
    if platform is None:
        platform = plate(corners(), modes, damping_ratio, short_sides(corners()), **PLATE)
    return Robot(tuple(map(leg, range(3))), platform, home_pose=(HOME, np.eye(3)))


ENTRY = Entry(
    "3-RPS",
    rps3,
    output=(2, 3, 4),
    moves=(
        ((0.0, 0.0, 0.06), (0.12, 0.0, 0.0)),
        ((0.0, 0.0, -0.05), (0.0, 0.12, 0.0)),
        ((0.0, 0.0, 0.03), (-0.10, -0.08, 0.0)),
    ),
    source="topology: Hunt 1983; Lee and Shah 1988; parameters our own",
)
