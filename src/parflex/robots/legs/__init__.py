"""Kinds of legs by physical fields. A new one is a file in this folder and its name in `ALL_LEG_KINDS`."""

from parflex.robots.legs.base import LegKind
from parflex.robots.legs.delta_arm import DeltaArm
from parflex.robots.legs.prs import PRS
from parflex.robots.legs.pus import PUS
from parflex.robots.legs.rps import RPS
from parflex.robots.legs.rus import RUS
from parflex.robots.legs.ups import UPS

ALL_LEG_KINDS: tuple[type[LegKind], ...] = (UPS, RPS, RUS, PUS, PRS, DeltaArm)

__all__ = ["ALL_LEG_KINDS", "PRS", "PUS", "RPS", "RUS", "UPS", "DeltaArm", "LegKind"]
