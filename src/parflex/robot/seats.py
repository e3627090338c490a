"""Seats: the attachments of flexible links at which the next joints and the tips of a leg sit."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.robot.body import FlexibleBody
from parflex.robot.words import listed

NEAR = 1e-6  # of the body's reach: how far a joint or a tip may be from its attachment

Place = tuple[Array, Array]  # a point of a joint's axis and its direction, in the frame of the antecedent


class Seats(NamedTuple):
    """The attachment, from 0, of the link on which each joint and each tip is; −1 where that is rigid."""

    joints: tuple[int, ...]
    tips: tuple[int, ...]


def seats(
    bodies: Sequence[FlexibleBody | None],
    antecedents: Sequence[int],
    places: Sequence[Place],
    tips: Sequence[tuple[int, Array]],
) -> Seats:
    """The seats of a leg's joints and of its tips, each a link and an offset; links from 0, −1 the base.

    A joint sits where its axis passes through an attachment. Raises InputError where there is none.
    """
    of_joints = []
    for j, (a, (point, axis)) in enumerate(zip(antecedents, places, strict=True), start=1):
        body = bodies[a] if a >= 0 else None
        of_joints.append(-1 if body is None else seat(body, point, axis, f"joint {j} on link {a + 1}"))
    of_tips = []
    for t, (link, offset) in enumerate(tips):
        body = bodies[link] if link >= 0 else None
        named = f"tips[{t}] on link {link + 1}"
        of_tips.append(-1 if body is None else seat(body, offset, np.zeros(3), named))
    return Seats(tuple(of_joints), tuple(of_tips))


def seat(body: FlexibleBody, point: Array, axis: Array, what: str) -> int:
    """The attachment on a line through a point, or at the point where the axis is zero: the nearest to it."""
    away = body.attachment_points - point
    across = away - (away @ axis)[:, None] * axis
    off, reach = np.linalg.norm(across, axis=1), float(np.max(np.linalg.norm(body.nodes, axis=1)))
    far = np.where(off <= NEAR * reach, np.linalg.norm(away, axis=1), np.inf)
    if np.any(np.isfinite(far)):
        return int(np.argmin(far))
    near = int(np.argmin(off))
    where = "its axis passes" if np.any(axis) else "it is"
    raise InputError(
        f"{what}, which is flexible, is at none of its attachments: {where} {off[near]:.4g} m from the "
        f"nearest, number {near} at {listed(body.attachment_points[near])} m; place it there, or give "
        f"the body an attachment at {listed(point)} m"
    )
