"""Units of length: those that a user names, and those that STEP files name."""

import re

from parflex.base.errors import InputError

INCH, FOOT = 0.0254, 0.3048  # m, by definition
LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "inch": INCH, "in": INCH, "ft": FOOT}

SI_LENGTH = re.compile(
    r"LENGTH_UNIT\s*\(\s*\)[^;]*?SI_UNIT\s*\(\s*(?:\.(\w+)\.|\$)\s*,\s*\.METRE\.\s*\)|"
    r"SI_UNIT\s*\(\s*(?:\.(\w+)\.|\$)\s*,\s*\.METRE\.\s*\)[^;]*?LENGTH_UNIT\s*\(\s*\)"
)
OTHER_LENGTH = re.compile(
    r"CONVERSION_BASED_UNIT\s*\(\s*'(\w+)'[^;]*?LENGTH_UNIT|"
    r"LENGTH_UNIT[^;]*?CONVERSION_BASED_UNIT\s*\(\s*'(\w+)'"
)
PREFIXES = {"": 1.0, "MILLI": 1e-3, "CENTI": 1e-2, "DECI": 0.1, "MICRO": 1e-6, "KILO": 1e3}
ENGLISH = {"INCH": INCH, "IN": INCH, "FOOT": FOOT, "FT": FOOT}


def length_unit(name: str, unit: str) -> float:
    """Metres in a unit. Raises InputError for one that is not known."""
    if unit not in LENGTHS:
        raise InputError(f"{name} is {unit!r}; choose one of {', '.join(LENGTHS)}")
    return LENGTHS[unit]


def unit_of_step(text: str) -> float | None:
    """Metres in the unit of length that a STEP file's data names."""
    other = OTHER_LENGTH.search(text)
    if other is not None:
        return ENGLISH.get((other[1] or other[2]).upper())
    found = SI_LENGTH.search(text)
    return None if found is None else PREFIXES.get((found[1] or found[2] or "").upper())
