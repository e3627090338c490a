"""The Delta robot: three arms overhead, each with two parallel rods, which leave the platform level."""

from typing import Any

import numpy as np

from parflex.base.array import Array
from parflex.robot.body import FlexibleBody
from parflex.robot.leg import Joint, Leg, Tip
from parflex.robot.materials import named
from parflex.robot.robot import Robot
from parflex.robots.entry import Entry
from parflex.robots.links import together, tube
from parflex.robots.rings import THIRDS, plate, ring, standing

BASE_RADIUS = 0.25  # m
SIDE = 0.15  # m, of the hexagonal plate; two rods hold the ends of every other side
PLATFORM = (-30, 30, 90, 150, 210, 270)  # degrees: the corners of the plate
ARM, ROD = 0.35, 0.80  # m
HOME = (0.0, 0.0, -0.70)  # m, under the motors
PLATE: dict[str, Any] = {"thickness": 3e-3, "material": "steel"}

ARM_LINK = together(
    tube(named("CFRP quasi-isotropic").density, 0.025, (0, 0, 0), (ARM, 0, 0), bore=0.023),
    tube(named("aluminium").density, 0.015, (ARM, 0, -SIDE / 2), (ARM, 0, SIDE / 2)),
    tube(named("steel").density, 0.020, (0, 0, -0.03), (0, 0, 0.03)),
)
ROD_LINK = tube(named("CFRP quasi-isotropic").density, 0.008, (0, 0, 0), (ROD, 0, 0), bore=0.006)
ROTOR = 0.01  # kg m², of the motor behind its gear

# the arm, turning downwards; twice a cross of no mass and a rod along its x
JOINTS = (
    Joint(0, sigma=0, mu=1, alpha=-np.pi / 2, **ARM_LINK, IA=ROTOR),
    Joint(1, sigma=0, d=ARM, r=-SIDE / 2),
    Joint(2, sigma=0, alpha=np.pi / 2, **ROD_LINK),
    Joint(1, sigma=0, d=ARM, r=SIDE / 2),
    Joint(4, sigma=0, alpha=np.pi / 2, **ROD_LINK),
)


def corners() -> Array:
    """The corners (6, 2) m of the plate, two per leg."""
    return ring(SIDE, PLATFORM)


def leg(number: int) -> Leg:
    """One of three equal legs, its knee outside."""
    rotation, origin = standing(BASE_RADIUS, THIRDS[number])
    tips = tuple(Tip(frame, (ROD, 0, 0), 2 * number + i) for i, frame in enumerate((3, 5)))
    return Leg(rotation, origin, JOINTS, tips, posture=(0.3, 1.8, 0.0, 1.8, 0.0))


def delta(modes: int = 9, *, platform: FlexibleBody | None = None, damping_ratio: float = 0.02) -> Robot:
    """A Delta robot; it moves in x, y and z and does not turn.

    modes is the number of elastic modes of the steel plate, 0 for a rigid one. A platform of your
    own replaces the plate; it needs six attachments. Parameters are invented but realistic.
    """
    body = plate(corners(), modes, damping_ratio, **PLATE) if platform is None else platform
    return Robot(tuple(map(leg, range(3))), body, home_pose=(HOME, np.eye(3)))


ENTRY = Entry(
    "Delta",
    delta,
    output=(0, 1, 2),
    moves=(
        ((0.15, -0.10, 0.05), (0.0, 0.0, 0.0)),
        ((-0.15, 0.05, -0.08), (0.0, 0.0, 0.0)),
        ((0.05, 0.15, -0.03), (0.0, 0.0, 0.0)),
    ),
    source="topology: Clavel 1988; parameters our own",
)
