"""An aluminium disc on six heavy struts, whose frame no ideal controller can hold: meshed once."""

from functools import cache

import numpy as np

import parflex as pf
from parflex.robots import hexapod

RADIUS, THICKNESS = 0.17, 0.02  # m
SIZES = {"base_radius": 0.25, "platform_radius": 0.15, "height": 0.3}
SPREADS = {"base_spread": np.radians(20), "platform_spread": np.radians(20)}
IN_PLANE = 0.5  # the share of a shape's motion along the plane, from which it counts as one in the plane


def joints() -> np.ndarray:
    """The joints (6, 3) m on the bottom of the disc, in pairs at 60, 180 and 300 degrees."""
    angles = np.radians([50, 70, 170, 190, 290, 310])
    return np.stack([0.15 * np.cos(angles), 0.15 * np.sin(angles), np.full(6, -THICKNESS / 2)], axis=-1)


@cache
def disc(damping_ratio: float = 0.01) -> pf.FlexibleBody:
    """The disc with the basis that is right for its joints to 1 %."""
    around = 2 * np.pi * np.arange(48) / 48
    outline = RADIUS * np.stack([np.cos(around), np.sin(around)], axis=-1)
    body = pf.fe.solid_body(pf.fe.outline_mesh(outline, THICKNESS, size=0.022), ALUMINIUM)
    modes = pf.fe.modes(body, joints(), radius=0.016)
    return pf.FlexibleBody.from_modes(modes, origin=(0, 0, 0), damping_ratio=damping_ratio)


ALUMINIUM = pf.fe.Material(7e10, 0.33, 2700.0)


def flat_shapes(body: pf.FlexibleBody) -> list[int]:
    """The modes that do not move mainly along the plane."""
    along = np.sum(body.shapes[..., :2] ** 2, axis=(1, 2)) / np.sum(body.shapes**2, axis=(1, 2))
    return np.flatnonzero(along < IN_PLANE).tolist()


def on_struts(body: pf.FlexibleBody, mass: float = 2.0) -> pf.Robot:
    """The body on six struts of a mass (kg), three fifths of it cylinder."""
    bar = {"outer": 0.03, "length": 0.2}
    strut = pf.Strut(pf.Bar(**bar, mass=0.6 * mass), pf.Bar(**bar, mass=0.4 * mass))
    return hexapod(**SIZES, **SPREADS, strut=strut, platform=body, platform_offset=-THICKNESS / 2)
