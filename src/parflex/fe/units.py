"""Units of length of files that name none."""

from parflex.errors import InputError

LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "inch": 0.0254, "in": 0.0254, "ft": 0.3048}


def length_unit(name: str, unit: str) -> float:
    """Metres in a unit. Raises InputError for one that is not known."""
    if unit not in LENGTHS:
        raise InputError(f"{name} is {unit!r}; choose one of {', '.join(LENGTHS)}")
    return LENGTHS[unit]
