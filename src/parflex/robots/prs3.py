"""The 3-PRS platform: three carriages on upright columns, rods on hinges, a triangular plate."""

from typing import Any

import numpy as np

from parflex.base.array import Array
from parflex.robot.body import FlexibleBody
from parflex.robot.leg import Joint, Leg, Tip
from parflex.robot.materials import named
from parflex.robot.robot import Robot
from parflex.robots.entry import Entry
from parflex.robots.links import box
from parflex.robots.rings import THIRDS, cut_triangle, plate, short_sides, standing

BASE_RADIUS, PLATFORM_RADIUS = 0.50, 0.30  # m
ROD = 0.45  # m
HOME = (0.0, 0.0, 0.70)  # m over the feet of the columns
PLATE: dict[str, Any] = {"thickness": 6e-3, "material": "steel"}

CARRIAGE = box(named("aluminium").density, (0.05, 0.14, 0.14))
ROD_LINK = box(named("aluminium").density, (ROD, 0.02, 0.04), (ROD / 2, 0, 0))
ROTOR = 2.0  # kg, of the motor behind its screw

# the carriage along z; the rod along x2, on a hinge across the column's plane
JOINTS = (
    Joint(0, sigma=1, mu=1, **CARRIAGE, IA=ROTOR),
    Joint(1, sigma=0, alpha=-np.pi / 2, **ROD_LINK),
)


def corners() -> Array:
    """The corners (6, 2) m of the plate, a triangle without its tips."""
    return cut_triangle(PLATFORM_RADIUS)


def leg(number: int) -> Leg:
    """One of three equal legs, its x inwards; the rod rises from its carriage."""
    rotation, origin = standing(BASE_RADIUS, THIRDS[number], turn=180.0)
    return Leg(rotation, origin, JOINTS, (Tip(2, (ROD, 0, 0), number),), posture=(0.3, -1.0))


def prs3(modes: int = 9, *, platform: FlexibleBody | None = None, damping_ratio: float = 0.02) -> Robot:
    """A platform on three carriages; it rises, rolls and pitches, and drifts a little as it does.

    modes is the number of elastic modes of the steel plate, 0 for a rigid one. A platform of your
    own replaces the plate; it needs three attachments. Parameters are invented but realistic.
    """
    if platform is None:
        platform = plate(corners(), modes, damping_ratio, short_sides(corners()), **PLATE)
    return Robot(tuple(map(leg, range(3))), platform, home_pose=(HOME, np.eye(3)))


ENTRY = Entry(
    "3-PRS",
    prs3,
    output=(2, 3, 4),
    moves=(
        ((0.0, 0.0, 0.08), (0.12, 0.0, 0.0)),
        ((0.0, 0.0, -0.08), (0.0, 0.12, 0.0)),
        ((0.0, 0.0, 0.04), (-0.10, -0.08, 0.0)),
    ),
    source="topology: Carretero, Podhorodeski, Nahon and Gosselin 2000; columns upright, parameters our own",
)
