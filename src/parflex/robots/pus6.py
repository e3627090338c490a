"""The 6-PUS hexapod: six carriages on three parallel rails, two on each, and six rods."""

from typing import Any

import numpy as np

from parflex.base.array import Array
from parflex.base.spatial import rotation_about_z
from parflex.robot.bar import Bar
from parflex.robot.body import FlexibleBody
from parflex.robot.leg import Leg
from parflex.robot.materials import named
from parflex.robot.robot import Robot
from parflex.robots.entry import Entry
from parflex.robots.legs import PUS
from parflex.robots.rings import plate, ring

RAILS = (-0.45, -0.45, 0.0, 0.0, 0.45, 0.45)  # m: y of the rail of each leg
END = 1.0  # m from the middle of a rail to its ends
PLATFORM_RADIUS = 0.25  # m
PLATFORM = (70, 110, 190, 230, 310, 350)  # degrees: the corners of the plate
CORNER = (2, 5, 3, 4, 1, 0)  # the corner that each leg holds
HOME = (0.0, 0.0, 0.48)  # m over the rails, which lie along x
PLATE: dict[str, Any] = {"thickness": 6e-3, "material": "steel"}

SLIDER = PUS(
    carriage=1.0368,  # kg: 80 × 40 × 120 mm of aluminium
    rod=Bar(outer=0.028, inner=0.024, length=0.8, density=named("CFRP quasi-isotropic").density),
)


def corners() -> Array:
    """The corners (6, 2) m of the plate."""
    return ring(PLATFORM_RADIUS, PLATFORM)


def leg(number: int) -> Leg:
    """Every rail has a carriage from each end; the rod leans towards the other."""
    side = (-1) ** number
    rotation = rotation_about_z(np.asarray(np.pi * (number % 2)))
    origin = (-END * side, RAILS[number], 0.0)
    return SLIDER.placed(rotation, origin, (CORNER[number],), posture=(0.2, np.pi / 2, 0.8))


def pus6(modes: int = 9, *, platform: FlexibleBody | None = None, damping_ratio: float = 0.02) -> Robot:
    """A hexapod with six linear motors; six freedoms.

    modes is the number of elastic modes of the steel plate, 0 for a rigid one. A platform of your
    own replaces the plate; it needs six attachments. Parameters are invented but realistic.
    """
    body = plate(corners(), modes, damping_ratio, **PLATE) if platform is None else platform
    return Robot(tuple(map(leg, range(6))), body, home_pose=(HOME, np.eye(3)))


ENTRY = Entry(
    "6-PUS",
    pus6,
    output=(0, 1, 2, 3, 4, 5),
    moves=(
        ((0.15, -0.04, 0.05), (0.10, 0.05, -0.08)),
        ((-0.15, 0.05, -0.05), (-0.08, 0.10, 0.10)),
    ),
    source="topology: Hexaglide, Honegger, Codourey and Burdet 1997; parameters our own",
)
