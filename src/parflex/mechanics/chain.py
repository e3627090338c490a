"""Legs as modified-Denavit–Hartenberg trees (Sec. 3): tables, frames, Jacobians.

A `Chain` holds the tables of L legs of equal structure, so that one pass treats them all:
arrays are (…, L, …) and the structure (antecedents, joint types, seats) is shared. The coordinates of a
leg are z = (q, e, δ): its joints, then the elastic coordinates of its flexible links, link by link, then the
deflections of drives that give, joint by joint.

Source: Khalil and Dombre, Modeling, Identification and Control of Robots, ch. 3, 5 and 9.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from parflex.base.array import Array, block, cross, dot, matrix, mv, skew, stack
from parflex.base.spatial import exact_cos_sin
from parflex.mechanics.couplings import Coupled, coupled, side_by_side_couplings
from parflex.mechanics.link import Link, Seat, body_at, link_of, seat_at, side_by_side
from parflex.mechanics.platform import Deformed
from parflex.robot.fields import Column, described
from parflex.robot.layout import spans
from parflex.robot.leg import Joint, Leg

E_Z = np.array([0.0, 0.0, 1.0])
REST_RATE = "rest_rate"  # the table of a chain whose springs have rests that move


@dataclass(frozen=True, eq=False)
class Chain:
    """Tables of L trees of n joints; `antecedent[j]` is an index, −1 for the base frame.

    Each field of a joint that is a table there (`columns`) is one here, under the same name:
    `chain.alpha` (L, n), `chain.MS` (L, n, 3), `chain.I` (L, n, 3, 3) about the frame's origin. A flexible
    link has `links[j]` instead of mass and inertia there; joint k sits at the attachment `seats[k]` of its
    antecedent where that is flexible.
    """

    antecedent: tuple[int, ...]
    sigma: tuple[int, ...]
    columns: Mapping[str, Column]
    tables: Mapping[str, Array]
    links: tuple[Link | None, ...]
    seats: tuple[int, ...]
    drives: tuple[int, ...]  # the joints whose motors drive through a compliance
    couplings: tuple[Coupled, ...]

    def __getattr__(self, name: str) -> Array:
        """The table of that name."""
        try:
            return vars(self)["tables"][name]
        except KeyError:
            raise AttributeError(f"a chain has no table {name!r}", name=name, obj=self) from None

    def with_tables(self, tables: Mapping[str, Array]) -> "Chain":
        """The chain with some tables in the place of its own."""
        return replace(self, tables={**self.tables, **tables})

    def with_moving_rests(self, rests: Array, rates: Array) -> "Chain":
        """The chain whose springs have rests at (…, L, n) that move at these rates, each leg its own."""
        own = replace(self.columns["q_0"], alike=False)
        columns = {**self.columns, "q_0": own, REST_RATE: own}
        return replace(self, columns=columns, tables={**self.tables, "q_0": rests, REST_RATE: rates})

    @property
    def n(self) -> int:
        """Number of joints of one tree."""
        return len(self.sigma)

    @cached_property
    def modes(self) -> tuple[int, ...]:
        """The number of elastic coordinates of each link."""
        return tuple(0 if link is None else link.stiffness.shape[-1] for link in self.links)

    @cached_property
    def size(self) -> int:
        """The number of coordinates z of one tree."""
        return self.n + sum(self.modes) + len(self.drives)

    @cached_property
    def elastic(self) -> list[slice]:
        """The places of the elastic coordinates of each link among those of the tree."""
        return spans(*self.modes)

    def path(self, j: int) -> list[int]:
        """The joints from the base to frame j, j included."""
        return [] if j < 0 else [*self.path(self.antecedent[j]), j]


def chain_of(leg: Leg) -> Chain:
    """The tables of one leg; a joint without a field that others have is as by default there."""
    columns: dict[str, Column] = {}
    for kind in (Joint, *map(type, leg.joints)):
        columns |= {name: column for name, column in described(kind).items() if column.table}
    tables = {
        name: np.array([entry(joint, name, column) for joint in leg.joints], dtype=float)
        for name, column in columns.items()
    }
    tables = {name: table.reshape(1, -1, *columns[name].shape) for name, table in tables.items()}
    links = tuple(None if joint.body is None else link_of(joint.body) for joint in leg.joints)
    structure = tuple(a - 1 for a in leg.antecedents), tuple(j.sigma for j in leg.joints)
    return Chain(*structure, columns, tables, links, leg.seats.joints, leg.drives, coupled(leg))


def entry(joint: Joint, name: str, column: Column) -> Any:
    """The entry of a joint in a table: its field, by default where it has none; zero of what is absent."""
    value = getattr(joint, name, column.default)
    return 0.0 if value is None else value


def joined(chains: Sequence[Chain]) -> Chain:
    """Chains of equal structure as one, their legs one after the other."""
    first = chains[0]
    tables = {name: np.concatenate([c.tables[name] for c in chains]) for name in first.tables}
    links = tuple(side_by_side(alike) for alike in zip(*(c.links for c in chains), strict=True))
    couplings = (side_by_side_couplings(alike) for alike in zip(*(c.couplings for c in chains), strict=True))
    return replace(first, tables=tables, links=links, couplings=tuple(couplings))


class Joints(NamedTuple):
    """Joint variables as a closed form gives them, of an angle its cosine and sine; and the links' bend."""

    cos: Array  # (…, L, n); 1 for a prismatic joint
    sin: Array  # (…, L, n); 0 for a prismatic joint
    length: Array  # (…, L, n); 0 for a revolute joint
    bend: Array = np.zeros(0)  # (…, L, ΣN + d), the elastic coordinates of the links and the d drives


