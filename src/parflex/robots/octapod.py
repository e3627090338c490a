"""The octapod: eight UPS legs, two more than there are freedoms, under an octagonal plate."""

from typing import Any

import numpy as np

from parflex.base.array import Array
from parflex.robot.body import FlexibleBody
from parflex.robot.leg import Joint, Leg, Tip
from parflex.robot.materials import named
from parflex.robot.robot import Robot
from parflex.robots.entry import Entry
from parflex.robots.links import tube
from parflex.robots.rings import plate, ring, standing

BASE_RADIUS, PLATFORM_RADIUS = 0.70, 0.45  # m
BASE = (-12, 12, 78, 102, 168, 192, 258, 282)  # degrees: the universal joints
PLATFORM = (-30, 30, 60, 120, 150, 210, 240, 300)  # degrees: the corners of the plate
HOME = (0.0, 0.0, 0.85)  # m
PLATE: dict[str, Any] = {"thickness": 10e-3, "material": "steel"}

CYLINDER = tube(named("steel").density, 0.035, (0, 0, 0), (0, -0.55, 0), bore=0.028)
PISTON = tube(named("steel").density, 0.014, (0, 0, -0.55), (0, 0, 0))
ROTOR = 8.0  # kg, of the motor behind its screw

# the cross, of no mass; the cylinder along −y2; the piston, from its tip down
JOINTS = (
    Joint(0, sigma=0, alpha=-np.pi / 2),
    Joint(1, sigma=0, alpha=np.pi / 2, **CYLINDER),
    Joint(2, sigma=1, mu=1, alpha=np.pi / 2, **PISTON, IA=ROTOR),
)


def corners() -> Array:
    """The corners (8, 2) m of the plate, one per leg."""
    return ring(PLATFORM_RADIUS, PLATFORM)


def leg(number: int) -> Leg:
    """One of eight equal legs."""
    rotation, origin = standing(BASE_RADIUS, BASE[number])
    return Leg(rotation, origin, JOINTS, (Tip(3, attachment=number),))


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
