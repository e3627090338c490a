"""The legs as lines in the world."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, mv
from parflex.mechanics.axes import axis_of
from parflex.mechanics.chain import bend_of, seat_on, tip_position
from parflex.mechanics.kinematics import position_in_world
from parflex.mechanics.leg_terms import LegTerms
from parflex.mechanics.system import System, assemble
from parflex.robot.carrying import Base
from parflex.robot.leg import Leg

LINK = "link"  # the word of a point between joints, on a flexible link


class Paths(NamedTuple):
    """The legs as lines in the world, m: from the base through the joints to each tip, along flexible links
    as they are bent."""

    points: Array  # (…, lines, n, 3), shorter lines end with their last point again
    axes: Array  # (…, lines, n, 3), along which the joints there act; zero where there is none
    stations: tuple[tuple[str, ...], ...]  # what is there, a word per point of each line
    legs: tuple[int, ...]  # of each line
    attachments: tuple[int, ...]
    motors: Array  # (…, motors, 3), where the actuated joints are


class Station(NamedTuple):
    """A point of a leg in its base frame, the axis of the joint there, and in a word what it is."""

    place: Array  # (…, L, 3)
    axis: Array  # (…, L, 3), zero where there is no joint
    word: str


def leg_paths(system: System) -> Paths:
    """The legs of a robot at a state, or at a batch of them."""
    lines: list[Array] = []
    axes: list[Array] = []
    words: list[tuple[str, ...]] = []
    legs: list[int] = []
    held: list[int] = []
    motors: list[Array] = []
    base = system.mechanism.base
    for leg in system.legs:
        own = [system.mechanism.robot.legs[number] for number in leg.group.legs]
        for t in range(len(leg.group.tip_frames)):
            stations = list(stations_to(leg, t, own))
            lines.append(np.stack([in_world(base, leg, each.place) for each in stations], axis=-2))
            axes.append(np.stack([turned(base, leg, each.axis) for each in stations], axis=-2))
            words += [tuple(each.word for each in stations)] * len(leg.group.legs)
            legs += leg.group.legs
            held += list(leg.group.attachments[:, t])
        motors += [in_world(base, leg, motor_place(leg, j)) for j in leg.group.actuated]
    batch = system.x.position.shape[:-1]
    longest = max((line.shape[-2] for line in lines), default=0)
    nothing = np.zeros((*batch, 0, longest, 3))
    points = np.concatenate([nothing, *(lengthened(line, longest) for line in lines)], axis=-3)
    directions = np.concatenate([nothing, *(lengthened(axis, longest) for axis in axes)], axis=-3)
    named = tuple((*word, *("",) * (longest - len(word))) for word in words)
    places = np.concatenate([np.zeros((*batch, 0, 3)), *motors], axis=-2)
    return Paths(points, directions, named, tuple(legs), tuple(int(a) for a in held), places)


def stations_to(leg: LegTerms, t: int, own: list[Leg]) -> Iterator[Station]:
    """The points on the way from the base to tip t of legs that are alike."""
    chain, frames, none = leg.group.chain, leg.frames, np.zeros(3)
    point = leg.group.points(leg.joints.bend)[t]
    way = chain.path(point.link)
    seats = [*(chain.seats[k] for k in way[1:]), *[leg.group.tip_seats[t]][: len(way)]]  # none of a post
    yield Station(none, none, "base")
    for place, (k, seat) in enumerate(zip(way, seats, strict=True), start=1):
        yield Station(frames.p_0j[k], frames.R_0j[k][..., 2], joint_word(leg, k))
        for between in along_link(leg, k, seat, own) if chain.modes[k] else ():
            yield Station(between, none, LINK)
        if chain.modes[k] and place < len(way):  # the joint's own place may be elsewhere on its axis
            bent = seat_on(chain, k, seat, leg.joints.bend)
            assert bent is not None
            yield Station(frames.p_0j[k] + mv(frames.R_0j[k], bent.place), none, LINK)
    yield Station(tip_position(frames, point), none, "tip")


def along_link(leg: LegTerms, j: int, attachment: int, own: list[Leg]) -> list[Array]:
    """Points (…, L, 3) of a flexible link between its frame and an attachment, in the base frame."""
    bodies = [each.joints[j].body for each in own]
    axes = [axis_of(body, attachment) for body in bodies if body is not None]
    places, shapes = (np.stack(tables, axis=1) for tables in zip(*axes, strict=True))
    e = bend_of(leg.group.chain, leg.joints.bend, j)
    bent = [place + mv(Phi, e) for place, Phi in zip(places, shapes, strict=True)]
    return [leg.frames.p_0j[j] + mv(leg.frames.R_0j[j], point) for point in bent]


def deformation(system: System, paths: Paths) -> Array:
    """The displacement (…, lines, n, 3) m of the legs' points, in the world, that is due to bending.

    It is against the robot at the same pose whose platform and links are straight, each leg stretched a
    little where that cannot be closed exactly; zero where a leg would be out of its reach there.
    """
    x, mechanism = system.x, system.mechanism
    s = x.s.copy()
    for place in mechanism.layout.by_leg[1]:
        s[..., place] = 0.0
    straight = x._replace(elastic=0.0 * x.elastic, elastic_rate=0.0 * x.elastic_rate, s=s, sd=0.0 * s)
    with np.errstate(invalid="ignore", divide="ignore"):
        lines = leg_paths(assemble(mechanism, straight)).points
        held = position_in_world(mechanism.platform.body.attachment_points, x)
        moved = paths.points - stretched(lines, held[..., list(paths.attachments), :])
    return np.where(np.isfinite(moved), moved, 0.0)


def stretched(lines: Array, ends: Array) -> Array:
    """Lines (…, l, n, 3), moved in proportion to the way along them so that they end at (…, l, 3)."""
    return lines + shares(lines)[..., None] * (ends - lines[..., -1, :])[..., None, :]


def shares(lines: Array) -> Array:
    """The share of its line at which each point is, (…, l, n) from 0 to 1."""
    steps = np.linalg.norm(np.diff(lines, axis=-2, prepend=lines[..., :1, :]), axis=-1)
    way = np.cumsum(steps, axis=-1)
    return np.asarray(way / np.maximum(way[..., -1:], 1e-300))


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


def in_world(base: Base | None, leg: LegTerms, p: Array) -> Array:
    """Points (…, L, 3) of the legs' base frames in the world."""
    group = leg.group
    origin = group.origin if base is None else mv(base.rotation[..., None, :, :], group.origin)
    moved = 0.0 if base is None else base.position[..., None, :]
    return moved + origin + turned(base, leg, p)


def turned(base: Base | None, leg: LegTerms, v: Array) -> Array:
    """Vectors (…, L, 3) of the legs' base frames in the world's axes."""
    found = mv(leg.group.rotation, np.broadcast_to(v, leg.qd.shape[:-1] + (3,)))
    return found if base is None else mv(base.rotation[..., None, :, :], found)