class Frames(NamedTuple):
    """Per joint j with antecedent a: R_aj, p_aj (in a), and R_0j, p_0j in the base frame.

    The base frame itself, number −1, is the last of R_0j and p_0j. Of flexible links there are the bodies as
    they are bent, and of joints on them the seats.
    """

    R_aj: list[Array]
    p_aj: list[Array]
    R_0j: list[Array]
    p_0j: list[Array]
    seats: list[Seat | None]
    bodies: list[Deformed | None]


class Point(NamedTuple):
    """A point (…, L, 3) of link j, fixed to it, or on a seat of it where it is flexible."""

    link: int
    place: Array
    seat: Seat | None


def frame_in_antecedent(chain: Chain, j: int, joints: Joints) -> tuple[Array, Array]:
    """R_aj, p_aj = Rot(z,γ) Trans(z,b) Rot(x,α) Trans(x,d) Rot(z,θ) Trans(z,r), of a rigid antecedent."""
    cg, sg = exact_cos_sin(chain.gamma[:, j])
    ca, sa = exact_cos_sin(chain.alpha[:, j])
    c0, s0 = exact_cos_sin(chain.theta[:, j])
    c, s = joints.cos[..., j], joints.sin[..., j]
    ct, st = c * c0 - s * s0, s * c0 + c * s0
    d, r = chain.d[:, j], chain.r[:, j] + joints.length[..., j]
    R = matrix(
        [
            [cg * ct - sg * ca * st, -cg * st - sg * ca * ct, sg * sa],
            [sg * ct + cg * ca * st, -sg * st + cg * ca * ct, -cg * sa],
            [sa * st, sa * ct, ca],
        ]
    )
    return R, stack([d * cg + r * (sg * sa), d * sg - r * (cg * sa), r * ca + chain.b[:, j]])


def placement(chain: Chain, j: int) -> tuple[Array, Array]:
    """R_aj (L, 3, 3) and p_aj (L, 3) where the joint variable is zero, and the antecedent not bent."""
    still = np.zeros(chain.r.shape)
    return frame_in_antecedent(chain, j, Joints(still + 1.0, still, still, still[:, :0]))


def frames(chain: Chain, joints: Joints) -> Frames:
    """All frames of the trees for given joint variables."""
    legs = joints.cos.shape[:-1]
    out = Frames([], [], [np.broadcast_to(np.eye(3), (*legs, 3, 3))], [np.zeros((*legs, 3))], [], [])
    for j, a in enumerate(chain.antecedent):
        R_aj, p_aj = frame_in_antecedent(chain, j, joints)
        seat = joint_seat(chain, j, joints.bend)
        if seat is not None:
            R_aj, p_aj = seat.turn @ R_aj, seat.place + mv(seat.turn, p_aj - seat.rest)
        link = chain.links[j]
        out.R_aj.append(R_aj)
        out.p_aj.append(p_aj)
        out.seats.append(seat)
        out.bodies.append(None if link is None else body_at(link, bend_of(chain, joints.bend, j)))
        out.R_0j.insert(j, out.R_0j[a] @ R_aj)
        out.p_0j.insert(j, out.p_0j[a] + mv(out.R_0j[a], p_aj))
    return out


def bend_of(chain: Chain, elastic: Array, j: int) -> Array:
    """The part (…, L, N_j) of link j of elastic coordinates (…, L, ΣN), or of their rates."""
    return elastic[..., chain.elastic[j]]


