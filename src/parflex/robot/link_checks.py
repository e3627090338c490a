"""Checks of a leg's joints that concern more than one field: flexible links, and drives that give."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from parflex.base.errors import InputError
from parflex.robot.body import FlexibleBody


def check_link(joint: Any) -> None:
    """Raise InputError where a flexible link has its mass twice, or is not clamped at its frame."""
    body = joint.body
    assert body is not None
    for name in ("M", "MS", "I"):
        if np.any(value := np.asarray(getattr(joint, name))):
            raise InputError(
                f"Joint.{name} is {value.tolist()} beside body, which has {body.moments.m:.4g} kg of its "
                f"own; give the mass, MS and I of a link either by its body or as numbers"
            )
    if not body.attachments:
        raise InputError(
            "Joint.body has no attachments; name the nodes at which its tips and the next joints sit"
        )
    at_origin = body.origin_node
    if at_origin is None or not body.modes:
        return
    for shapes, moves in ((body.shapes, "move"), (body.rotation_shapes, "turn")):
        largest = 0.0 if shapes is None else float(np.max(np.abs(shapes)))
        moved = 0.0 if shapes is None else float(np.max(np.abs(shapes[:, at_origin])))
        if moved > 1e-6 * largest:
            raise InputError(
                f"Joint.body: its shapes {moves} the origin of the joint's frame, by {moved / largest:.1e} "
                f"of the largest; a link is clamped there: give shapes that vanish, with their rotations"
            )


def check_drive(joint: Any) -> None:
    """Raise InputError for a compliance of a drive where there is no motor, or no rotor that it may move."""
    if joint.drive_stiffness is None:
        if joint.drive_damping:
            raise InputError(
                f"Joint.drive_damping is {joint.drive_damping} without drive_stiffness, beside "
                f"which it acts; give both, or neither"
            )
        return
    if not joint.mu:
        raise InputError(
            f"Joint.drive_stiffness is {joint.drive_stiffness} on a joint that no motor drives; set mu = 1 "
            f"(in files actuated = true), or give a passive joint its spring as k (in files stiffness)"
        )
    if not joint.IA > 0:
        raise InputError(
            f"Joint.drive_stiffness is {joint.drive_stiffness} and IA is {joint.IA}; the motor behind "
            f"it needs IA, the rotor's inertia as seen at the joint (in files rotor_inertia): give it, or a "
            f"sprung joint of its own"
        )


def check_turns(bodies: Sequence[FlexibleBody | None], joints: Sequence[Any], tips: Sequence[Any]) -> None:
    """Raise InputError where a body without rotation shapes carries a joint, or a tip with a flexure."""
    held = [(joint.antecedent, "joint") for joint in joints]
    held += [(tip.frame, "tip with a flexure") for tip in tips if tip.flexure is not None]
    for frame, what in held:
        body = bodies[frame - 1] if frame else None
        if body is not None and body.modes and body.rotation_shapes is None:
            raise InputError(
                f"the body of joint {frame} has no rotation shapes, but carries a {what}, whose turning they "
                f"tell; give rotation_shapes to the body"
            )
