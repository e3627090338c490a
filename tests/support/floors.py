"""Motions of a base that tests draw, and small changes of them."""

import numpy as np
from scipy.spatial.transform import Rotation

import parflex as pf


def moving_base(seed, scale=1.0):
    """A base displaced and turned, of six rates and six accelerations."""
    rng = np.random.default_rng(100 + seed)
    R = Rotation.from_rotvec(rng.normal(size=3)).as_matrix()
    return pf.BaseMotion(rng.normal(size=3), R, scale * rng.normal(size=6), 5 * scale * rng.normal(size=6))


def shifted(base, change):
    """The base a little beside, by one of the 18 small changes."""
    turned = Rotation.from_rotvec(change[3:6]).as_matrix() @ base.rotation
    twist, acceleration = base.twist + change[6:12], base.acceleration + change[12:]
    return pf.BaseMotion(base.position + change[:3], turned, twist, acceleration)
