"""States in the world and as they are seen from a base, which carries the first part of flat ones."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, cross, join, mtv, mv, split
from parflex.base.spatial import quaternion_from_rotation, rotation_from_quaternion
from parflex.robot.layout import Layout
from parflex.robot.state import State

AT = Layout(0).at  # of the parts of a flat state that the base carries
TURN = AT.quaternion  # of a flat base too


class Base(NamedTuple):
    """Pose, twist and acceleration of Σ0, all in world axes; floats, a batch, or symbols."""

    position: Array  # (…, 3)
    rotation: Array  # (…, 3, 3)
    velocity: Array  # (…, 3), of Σ0's origin
    omega: Array  # (…, 3)
    acceleration: Array  # (…, 3)
    omegad: Array  # (…, 3)


def base_of(flat: Array) -> Base:
    """The base of flat vectors (…, 19), p 3, quaternion w x y z 4 of any length, v 3, ω 3, a 3, ω̇ 3."""
    position, quaternion, *rates = split(flat, [(3,), (4,), (3,), (3,), (3,), (3,)])
    return Base(position, rotation_from_quaternion(quaternion), *rates)


def seen(base: Array, x: Array) -> Array:
    """Flat states (…, n) as seen from bases (…, 19)."""
    b = base_of(base)
    away, backwards = x[..., AT.position] - b.position, base[..., TURN] * [1.0, -1.0, -1.0, -1.0]
    quaternion = product(backwards, x[..., AT.quaternion])
    twist = x[..., AT.twist] - carrying(b, away, rotation_from_quaternion(x[..., AT.quaternion]))
    return join([mtv(b.rotation, away), quaternion, twist, x[..., AT.twist.stop :]])


def carried(base: Array, x: Array) -> Array:
    """Flat states (…, n) in the world, of those seen from bases (…, 19)."""
    b = base_of(base)
    away, quaternion = mv(b.rotation, x[..., AT.position]), product(base[..., TURN], x[..., AT.quaternion])
    twist = x[..., AT.twist] + carrying(b, away, rotation_from_quaternion(quaternion))
    return join([b.position + away, quaternion, twist, x[..., AT.twist.stop :]])


def place_of(state: State) -> Array:
    """The place and the twist of a state as the first part of a flat one (13,)."""
    return join([state.position, quaternion_from_rotation(state.rotation), state.twist])


def with_place(state: State, x: Array) -> State:
    """A state in another place, with another twist, by the first part of a flat one (13,)."""
    rotation = rotation_from_quaternion(x[AT.quaternion])
    return replace(state, position=x[AT.position], rotation=rotation, twist=x[AT.twist])


def carrying(b: Base, away: Array, rotation: Array) -> Array:
    """The twist (…, 6), in the axes of a frame, with which it goes at rest to the base; away from the base's
    origin in world axes."""
    return join([mtv(rotation, b.velocity + cross(b.omega, away)), mtv(rotation, b.omega)])


def product(a: Array, b: Array) -> Array:
    """The quaternion a ⊗ b (…, 4)."""
    v, w = a[..., 1:], b[..., 1:]
    real = a[..., :1] * b[..., :1] - np.sum(v * w, axis=-1, keepdims=True)
    return join([real, a[..., :1] * w + b[..., :1] * v + cross(v, w)])
