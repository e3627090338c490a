"""The legs as lines in the world."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from parflex.base.array import Array, mv
from parflex.mechanics.chain import tip_position
from parflex.mechanics.leg_terms import LegTerms
from parflex.mechanics.system import System

if TYPE_CHECKING:
    pass


class Paths(NamedTuple):
    """The legs as lines in the world, m: from the base through the joints to each tip."""

    points: Array  # (…, lines, n, 3), shorter lines end with their last point again
    axes: Array  # (…, lines, n, 3), along which the joints there act; zero where there is none
    stations: tuple[tuple[str, ...], ...]  # what is there, a word per point of each line
    legs: tuple[int, ...]  # of each line
    attachments: tuple[int, ...]
    motors: Array  # (…, motors, 3), where the actuated joints are


def leg_paths(system: System) -> Paths:
    """The legs of a robot at a state, or at a batch of them."""
    lines: list[Array] = []
    axes: list[Array] = []
    words: list[tuple[str, ...]] = []
    legs: list[int] = []
    held: list[int] = []
    motors: list[Array] = []
    for leg in system.legs:
        chain = leg.group.chain
        for t, point in enumerate(leg.group.points(leg.joints.bend)):
            way, none = chain.path(point.link), np.zeros(3)
            tip = tip_position(leg.frames, point)
            stations = [none, *(leg.frames.p_0j[k] for k in way), tip]
            along = [none, *(leg.frames.R_0j[k][..., 2] for k in way), none]
            lines.append(np.stack([in_world(leg, p) for p in stations], axis=-2))
            axes.append(np.stack([turned(leg, a) for a in along], axis=-2))
            words += [("base", *(joint_word(leg, k) for k in way), "tip")] * len(leg.group.legs)
            legs += leg.group.legs
            held += list(leg.group.attachments[:, t])
        motors += [in_world(leg, motor_place(leg, j)) for j in leg.group.actuated]
    batch = system.x.position.shape[:-1]
    longest = max((line.shape[-2] for line in lines), default=0)
    nothing = np.zeros((*batch, 0, longest, 3))
    points = np.concatenate([nothing, *(lengthened(line, longest) for line in lines)], axis=-3)
    directions = np.concatenate([nothing, *(lengthened(axis, longest) for axis in axes)], axis=-3)
    named = tuple((*word, *("",) * (longest - len(word))) for word in words)
    places = np.concatenate([np.zeros((*batch, 0, 3)), *motors], axis=-2)
    return Paths(points, directions, named, tuple(legs), tuple(int(a) for a in held), places)


def lengthened(line: Array, count: int) -> Array:
    """Points (…, n, 3) as (…, count, 3), the last one again and again."""
    return line[..., np.minimum(np.arange(count), line.shape[-2] - 1), :]


def joint_word(leg: LegTerms, j: int) -> str:
    """The kind of a joint, with a star where there is a motor: R, P, R* or P*."""
    return "RP"[leg.group.chain.sigma[j]] + "*" * (j in leg.group.actuated)


def motor_place(leg: LegTerms, j: int) -> Array:
    """A turning joint's origin; for a sliding one the middle of its slide, in the base frame."""
    start, own = (leg.frames.p_0j[k] for k in (leg.group.chain.antecedent[j], j))
    return 0.5 * (start + own) if leg.group.chain.sigma[j] else own


def in_world(leg: LegTerms, p: Array) -> Array:
    """Points (…, L, 3) of the legs' base frames in the world."""
    return leg.group.origin + turned(leg, p)


def turned(leg: LegTerms, v: Array) -> Array:
    """Vectors (…, L, 3) of the legs' base frames in the world's axes."""
    return mv(leg.group.rotation, np.broadcast_to(v, leg.qd.shape[:-1] + (3,)))
