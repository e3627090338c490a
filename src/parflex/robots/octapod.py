"""The octapod: eight UPS legs, two more than there are freedoms, under an octagonal plate."""

from typing import Any

import numpy as np

from parflex.base.array import Array
from parflex.robot.bar import Bar
from parflex.robot.body import FlexibleBody
from parflex.robot.leg import Leg
from parflex.robot.materials import named
from parflex.robot.robot import Robot
from parflex.robots.entry import Entry
from parflex.robots.legs import UPS
from parflex.robots.rings import plate, ring, standing

BASE_RADIUS, PLATFORM_RADIUS = 0.70, 0.45  # m
BASE = (-12, 12, 78, 102, 168, 192, 258, 282)  # degrees: the universal joints
PLATFORM = (-30, 30, 60, 120, 150, 210, 240, 300)  # degrees: the corners of the plate
HOME = (0.0, 0.0, 0.85)  # m
PLATE: dict[str, Any] = {"thickness": 10e-3, "material": "steel"}

STRUT = UPS(
    cylinder=Bar(outer=0.070, inner=0.056, length=0.55, density=named("steel").density),
    rod=Bar(outer=0.028, length=0.55, density=named("steel").density),
    rotor_inertia=8.0,  # kg, of the motor behind its screw
)


def corners() -> Array:
    """The corners (8, 2) m of the plate, one per leg."""
    return ring(PLATFORM_RADIUS, PLATFORM)


def leg(number: int) -> Leg:
    """One of eight equal legs."""
    return STRUT.placed(*standing(BASE_RADIUS, BASE[number]), (number,))


def octapod(modes: int = 10, *, platform: FlexibleBody | None = None, damping_ratio: float = 0.02) -> Robot:
    """A hexapod with eight legs: six freedoms, eight actuators, redundant actuation.

    modes is the number of elastic modes of the steel plate, 0 for a rigid one. A platform of your
    own replaces the plate; it needs eight attachments. Parameters are invented but realistic.
    """
    body = plate(corners(), modes, damping_ratio, **PLATE) if platform is None else platform
    return Robot(tuple(map(leg, range(8))), body, home_pose=(HOME, np.eye(3)))


ENTRY = Entry(
    "octapod",
    octapod,
    output=(0, 1, 2, 3, 4, 5),
    moves=(
        ((0.08, -0.06, 0.06), (0.10, 0.05, -0.10)),
        ((-0.08, 0.08, -0.06), (-0.10, 0.10, 0.12)),
    ),
    source="topology: a hexapod with two more legs, Müller 2005; parameters our own",
)
