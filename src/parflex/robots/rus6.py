"""The 6-RUS hexapod: six cranks in vertical planes, in pairs that face each other, and six rods."""

from typing import Any

import numpy as np

from parflex.base.array import Array
from parflex.robot.body import FlexibleBody
from parflex.robot.leg import Joint, Leg, Tip
from parflex.robot.materials import named
from parflex.robot.robot import Robot
from parflex.robots.entry import Entry
from parflex.robots.links import together, tube
from parflex.robots.rings import plate, ring, standing

BASE_RADIUS = 0.5  # m
BASE = (-28, 28, 92, 148, 212, 268)  # degrees: where the motors are
PLATFORM_RADIUS = 0.3  # m
PLATFORM = (-45, 45, 75, 165, 195, 285)  # degrees: the corners of the plate
CRANK, ROD = 0.20, 0.60  # m
HOME = (0.0, 0.0, 0.48)  # m: the cranks are nearly level
PLATE: dict[str, Any] = {"thickness": 6e-3, "material": "steel"}

CRANK_LINK = together(
    tube(named("steel").density, 0.012, (0, 0, -0.02), (0, 0, 0.06)),
    tube(named("aluminium").density, 0.018, (0, 0, 0), (CRANK, 0, 0)),
)
ROD_LINK = tube(named("CFRP quasi-isotropic").density, 0.012, (0, 0, 0), (ROD, 0, 0), bore=0.010)
ROTOR = 0.02  # kg m², of the motor behind its gear

# the crank, about an axis level and radial; the cross, of no mass; the rod along x3
JOINTS = (
    Joint(0, sigma=0, mu=1, alpha=np.pi / 2, **CRANK_LINK, IA=ROTOR),
    Joint(1, sigma=0, d=CRANK),
    Joint(2, sigma=0, alpha=np.pi / 2, **ROD_LINK),
)


def corners() -> Array:
    """The corners (6, 2) m of the plate, one per leg."""
    return ring(PLATFORM_RADIUS, PLATFORM)


def leg(number: int) -> Leg:
    """The crank points towards that of its neighbour; the rod rises and leans inwards."""
    side = (-1) ** number
    rotation, origin = standing(BASE_RADIUS, BASE[number], turn=90.0 * side)
    posture = (0.0, 1.9, -0.45 * side)
    return Leg(rotation, origin, JOINTS, (Tip(3, (ROD, 0, 0), number),), posture)


def rus6(modes: int = 9, *, platform: FlexibleBody | None = None, damping_ratio: float = 0.02) -> Robot:
    """A hexapod with six rotary motors; six freedoms.

    modes is the number of elastic modes of the steel plate, 0 for a rigid one. A platform of your
    own replaces the plate; it needs six attachments. Parameters are invented but realistic.
    """
    body = plate(corners(), modes, damping_ratio, **PLATE) if platform is None else platform
    return Robot(tuple(map(leg, range(6))), body, home_pose=(HOME, np.eye(3)))


ENTRY = Entry(
    "6-RUS",
    rus6,
    output=(0, 1, 2, 3, 4, 5),
    moves=(
        ((0.04, -0.03, 0.05), (0.10, 0.05, -0.10)),
        ((-0.04, 0.03, 0.01), (-0.08, 0.06, 0.08)),
    ),
    source="topology: Hunt 1983; Pierrot, Dauchez and Fournier 1991 (Hexa); parameters our own",
)
