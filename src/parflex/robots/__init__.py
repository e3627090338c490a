"""Robots with a source. A new one is a file in this folder and its entry in `ALL_ROBOTS`."""

from parflex.robots.delta import ENTRY as DELTA
from parflex.robots.delta import delta
from parflex.robots.entry import Entry
from parflex.robots.gough_stewart import ENTRY as GOUGH_STEWART
from parflex.robots.gough_stewart import gough_stewart
from parflex.robots.hexapod import hexapod
from parflex.robots.nano_hexapod import ENTRY as NANO_HEXAPOD
from parflex.robots.nano_hexapod import nano_hexapod
from parflex.robots.octapod import ENTRY as OCTAPOD
from parflex.robots.octapod import octapod
from parflex.robots.prs3 import ENTRY as PRS3
from parflex.robots.prs3 import prs3
from parflex.robots.pus6 import ENTRY as PUS6
from parflex.robots.pus6 import pus6
from parflex.robots.rps3 import ENTRY as RPS3
from parflex.robots.rps3 import rps3
from parflex.robots.rus6 import ENTRY as RUS6
from parflex.robots.rus6 import rus6

ALL_ROBOTS: tuple[Entry, ...] = (GOUGH_STEWART, RUS6, PUS6, RPS3, PRS3, DELTA, OCTAPOD, NANO_HEXAPOD)

__all__ = [
    "ALL_ROBOTS",
    "Entry",
    "delta",
    "gough_stewart",
    "hexapod",
    "nano_hexapod",
    "octapod",
    "prs3",
    "pus6",
    "rps3",
    "rus6",
]
