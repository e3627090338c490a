"""Leg types. A new one is a file in this folder and its name in `ALL_LEG_TYPES`, before the last."""

from parflex.mechanics.legs.base import LegGroup, LegType
from parflex.mechanics.legs.carried import Carried
from parflex.mechanics.legs.rods import Rods
from parflex.mechanics.legs.rps import RPS
from parflex.mechanics.legs.ups import UPS
from parflex.robot.leg import Joint, Leg, Tip

ALL_LEG_TYPES: tuple[LegType, ...] = (UPS(), RPS(), Rods(), Carried())

__all__ = ["ALL_LEG_TYPES", "Joint", "Leg", "LegGroup", "LegType", "Tip"]
