"""Numbers with units: SI where there is no unit, converted and checked where there is one."""

import math
import re
from dataclasses import dataclass
from functools import cache
from typing import Any

from parflex.base.errors import InputError

WITH_UNIT = re.compile(r"\s*([-+]?(?:\d[\d_]*\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*((?:1\s*/|[^\d\s]).*?)\s*")

# pint takes all of these, and percent, for plain numbers; an angle must be named
ANGLES = {"radian", "milliradian", "degree", "arcminute", "arcsecond", "turn"}


@dataclass(frozen=True)
class Kind:
    """What a number measures: in words, its SI unit, and how it may be written."""

    words: str
    unit: str
    example: str

    @property
    def expected(self) -> str:
        """'a length in m, such as 0.3 or "300 mm"'; without a unit, 'a number, such as 0.3'."""
        unit = f" in {self.unit}" if self.unit else ""
        return f"{self.words}{unit}, such as {self.example}"


NUMBER = Kind("a number", "", "0.3")
LENGTH = Kind("a length", "m", '0.3 or "300 mm"')
ANGLE = Kind("an angle", "rad", '0.5 or "30 deg"')
MASS = Kind("a mass", "kg", '1.5 or "1500 g"')
FIRST_MOMENT = Kind("a first moment", "kg m", '0.2 or "200 kg mm"')
INERTIA = Kind("an inertia", "kg m^2", '0.02 or "2e4 kg mm^2"')
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
TIME = Kind("a time", "s", '0.5 or "500 ms"')
RATE_GAIN = Kind("a gain", "1/s", "40")
POSE_GAIN = Kind("a gain", "1/s^2", "400")


def convert(value: Any, kind: Kind) -> float:
    """The SI value of a number, or of a text with a number and a unit.

    Raises InputError, its sentence without a subject, for another kind of value, a unit that does
    not measure what is wanted, and numbers that are not finite.
    """
    if isinstance(value, str) and kind.unit:
        return with_unit(value, kind)
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise InputError(f"is {shown(value)}; expected {kind.expected}")
    if not math.isfinite(value):
        raise InputError(f"is {value}; expected {kind.words} that is finite")
    return float(value)


def with_unit(text: str, kind: Kind) -> float:
    """The SI value of '300 mm'."""
    parts = WITH_UNIT.fullmatch(text)
    if parts is None:
        raise InputError(f'is "{text}"; expected {kind.expected}')
    number, unit = parts.groups()
    return convert(float(number) * factor(text, unit, kind), kind)


def factor(text: str, unit: str, kind: Kind) -> float:
    """How many SI units of the kind one `unit` is."""
    units = unit_registry()
    try:
        given = units.Quantity(1.0, units.parse_units(unit))
    except Exception:  # the parser raises many kinds
        raise InputError(f'is "{text}", but "{unit}" is no unit; expected {kind.expected}') from None
    names = {name for name, _ in given.unit_items()}
    if "hertz" in names:
        raise InputError(f'is "{text}", which leaves open what is counted; write rad/s or turn/s')
    same = given.dimensionality == units.parse_units(kind.unit).dimensionality
    if not same or (kind is ANGLE and not names <= ANGLES):
        raise InputError(f'is "{text}", which is not {kind.words}; expected {kind.expected}')
    return float(given.to(kind.unit).magnitude)


@cache
def unit_registry() -> Any:
    """pint's units, loaded when the first unit is read."""
    import pint

    return pint.UnitRegistry()


def shown(value: Any) -> str:
    """A value as its file has it, shortened."""
    if isinstance(value, bool):
        return "true" if value else "false"
    text = f'"{value}"' if isinstance(value, str) else repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
