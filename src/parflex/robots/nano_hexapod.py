"""The nano-hexapod: six amplified piezo actuators between flexures, under a steel disc."""

from typing import Any

import numpy as np

from parflex.base.array import Array
from parflex.base.spatial import rotation_about_z
from parflex.robot.bar import Bar
from parflex.robot.body import FlexibleBody
from parflex.robot.coupling import Coupling
from parflex.robot.flexure import Flexure
from parflex.robot.leg import Joint, Leg, Tip
from parflex.robot.robot import Robot
from parflex.robots.entry import Entry
from parflex.robots.legs.base import bar_link
from parflex.robots.rings import plate, ring

# Sizes and springs are those of the public models (ENTRY.source), but for what is called our own.
BASE_RADIUS, PLATFORM_RADIUS = 0.114, 0.110  # m
BASE = (-11, 11, 109, 131, 229, 251)  # degrees
PLATFORM = (-45, 45, 75, 165, 195, 285)  # degrees
HEIGHT = 0.050  # m, between the planes of the joints
DISC_RADIUS = 0.125  # m
DISC = range(15, 375, 30)  # degrees: twelve corners, our own
PLATE: dict[str, Any] = {"thickness": 10e-3, "material": "steel"}  # in the plane of the joints: our own

BENDING, TORSION = 5.0, 260.0  # N m/rad, of a flexure
AXIAL, SHEAR = 94e6, 13e6  # N/m, of a flexure
DAMPING, TURNING_DAMPING = 10.0, 1e-3  # N s/m, N m s/rad, of a flexure

# The actuator: a piezo stack, the motor, pushes through the lever of a shell, itself a spring beside both.
STACK, LEVER, SHELL = 43e6, 1.5e6, 0.4e6  # N/m
SHELL_DAMPING = 10.0  # N s/m
STACK_MASS = 0.05  # kg, as seen at the slide: our own
STACK_DAMPING = 30.0  # N s/m, a hundredth of the critical: our own
STROKE = 150e-6  # m, to both sides: our own
HALF = Bar(mass=0.1, outer=0.010, length=0.050)  # of a strut, from either flexure


def feet() -> Array:
    """The joints (6, 3) m on the base, in Σ0."""
    return np.pad(ring(BASE_RADIUS, BASE), ((0, 0), (0, 1)))


def heads() -> Array:
    """The joints (6, 3) m on the platform, in Σp."""
    return np.pad(ring(PLATFORM_RADIUS, PLATFORM), ((0, 0), (0, 1)))


def joints(length: float, lean: float) -> tuple[Joint, ...]:
    """The joints of a strut, length m between its flexures, that leans by `lean` rad from the vertical.

    The flexure on the base bends, about two axes; the lower half hangs on it, the actuator pushes the upper.
    """
    bends: dict[str, Any] = {"sigma": 0, "k": BENDING, "Fv": TURNING_DAMPING}
    stack: dict[str, Any] = {"k": STACK, "Fv": STACK_DAMPING, "IA": STACK_MASS, "drive_stiffness": LEVER}
    reach: dict[str, Any] = {"q_0": length, "q_min": length - STROKE, "q_max": length + STROKE}
    return (
        Joint(0, alpha=-np.pi / 2, q_0=lean - np.pi / 2, **bends),
        Joint(1, alpha=np.pi / 2, q_0=np.pi / 2, **bends, **bar_link(HALF, (0, -1, 0))),
        Joint(2, sigma=1, mu=1, alpha=np.pi / 2, **stack, **reach, **bar_link(HALF, (0, 0, -1))),
    )


def flexure(n: Array) -> Flexure:
    """The upper flexure of a strut along n (3,), in series with the lower one along and about the strut."""
    turning = {"bending": BENDING, "torsion": TORSION / 2, "damping": TURNING_DAMPING}
    return Flexure.about(n, **turning, axial=AXIAL / 2, shear=SHEAR, translation_damping=DAMPING)


def leg(number: int) -> Leg:
    """One of six equal legs; x of Σ0i is below its strut."""
    foot = feet()[number]
    strut = heads()[number] + (0.0, 0.0, HEIGHT) - foot
    length = float(np.linalg.norm(strut))
    turn = rotation_about_z(np.arctan2(strut[1], strut[0]))
    shell = Coupling((3,), [[SHELL]], [[SHELL_DAMPING]], [length])
    tip = Tip(3, attachment=number, flexure=flexure(strut / length))
    return Leg(turn, foot, joints(length, float(np.arccos(HEIGHT / length))), (tip,), couplings=(shell,))


def nano_hexapod(
    modes: int = 9, *, platform: FlexibleBody | None = None, damping_ratio: float = 0.01
) -> Robot:
    """A piezo hexapod for samples of some kilograms, that moves by tenths of a millimetre; six freedoms.

    modes is the number of elastic modes of the steel disc, 0 for a rigid one; a platform of your own replaces
    it, with six attachments. What lies between the motors and the platform yields: its lowest frequencies are
    those of the platform on its struts.
    """
    if platform is None:
        held = heads()[:, :2]
        platform = plate(ring(DISC_RADIUS, DISC), modes, damping_ratio, held, points=held, **PLATE)
    return Robot(tuple(map(leg, range(6))), platform, home_pose=((0.0, 0.0, HEIGHT), np.eye(3)))


ENTRY = Entry(
    "nano-hexapod",
    nano_hexapod,
    output=(),
    moves=(
        ((50e-6, -40e-6, 30e-6), (2e-4, 1e-4, -3e-4)),
        ((-40e-6, 30e-6, -50e-6), (-2e-4, 2e-4, 2e-4)),
    ),
    source="Dehaeze, stewart-simscape 2020, nano-hexapod 2021; disc, masses of motors and stroke our own",
)
