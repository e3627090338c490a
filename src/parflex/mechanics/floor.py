"""The floor under the legs: where Σ0 is in the world, how it moves, and what the legs see of the platform.

The platform stays in absolute coordinates; only the legs see the base. On a base that accelerates gravity is
g − a; a frame that turns adds its angular velocity to the start of the legs' recursion.
"""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, cross, mtv, mv, skew, split, transpose
from parflex.mechanics.legs.base import LegGroup
from parflex.mechanics.recursion import Motion, point_acceleration
from parflex.robot.carrying import Base

BASE_CHANGES = 18  # small changes of a base, as of `shifted`


class Seen(NamedTuple):
    """The platform as it is seen from the base."""

    rotation: Array  # (…, 3, 3), axes of Σp in Σ0
    places: Array  # (…, k, 3), of its points in Σ0
    velocities: Array  # (…, k, 3), relative to the base, in Σp
    spins: Array  # (…, k, 3), of its sections, relative to the base, in Σp


class Ground(NamedTuple):
    """The floor under L legs: the motion of their frames Σ0i, which accelerate with −g where nothing moves,
    and gravity (…, L, 3); all in Σ0i."""

    motion: Motion
    gravity: Array


def seen_from(base: Base | None, platform: Seen) -> Seen:
    """The platform as a base sees it, of what the world sees; the same for none."""
    if base is None:
        return platform
    R_pw = transpose(platform.rotation)[..., None, :, :]
    omega, away = base.omega[..., None, :], platform.places - base.position[..., None, :]
    carried = base.velocity[..., None, :] + cross(omega, away)
    return Seen(
        transpose(base.rotation) @ platform.rotation,
        mtv(base.rotation[..., None, :, :], away),
        platform.velocities - mv(R_pw, carried),
        platform.spins - mv(R_pw, omega),
    )


def ground(base: Base | None, gravity: Array) -> list[Array]:
    """Gravity (…, 3) in Σ0; of a base that moves also ω_b, ω̇_b and the acceleration of its origin less g."""
    if base is None:
        return [gravity]
    world = (gravity, base.omega, base.omegad, base.acceleration - gravity)
    return [mtv(base.rotation, vector) for vector in world]


def under_legs(group: LegGroup, gravity: Array, *moving: Array) -> Ground:
    """The floor under the legs of a group, of the vectors of `ground`."""
    down = mtv(group.rotation, gravity[..., None, :])
    if not moving:
        return Ground(Motion(np.zeros(3), np.zeros(3), -down), down)
    omega, omegad, vd = (vector[..., None, :] for vector in moving)
    vd = vd + point_acceleration(omega, omegad, group.origin)
    return Ground(Motion(*(mtv(group.rotation, vector) for vector in (omega, omegad, vd))), down)


def twist_of_legs(base: Base, group: LegGroup) -> tuple[Array, Array]:
    """Velocity of the origins and angular velocity (…, L, 3) of the frames Σ0i, in their own axes."""
    v, omega = (mtv(base.rotation, part)[..., None, :] for part in (base.velocity, base.omega))
    return mtv(group.rotation, v + cross(omega, group.origin)), mtv(group.rotation, omega)


def shifted(base: Base, seeds: Array) -> Base:
    """A base a little beside another, by (…, 18): δp_b, δθ_b with R_b → (1 + δθ̂_b) R_b, δv_b, δω_b,
    δa_b, δω̇_b, in the world."""
    p, theta, *rates = split(seeds, [(3,)] * 6)
    turned = base.rotation + skew(theta) @ base.rotation
    found = (part + change for part, change in zip(base[2:], rates, strict=True))
    return Base(base.position + p, turned, *found)
