"""Leg types. A new one is a file in this folder and its name in `ALL_LEG_TYPES`."""

from parflex.legs.base import Joint, Leg, LegType, Tip
from parflex.legs.ups import UPS

ALL_LEG_TYPES: tuple[LegType, ...] = (UPS(),)

__all__ = ["ALL_LEG_TYPES", "Joint", "Leg", "LegType", "Tip"]
