"""Numbers with units: SI where there is no unit, converted and checked where there is one."""

import math
import re
from functools import cache
from typing import Any

from parflex.base.errors import InputError
from parflex.base.kinds import ANGLE, FREQUENCY, Kind

WITH_UNIT = re.compile(r"\s*([-+]?(?:\d[\d_]*\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*((?:1\s*/|[^\d\s]).*?)\s*")

LONGEST = 100  # characters of a number with its unit
# powers of names alone, by whole numbers alone: others can be computed for ever
POWER = re.compile(r"(\w?)\s*(?:\*\*|\^)\s*([-+]?\d{1,2}(?![\w.]|\s*(?:\*\*|\^)))?")

# pint takes all of these, and percent, for plain numbers; an angle must be named
ANGLES = {"radian", "milliradian", "microradian", "degree", "arcminute", "arcsecond", "turn"}
CYCLES = {"hertz", "millihertz", "kilohertz"}  # and these for 1/s


def convert(value: Any, kind: Kind) -> float:
    """The SI value of a number, or of a text with a number and a unit.

    Raises InputError, its sentence without a subject, for another kind of value, a unit that does
    not measure what is wanted, and numbers that are not finite.

    >>> convert("180 deg", ANGLE), convert(0.5, ANGLE)
    (3.141592653589793, 0.5)
    >>> convert("180 mm", ANGLE)
    Traceback (most recent call last):
    parflex.base.errors.InputError: is "180 mm", which is not an angle; expected an angle in rad, ...
    """
    if isinstance(value, str) and kind.unit:
        return with_unit(value, kind)
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise InputError(f"is {shown(value)}; expected {kind.expected}")
    try:
        number = float(value)
    except OverflowError:
        raise InputError(f"is {shown(value)}, too large a number; expected {kind.expected}") from None
    if not math.isfinite(number):
        raise InputError(f"is {number}; expected {kind.words} that is finite")
    return number


def with_unit(text: str, kind: Kind) -> float:
    """The SI value of '300 mm'."""
    parts = WITH_UNIT.fullmatch(text) if len(text) <= LONGEST else None
    if parts is None:
        raise InputError(f"is {shown(text)}; expected {kind.expected}")
    number, unit = parts.groups()
    return convert(float(number) * factor(text, unit, kind), kind)


def factor(text: str, unit: str, kind: Kind) -> float:
    """The number of SI units of the kind that one `unit` is."""
    units = unit_registry()
    if not all(base.isalpha() and power for base, power in POWER.findall(unit)):
        raise InputError(f'is "{text}"; exponents of units are whole numbers, like m^2 or s**-2')
    try:
        given = units.Quantity(1.0, units.parse_units(unit))
    except Exception:  # the parser raises many kinds
        raise InputError(f'is "{text}", but "{unit}" is no unit; expected {kind.expected}') from None
    names = {name for name, _ in given.unit_items()}
    if names & CYCLES and kind is not FREQUENCY:
        raise InputError(f'is "{text}", which leaves open what is counted; write rad/s or turn/s')
    same = given.dimensionality == units.parse_units(kind.unit).dimensionality
    named = {ANGLE: ANGLES, FREQUENCY: CYCLES}.get(kind, names)
    if not same or not names <= named:
        raise InputError(f'is "{text}", which is not {kind.words}; expected {kind.expected}')
    try:
        return float(given.to(kind.unit).magnitude)
    except OverflowError:
        return math.inf


@cache
def unit_registry() -> Any:
    """pint's units, loaded when the first unit is read."""
    import pint

    return pint.UnitRegistry()


def shown(value: Any) -> str:
    """A value as its file has it, shortened."""
    if isinstance(value, bool):
        return "true" if value else "false"
    try:
        text = f'"{value}"' if isinstance(value, str) else repr(value)
    except (ValueError, RecursionError):  # a whole number of thousands of digits
        return "a value too long to be shown"
    return text if len(text) <= 60 else text[:57] + "..."
