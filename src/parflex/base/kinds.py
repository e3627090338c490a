"""Kinds of quantities with their SI units: what numbers of robots and of files measure."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Kind:
    """A kind of quantity: its words, its SI unit, and examples of how it may be written.

    More of it than `most` is `beyond` what machines have, and then likely given in the unit `slip`, of which
    one is `factor` in SI.
    """

    words: str
    unit: str
    example: str
    most: float = math.inf
    beyond: str = ""
    slip: str = ""
    factor: float = 1.0

    @property
    def expected(self) -> str:
        """'a length in m, such as 0.3 or "300 mm"'; without a unit, 'a number, such as 0.3'."""
        unit = f" in {self.unit}" if self.unit else ""
        return f"{self.words}{unit}, such as {self.example}"

    def of(self, sigma: int) -> "Kind":
        """The kind itself, whichever type (0 revolute, 1 prismatic) the joint is of."""
        return self


@dataclass(frozen=True)
class ByType:
    """A quantity that a revolute joint has in other units than a prismatic one."""

    revolute: Kind
    prismatic: Kind

    @property
    def unit(self) -> str:
        """Both SI units."""
        return f"{self.revolute.unit} or {self.prismatic.unit}"

    def of(self, sigma: int) -> Kind:
        """The kind for a joint type, 0 revolute or 1 prismatic."""
        return self.prismatic if sigma else self.revolute


NUMBER = Kind("a number", "", "0.3")
LENGTH = Kind("a length", "m", '0.3 or "300 mm"', 50.0, "more than 50 m", "mm", 1e-3)
ANGLE = Kind("an angle", "rad", '0.5 or "30 deg"', 6.3, "more than a full turn", "deg", math.pi / 180)
MASS = Kind("a mass", "kg", '1.5 or "1500 g"', 2e4, "more than 20 tonnes", "g", 1e-3)
FIRST_MOMENT = Kind(
    "a first moment", "kg m", '0.2 or "200 kg mm"', 2e4, "more than 2 m times 10 tonnes", "kg mm", 1e-3
)
INERTIA = Kind(
    "an inertia", "kg m^2", '0.02 or "2e4 kg mm^2"', 1e5, "more than (3 m)² times 10 tonnes", "kg mm^2", 1e-6
)
FORCE = Kind("a force", "N", '20 or "0.02 kN"')
TORQUE = Kind("a torque", "N m", '2 or "2000 N mm"')
SPEED = Kind("a speed", "m/s", '0.001 or "1 mm/s"')
TURN_RATE = Kind("an angular rate", "rad/s", '0.001 or "0.1 deg/s"')
LINEAR_DAMPING = Kind("a damping", "N s/m", '50 or "0.05 N s/mm"')
ANGULAR_DAMPING = Kind("a damping", "N m s/rad", '0.5 or "0.01 N m s/deg"')
LINEAR_STIFFNESS = Kind("a stiffness", "N/m", '2e5 or "200 N/mm"')
ANGULAR_STIFFNESS = Kind("a stiffness", "N m/rad", '30 or "0.5 N m/deg"')
PRESSURE = Kind("a modulus", "Pa", '70e9 or "70 GPa"')
DENSITY = Kind("a density", "kg/m^3", '2700 or "2.7 g/cm^3"')
ACCELERATION = Kind("an acceleration", "m/s^2", '-9.81 or "-9.81 m/s^2"')
ANGULAR_ACCELERATION = Kind("an angular acceleration", "rad/s^2", '2 or "100 deg/s^2"')
TIME = Kind("a time", "s", '0.5 or "500 ms"')
FREQUENCY = Kind("a frequency", "Hz", '5 or "5 Hz"')
RATE_GAIN = Kind("a gain", "1/s", "40")
POSE_GAIN = Kind("a gain", "1/s^2", "400")

# of a joint: turning, sliding
POSITION = ByType(ANGLE, LENGTH)
RATE = ByType(TURN_RATE, SPEED)
EFFORT = ByType(TORQUE, FORCE)
JOINT_INERTIA = ByType(INERTIA, MASS)
DAMPING = ByType(ANGULAR_DAMPING, LINEAR_DAMPING)
STIFFNESS = ByType(ANGULAR_STIFFNESS, LINEAR_STIFFNESS)
