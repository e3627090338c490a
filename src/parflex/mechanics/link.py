"""Flexible links: bodies that are clamped at the frame of their joint, and the seats on them.

A joint or a tip of a leg sits at an attachment of its antecedent, which moves and turns as the link bends:

place  p = r + Φ_d e + ½ eᵀ H e,  turn  R = Cay(Φ_r e),

with the foreshortening H and Cayley's map, which is rational.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from parflex.base.array import Array, cross, dot, mtv, mv, skew
from parflex.base.spatial import cayley
from parflex.mechanics.platform import Deformed, deformed, platform_of, velocity_forces
from parflex.robot.body import FlexibleBody
from parflex.robot.moments import Moments


class Link(NamedTuple):
    """The tables of the flexible bodies that L legs have at one joint, with a attachments and N shapes."""

    moments: Moments  # of (L,), (L, 3) …
    stiffness: Array  # (L, N)
    damping: Array  # (L, N)
    m_ee: Array  # (L, N, N)
    points: Array  # (L, a, 3)
    shapes: Array  # (L, a, 3, N), Φ_d
    turns: Array  # (L, a, 3, N), Φ_r
    shortening: Array  # (L, a, 3, N, N), H


class Seat(NamedTuple):
    """An attachment of a bent link, in the axes of the link's frame."""

    place: Array  # (…, L, 3)
    turn: Array  # (…, L, 3, 3)
    shift: Array  # (…, L, 3, N), Φ = Φ_d + H e: the velocity of the place is Φ ė
    tilt: Array  # (…, L, 3, N), Θ: the angular velocity is Θ ė
    rest: Array  # (L, 3)
    vector: Array  # (…, L, 3), a = Φ_r e
    turns: Array  # (L, 3, N), Φ_r
    shortening: Array  # (L, 3, N, N)


class Drift(NamedTuple):
    """The part of a seat's motion in the link's frame that is due to rates ė: velocity, angular velocity, and
    accelerations at ë = 0, all in the axes of that frame."""

    velocity: Array
    spin: Array
    acceleration: Array
    spinning: Array


def link_of(body: FlexibleBody) -> Link:
    """The tables of one body."""
    tables = platform_of(body)
    moments = Moments._make(np.asarray(part)[None] for part in tables.moments)
    rest = (body.attachment_points, body.attachment_shapes, body.attachment_turns, body.attachment_shortening)
    parts = (tables.stiffness, tables.damping, tables.m_ee, *rest)
    return Link(moments, *(np.asarray(part)[None] for part in parts))


def side_by_side(links: Sequence[Link | None]) -> Link | None:
    """The tables of legs of equal structure as one."""
    found = [link for link in links if link is not None]
    if not found:
        return None
    tables = [tables_of(link) for link in found]
    return with_tables(found[0], [np.concatenate(parts) for parts in zip(*tables, strict=True)])


def tables_of(link: Link) -> list[Any]:
    """The tables (L, …) of a link, one after the other."""
    return [*link.moments, *link[1:]]


def with_tables(link: Link, tables: Sequence[Any]) -> Link:
    """A link of other tables, in the order of `tables_of`."""
    count = len(link.moments)
    return Link(Moments._make(tables[:count]), *tables[count:])


def seat_at(link: Link, attachment: int, e: Array) -> Seat:
    """A seat at elastic coordinates e (…, L, N)."""
    rest, Phi_d, Phi_r, H = (
        table[:, attachment] for table in (link.points, link.shapes, link.turns, link.shortening)
    )
    shift = Phi_d + mv(H, e[..., None, :])
    a = mv(Phi_r, e)
    turn, tilt = cayley(a, Phi_r)
    place = rest + 0.5 * mv(Phi_d + shift, e)
    return Seat(place, turn, shift, tilt, rest, a, Phi_r, H)


def drift_of(seat: Seat, ed: Array) -> Drift:
    """The motion that rates ė (…, L, N) give to a seat."""
    a, spin = seat.vector, mv(seat.tilt, ed)
    slowing = -0.5 * dot(a, mv(seat.turns, ed)) / (1.0 + 0.25 * dot(a, a))
    bent = mv(mv(seat.shortening, ed[..., None, :]), ed)
    return Drift(mv(seat.shift, ed), spin, bent, slowing[..., None] * spin)


def twist_map(seat: Seat) -> tuple[Array, Array]:
    """The twist that ė gives to all that hangs on a seat, as one body: the velocity (…, L, 3, N) of the point
    of it that is at the link's origin, and the angular velocity."""
    return seat.shift + skew(seat.place) @ seat.tilt, seat.tilt


def pushed(seat: Seat, force: Array, moment: Array) -> Array:
    """The modal forces (…, L, N) of a force at a seat and a moment about it, in the link's axes."""
    return mtv(seat.shift, force) + mtv(seat.tilt, moment)


def body_at(link: Link, e: Array) -> Deformed:
    """The inertia integrals of links at e (…, L, N)."""
    return deformed(link.moments, e)


def body_wrench(
    link: Link, at: Deformed, omega: Array, omegad: Array, vd: Array, ed: Array, edd: Array
) -> tuple[Array, Array, Array]:
    """The force, the moment about the frame's origin and the modal forces that a link's motion takes."""
    t = link.moments
    f_c, n_c, Q_c = velocity_forces(t, at, omega, ed)
    force = np.asarray(t.m)[:, None] * vd + cross(omegad, at.MS) + mv(at.S, edd) + f_c
    moment = cross(at.MS, vd) + mv(at.inertia, omegad) + mv(at.MS_re, edd) + n_c
    modal = mtv(at.S, vd) + mtv(at.MS_re, omegad) + mv(link.m_ee, edd) + Q_c
    return force, moment, modal


def strain(link: Link, e: Array, ed: Array) -> Array:
    """K e + D ė (…, L, N)."""
    return link.stiffness * e + link.damping * ed
