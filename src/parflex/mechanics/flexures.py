"""Flexures at the tips: moments between the sections of legs and platform that a spherical joint couples.

With Q = R_secᵀ R_leg R_restᵀ the rotation from rest, θ = 2 tan(φ/2) n = 2 axial(Q) / (1 + tr Q) is rational,
the energy is ½ θᵀ K θ, and the moment on the platform in the axes of its section is
m = Gᵀ K θ + D ω + μ ω/√(ω² + v²) with G = 1 − ½ θ̂ + ¼ θ θᵀ and ω the angular velocity of the leg's section
relative to the platform's. A soft tip, which may leave the platform's point by g (in the section's axes),
draws both together with K_t g + D_t ġ.
"""

import math
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, cross, dot, mtv, mv, outer, skew, trace, transpose
from parflex.base.spatial import axial, cayley
from parflex.robot.flexure import Flexure
from parflex.robot.leg import Leg

FURTHEST = 2.0 * (1.0 + math.cos(math.radians(175.0)))


class Flexures(NamedTuple):
    """The tables of the flexures at the t tips of L legs; zero where a tip has none."""

    stiffness: Array  # (L, t, 3, 3)
    damping: Array  # (L, t, 3, 3)
    friction: Array  # (L, t)
    friction_speed: Array  # (L, t)
    rest: Array  # (L, t, 3, 3)
    given: Array  # (L, t), where the rest is given; elsewhere it is that at home
    translation: Array  # (L, t, 3, 3); (L, 0, 3, 3) where no tip is soft
    translation_damping: Array


class Sections(NamedTuple):
    """The sections of the platform at its tips: their axes C (…, k, 3, 3) in Σp, and their angular velocity
    (…, k, 3) and its map Θ (…, k, 3, N) from the modes, in Σp."""

    turn: Array
    spin: Array
    tilt: Array


def flexures_of(leg: Leg) -> Flexures | None:
    """The tables of one leg; None where it has no flexures."""
    if all(tip.flexure is None for tip in leg.tips):
        return None
    every = [Flexure() if tip.flexure is None else tip.flexure for tip in leg.tips]
    rests = [np.eye(3) if flexure.rest is None else flexure.rest for flexure in every]
    soft = every if any(flexure.soft for flexure in every) else []
    springs = [flexure.translation if flexure.soft else np.zeros((3, 3)) for flexure in soft]
    dampers = [flexure.translation_damping if flexure.soft else np.zeros((3, 3)) for flexure in soft]
    return Flexures(
        stiffness=np.array([[flexure.stiffness for flexure in every]]),
        damping=np.array([[flexure.damping for flexure in every]]),
        friction=np.array([[flexure.friction for flexure in every]]),
        friction_speed=np.array([[flexure.friction_speed for flexure in every]]),
        rest=np.array([rests]),
        given=np.array([[flexure.rest is not None for flexure in every]]),
        translation=np.array(springs).reshape((1, -1, 3, 3)),
        translation_damping=np.array(dampers).reshape((1, -1, 3, 3)),
    )


def sections(turns: Array, omega: Array, q_e: Array, qd_e: Array) -> Sections:
    """The platform's sections for its rotation shapes Φ_r (k, 3, N) there, ω (…, 3) and q_e, q̇_e (…, N)."""
    a = mv(turns, q_e[..., None, :])
    turn, tilt = cayley(a, turns)
    return Sections(turn, omega[..., None, :] + mv(tilt, qd_e[..., None, :]), tilt)


def unturned(tips: int, modes: int) -> Sections:
    """The sections of robots without flexures, which nobody reads."""
    one = np.broadcast_to(np.eye(3), (tips, 3, 3))
    return Sections(one, np.zeros((tips, 3)), np.zeros((tips, 3, modes)))


def from_rest(flexures: Flexures, turn: Array, leg: Array) -> Array:
    """Q (…, L, t, 3, 3) of the leg's sections seen from the platform's, both in the same axes."""
    return transpose(turn) @ leg @ transpose(flexures.rest)


def bent_angle(Q: Array) -> Array:
    """θ (…, L, t, 3) of rotations from rest (…, L, t, 3, 3)."""
    return 2.0 / (1.0 + trace(Q))[..., None] * axial(Q)


def openness(flexures: Flexures, Q: Array) -> Array:
    """2 (1 + cos φ) (…, L, t) less its value at 175°: not positive where a flexure is nearly turned about,
    beyond which its energy has no bound; of tips without one it is 1."""
    soft = np.any((flexures.stiffness != 0).astype(bool), axis=(-2, -1))
    return np.where(soft, 1.0 + trace(Q) - FURTHEST, 1.0)


def moments(flexures: Flexures, theta: Array, spin: Array) -> Array:
    """m (…, L, t, 3) on the platform, in the axes of its sections, for θ and the relative ω (…, L, t, 3)."""
    pull = mv(flexures.stiffness, theta)
    # Gᵀ = 1 + ½ θ̂ + ¼ θ θᵀ
    turned = pull + 0.5 * mv(skew(theta), pull) + 0.25 * mv(outer(theta, theta), pull)
    return turned + resistance(flexures, spin)


def resistance(flexures: Flexures, spin: Array) -> Array:
    """The part of m that damping and friction make."""
    slow = flexures.friction_speed * flexures.friction_speed
    share = flexures.friction / np.sqrt(dot(spin, spin) + slow)
    return mv(flexures.damping, spin) + share[..., None] * spin


def stretches(turn: Array, spin: Array, gap: Array, gap_rate: Array) -> tuple[Array, Array]:
    """g and ġ of tips in the axes `turn` of the platform's sections, which turn with the angular velocity
    `spin`; the gap and the velocity of the tip against the platform's point are in the axes in which `turn`
    is given."""
    return mtv(turn, gap), mtv(turn, gap_rate - cross(spin, gap))


def pulls(flexures: Flexures, stretch: Array, stretch_rate: Array) -> Array:
    """K_t g + D_t ġ (…, L, t, 3) on the platform, in the axes of its sections; of soft tips."""
    return mv(flexures.translation, stretch) + mv(flexures.translation_damping, stretch_rate)


def stretch_energy(flexures: Flexures, stretch: Array) -> Array:
    """½ gᵀ K_t g (…, L), of all tips of each leg."""
    return 0.5 * np.sum(dot(stretch, mv(flexures.translation, stretch)), axis=-1)


def energy(flexures: Flexures, theta: Array) -> Array:
    """½ θᵀ K θ (…, L), of all tips of each leg."""
    return 0.5 * np.sum(dot(theta, mv(flexures.stiffness, theta)), axis=-1)


def relative_spin(turn: Array, leg: Array, platform: Array) -> Array:
    """ω of the leg's sections relative to the platform's, in the axes `turn` of these; both in the axes in
    which `turn` is given."""
    return mtv(turn, leg - platform)
