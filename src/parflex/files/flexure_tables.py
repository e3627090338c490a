"""Flexures from the tables of tips, their directions taken from the robot at home, and their tables."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.base.spatial import vector_from_rotation
from parflex.files.flexure_schema import FlexureTable
from parflex.files.tables import rotation_of
from parflex.mechanics.chain import chain_of, frames
from parflex.mechanics.legs.base import joints_at
from parflex.robot.flexure import Flexure
from parflex.robot.leg import Joint, Leg, Tip

FARTHEST = 175.0  # degrees from rest: the energy has a pole at 180
SLIDES = np.array([0.0, 0.0, 1.0])


def flexure_of(table: FlexureTable, axis: Array | None = None) -> Flexure:
    """The flexure of a table; its bending and torsion are about an axis (3,) in the axes of the platform's
    section, axial and shear stiffness along and across it, before it is known about any."""
    n = SLIDES if axis is None else axis
    turning = {"bending": table.bending or 0.0, "torsion": table.torsion or 0.0}
    about = Flexure.about(n, **turning, axial=table.axial, shear=table.shear)
    return Flexure(
        about.stiffness if table.stiffness is None else table.stiffness,
        square(table.damping),
        table.friction,
        table.friction_speed,
        None if table.rest is None else rotation_of(table.rest),
        about.translation if table.translation is None else table.translation,
        None if table.translation_damping is None else square(table.translation_damping),
    )


def square(damping: Any) -> Array:
    """A damping that is alike in all directions, or (3, 3), as (3, 3)."""
    array = np.asarray(damping, dtype=float)
    return array if array.ndim else array * np.eye(3)


def needs_direction(table: FlexureTable) -> bool:
    """True where bending and torsion differ, or axial and shear stiffness."""
    return (table.bending or 0.0) != (table.torsion or 0.0) or table.axial != table.shear


def at_home(table: FlexureTable, leg: Leg, tip: Tip, q: Array, platform: Array) -> Tip:
    """The tip with its flexure about the direction that its strut has at home, with joints q (n,) and the
    platform turned by `platform` (3, 3).

    Raises InputError where the tip is turned there by nearly half a turn from rest.
    """
    turn = platform.T @ np.asarray(leg.rotation) @ turn_of(leg, tip.frame, q)
    axis = turn @ strut_direction(leg.joints, tip) if needs_direction(table) else None
    flexure = flexure_of(table, axis)
    if flexure.rest is not None and np.any(flexure.stiffness):
        angle = np.degrees(np.linalg.norm(vector_from_rotation(turn @ np.asarray(flexure.rest).T)))
        if angle > FARTHEST:
            raise InputError(
                f"rest is {angle:.1f} deg from how the tip is turned at home, and a flexure has no energy at "
                f"180 deg; give the rotation without load, within {FARTHEST:g} deg of that"
            )
    return replace(tip, flexure=flexure)


def turn_of(leg: Leg, frame: int, q: Array) -> Array:
    """The axes (3, 3) of an unbent link, from 1, in Σ0i at joint values q (n,); 1 of the base, frame 0."""
    chain = chain_of(leg)
    found: Array = frames(chain, joints_at(chain, q[None])).R_0j[frame - 1][0]
    return found


def strut_direction(joints: Sequence[Joint], tip: Tip) -> Array:
    """The direction (3,) of a tip's link in its frame: from the joint to the tip, or, where the tip is at the
    frame's origin, along a slide.

    Raises InputError where a joint that turns is at the tip.
    """
    offset = np.asarray(tip.offset)
    if np.any(offset):
        return offset / np.linalg.norm(offset)
    if tip.frame and joints[tip.frame - 1].sigma:
        return SLIDES
    raise InputError(
        f"stiffness differs along and across the strut, but the tip is at the origin of frame {tip.frame}, "
        f"so that its strut has no direction; give stiffness and translation as matrices"
    )


def flexure_entries(flexure: Flexure) -> dict[str, Any]:
    """The table of a flexure without what is by default."""
    plain = Flexure()
    values = {
        name: np.asarray(getattr(flexure, name)).tolist()
        for name in ("stiffness", "damping", "friction", "friction_speed")
    }
    given = {
        name: value
        for name, value in values.items()
        if repr(value) != repr(np.asarray(getattr(plain, name)).tolist())
    }
    for name in ("rest", "translation", "translation_damping"):
        if getattr(flexure, name) is not None:
            given[name] = np.asarray(getattr(flexure, name)).tolist()
    return given
