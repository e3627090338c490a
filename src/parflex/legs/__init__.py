"""Leg types. A new one is a file in this folder and its name in `ALL_LEG_TYPES`, before the last."""

from parflex.legs.base import LegGroup, LegType
from parflex.legs.carried import Carried
from parflex.legs.leg import Joint, Leg, Tip
from parflex.legs.rods import Rods
from parflex.legs.rps import RPS
from parflex.legs.ups import UPS

ALL_LEG_TYPES: tuple[LegType, ...] = (UPS(), RPS(), Rods(), Carried())

__all__ = ["ALL_LEG_TYPES", "Joint", "Leg", "LegGroup", "LegType", "Tip"]
