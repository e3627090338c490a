"""Motions of the platform's points and sections at the tips, by small motions of the state.

Small motions of the platform are (δp, δθ, δv_p, δω_p, δq_e N, δq̇_e N), all in Σp here, with the attitude
turned by R → R (1 + δθ̂).
"""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, block, cross, dot, join, merged, mtv, mv, outer, skew, transpose
from parflex.mechanics.system import System, by_group


class TipMotions(NamedTuple):
    """Changes of place and velocity of k tips, and of attitude and angular velocity of the platform's
    sections there, all seen from the base and resolved in Σp: (…, k, 3, D), D = 12 + 2 N."""

    place: Array
    velocity: Array
    turn: Array
    spin: Array


def tip_motions(system: System) -> TipMotions:
    """The motions of all tips; of sections none (…, k, 0, D) where no leg has a flexure."""
    (r, v, _), Phi, w = system.points, system.shapes, skew(system.x.twist[..., None, 3:])
    one, none, unbent = np.eye(3), np.zeros((3, 3)), np.zeros(Phi.shape)
    place = block([[one, -skew(r), none, none, Phi, unbent]])
    velocity = block([[none, -skew(v), one, -skew(r), w @ Phi, Phi]])
    if system.mechanism.base is not None:
        turning = mtv(system.x.rotation, system.mechanism.base.omega)
        velocity = velocity - skew(turning)[..., None, :, :] @ place
    if not system.mechanism.flexed:
        still = place[..., :0, :]
        return TipMotions(place, velocity, still, still)
    _, spin, tilt = system.sections
    turn = block([[none, one, none, none, tilt, unbent]])
    return TipMotions(
        place, velocity, turn, block([[none, -skew(spin), none, one, spin_slope(system), tilt]])
    )


def spin_slope(system: System) -> Array:
    """∂(Θ q̇_e)/∂q_e (…, k, 3, N): with a = Φ_r q_e and σ = 1 / (1 + ¼ a·a) it is
    −½ σ (Θ q̇_e aᵀ + û) Φ_r, u = Φ_r q̇_e."""
    turns, a, share = shares(system)
    u = mv(turns, system.x.elastic_rate[..., None, :])
    own = share * (u + 0.5 * cross(a, u))
    return -0.5 * share[..., None] * ((outer(own, a) + skew(u)) @ turns)


def tilt_slope(system: System, m: Array) -> Array:
    """∂(Σ Θᵀ m)/∂q_e (…, N, N) of moments m (…, k, 3) that stay."""
    turns, a, share = shares(system)
    along = share * (m - 0.5 * cross(a, m))
    return np.sum(transpose(turns) @ (0.5 * share[..., None] * (skew(m) - outer(along, a)) @ turns), axis=-3)


def shares(system: System) -> tuple[Array, Array, Array]:
    """Φ_r (k, 3, N) at the tips, a = Φ_r q_e (…, k, 3) and 1 / (1 + ¼ a·a) (…, k, 1)."""
    turns = system.mechanism.platform.body.attachment_turns[system.mechanism.attachments]
    a = mv(turns, system.x.elastic[..., None, :])
    return turns, a, 1.0 / (1.0 + 0.25 * dot(a, a))[..., None]


def leg_by_leg(system: System, motions: TipMotions, sections: bool = True) -> list[Array]:
    """The motions that the equations of the legs see, group by group: (…, L, d, D) of their tips, and after
    these of the sections of tips with flexures; legs that carry their joints see only
    soft tips, d may be 0."""
    mechanism, found = system.mechanism, []
    seen = motions if sections and motions.turn.size else motions[:2]
    parts = [by_group(mechanism, merged(part)) for part in seen]
    D = motions.place.shape[-1]
    for group, *mine in zip(mechanism.groups, *parts, strict=True):
        tips = mine[:2] if group.reads_tips else []
        rows = tips + ([] if group.flexures is None else mine[2:])
        tall = [part.reshape((*part.shape[:-2], 3 * part.shape[-2], D)) for part in rows]
        found.append(transpose(join([np.zeros((1, D, 0)), *(transpose(part) for part in tall)])))
    return found