def joint_seat(chain: Chain, j: int, bend: Array) -> Seat | None:
    """The seat of joint j on its antecedent, of links bent by (…, L, ΣN); None where that is rigid."""
    return seat_on(chain, chain.antecedent[j], chain.seats[j], bend)


def seat_on(chain: Chain, link: int, attachment: int, bend: Array) -> Seat | None:
    """The seat at an attachment of a link; None for a rigid one, and for the base."""
    body = chain.links[link] if link >= 0 else None
    return None if body is None else seat_at(body, attachment, bend_of(chain, bend, link))


def tip_position(frame: Frames, point: Point) -> Array:
    """Position in the base frame of a point of a link."""
    return frame.p_0j[point.link] + mv(frame.R_0j[point.link], point.place)


def tip_rotation(frame: Frames, point: Point) -> Array:
    """The axes (…, L, 3, 3) of the section at a point of a link, in the base frame."""
    R = frame.R_0j[point.link]
    return R if point.seat is None else R @ point.seat.turn


def tip_jacobian(chain: Chain, frame: Frames, point: Point) -> Array:
    """J (…, L, 3, z) with v = J ż for a point of a link, in base axes."""
    p_0t = tip_position(frame, point)
    on_path = chain.path(point.link)
    columns = []
    for k in range(chain.n):
        z = frame.R_0j[k][..., :, 2]
        turn, slide = (1 - chain.sigma[k], chain.sigma[k]) if k in on_path else (0, 0)
        columns.append((turn * cross(z, p_0t - frame.p_0j[k]) + slide * z)[..., None])  # Eq. 3
    for a, seat in seats_towards(chain, frame, point):
        if seat is None:
            columns.append(np.zeros((3, chain.modes[a])))
            continue
        R, here = frame.R_0j[a], frame.p_0j[a] + mv(frame.R_0j[a], seat.place)
        moved = R @ seat.shift
        columns.append(moved if a == point.link else moved - skew(p_0t - here) @ (R @ seat.tilt))
    return block([[*columns, np.zeros((3, len(chain.drives)))]])


def turning_jacobian(chain: Chain, frame: Frames, point: Point) -> Array:
    """(…, L, 3, z) with ω = J_r ż for the section at a point of a link, in base axes."""
    on_path = chain.path(point.link)
    columns = [
        ((1 - chain.sigma[k]) * (k in on_path) * frame.R_0j[k][..., :, 2])[..., None] for k in range(chain.n)
    ]
    for a, seat in seats_towards(chain, frame, point):
        columns.append(np.zeros((3, chain.modes[a])) if seat is None else frame.R_0j[a] @ seat.tilt)
    return block([[*columns, np.zeros((3, len(chain.drives)))]])


def seats_towards(chain: Chain, frame: Frames, point: Point) -> list[tuple[int, Seat | None]]:
    """Each flexible link, with the seat of it that the way from the base to a point leads through."""
    way = chain.path(point.link)
    next_joint = {chain.antecedent[k]: k for k in way}
    found: list[tuple[int, Seat | None]] = []
    for a, modes in enumerate(chain.modes):
        if modes and a == point.link:
            found.append((a, point.seat))
        elif modes:
            found.append((a, frame.seats[next_joint[a]] if a in next_joint else None))
    return found


def joint_position(chain: Chain, joints: Joints, j: int, reference: Array) -> Array:
    """q_j less a reference (…, L): (…, L), for a revolute joint an angle in (−π, π]."""
    if chain.sigma[j]:
        return joints.length[..., j] - reference
    c0, s0 = exact_cos_sin(reference)
    c, s = joints.cos[..., j], joints.sin[..., j]
    return np.arctan2(s * c0 - c * s0, c * c0 + s * s0)


def potential_energy(chain: Chain, frame: Frames, gravity: Array) -> Array:
    """−g·Σ (M p_0j + R_0j MS): (…, L), zero at the base frame."""
    moments = [
        mass(chain, j)[:, None] * frame.p_0j[j] + mv(frame.R_0j[j], first_moment(chain, frame, j))
        for j in range(chain.n)
    ]
    return -dot(gravity, sum(moments, np.zeros(3)))


def mass(chain: Chain, j: int) -> Array:
    """The mass (L,) of link j."""
    link = chain.links[j]
    return chain.M[:, j] if link is None else np.asarray(link.moments.m)


def first_moment(chain: Chain, frame: Frames, j: int) -> Array:
    """MS (…, L, 3) of link j about its frame's origin, as it is bent."""
    body = frame.bodies[j]
    return chain.MS[:, j] if body is None else body.MS
