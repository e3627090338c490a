"""A small solid plate that several test files share."""

from functools import cache

import numpy as np

import parflex as pf
from blocks import box

SIZE = (0.6, 0.4, 0.02)
MATERIAL = pf.fe.Material(7e10, 0.3, 2700.0)
JOINTS = np.array([(x, y, 0.0) for x, y in ((-0.3, -0.2), (0.3, -0.2), (0.3, 0.2), (-0.3, 0.2))])
TOOL = (0.0, 0.0, 0.01)
RADIUS = 0.035


@cache
def plate() -> pf.fe.FreeBody:
    """An aluminium rectangle, one layer of elements, nodes on its middle plane."""
    return pf.fe.solid_body(box(SIZE, (12, 8, 1)), MATERIAL)


@cache
def modes() -> pf.Modes:
    """Nine free–free modes and attachment modes at the corners and the tool."""
    return pf.fe.FreeFreeWithAttachment(9, JOINTS, TOOL, RADIUS).modes(plate())
