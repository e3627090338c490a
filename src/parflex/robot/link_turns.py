"""Turns of the links of a leg, from its table alone."""

from collections.abc import Sequence

import numpy as np

from parflex.base.array import Array
from parflex.base.spatial import rotation_about_z
from parflex.robot.leg import Joint


def link_turn(joints: Sequence[Joint], frame: int, q: Array) -> Array:
    """The rotation (3, 3) of an unbent link's frame in Σ0i at joint values q (n,); 1 of the base, frame 0."""
    if frame == 0:
        return np.eye(3)
    joint = joints[frame - 1]
    turned = joint.theta + (0.0 if joint.sigma else q[frame - 1])
    row = (
        rotation_about_z(np.asarray(joint.gamma))
        @ about_x(joint.alpha)
        @ rotation_about_z(np.asarray(turned))
    )
    return link_turn(joints, joint.antecedent, q) @ row


def about_x(angle: float) -> Array:
    """Rot(x, α)."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
