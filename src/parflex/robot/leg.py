"""A leg: the table of its joints, its tips, and its place on the base."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np
from numpy.typing import ArrayLike

from parflex.base import kinds
from parflex.base.array import Array
from parflex.base.check import (
    FLAG,
    NOT_NEGATIVE,
    POSITIVE,
    SYMMETRIC,
    all_of_type,
    exactly,
    integer,
    of_type,
    single_rotation,
)
from parflex.base.errors import InputError
from parflex.base.held import Given, Held
from parflex.robot.body import FlexibleBody
from parflex.robot.coupling import Coupling, check_couplings
from parflex.robot.fields import about, check_fields, exact, held, number, optional
from parflex.robot.flexure import Flexure
from parflex.robot.link_checks import check_drive, check_link, check_turns
from parflex.robot.seats import Seats, seats
from parflex.robot.words import listed, told


@dataclass(frozen=True, eq=False)
class Joint:
    """One row of Table 1 with the inertia of the link it carries; SI units and radians.

    The joint variable is added to `theta` (sigma 0, revolute) or to `r` (sigma 1, prismatic).
    `M`, `MS`, `I` are the link's mass (kg), first moments (kg m) and inertia about the origin of
    the link frame (kg m², products as matrix entries), in link axes; grouped base parameters are
    welcome. `IA` is the rotor inertia seen at the joint (kg m² or kg).

    Friction `Fv` q̇ + `Fs` q̇/√(q̇² + v_s²) (Coulomb's, smoothed over the rate `v_s`) and a spring
    `k` (q − q_0) act on the joint, the spring of a revolute joint within half a turn of `q_0`.
    A `drive_stiffness` (N/m or N m/rad) is a compliance in series between the motor and the link, with a
    `drive_damping` (N s/m or N m s/rad) beside it. The joint variable stays that of the link; the motor is at
    θ = q − δ, with the drive's deflection δ in the state, and there IA, friction, the spring and the motor's
    force act.

    `q_min` and `q_max` are reported where they are exceeded, not enforced.

    A flexible link is a `body` instead of M, MS and I, given in the link's frame, at whose origin it is
    clamped: shapes and rotations vanish there. Tips, and joints whose antecedent it is, sit at its
    attachments, found by their place.

    Raises InputError where a value is not finite, a flag is not 0 or 1, M, IA, friction or k is
    negative, v_s is not positive, I is not symmetric, q_min is not below q_max, mass is given twice, a drive
    gives on a joint without a motor or its rotor's inertia, or the body has no attachments, or shapes that it
    needs.
    """

    antecedent: int = field(metadata=about(integer))
    sigma: int = field(metadata=about(integer, rule=FLAG))
    mu: int = field(default=0, metadata=about(integer, rule=FLAG))
    gamma: float = number(0.0, kinds.ANGLE, "gamma", "angle about the antecedent's z, to its common normal")
    b: float = number(0.0, kinds.LENGTH, "b", "offset along the antecedent's z")
    alpha: float = number(0.0, kinds.ANGLE, "alpha", "angle between the joints' axes, about x")
    d: float = number(0.0, kinds.LENGTH, "d", "distance between the joints' axes, along x")
    theta: float = number(0.0, kinds.ANGLE, "theta", "angle about the joint's z; a revolute joint adds to it")
    r: float = number(0.0, kinds.LENGTH, "r", "distance along the joint's z; a prismatic joint adds to it")
    M: float = number(0.0, kinds.MASS, "mass", "mass of the link", NOT_NEGATIVE, parameter=True)
    MS: Given = number(
        np.zeros(3),
        kinds.FIRST_MOMENT,
        "first_moment",
        "mass times centre of mass, instead of com",
        parameter=True,
    )
    I: Given = number(  # noqa: E741 - the field's symbol
        np.zeros((3, 3)),
        kinds.INERTIA,
        "inertia",
        "about the link frame's origin: XX YY ZZ XY XZ YZ",
        SYMMETRIC,
        parameter=True,
    )
    IA: float = number(
        0.0,
        kinds.JOINT_INERTIA,
        "rotor_inertia",
        "of the motor, as seen at the joint",
        NOT_NEGATIVE,
        parameter=True,
    )
    Fv: float = number(0.0, kinds.DAMPING, "viscous", "friction per rate", NOT_NEGATIVE, parameter=True)
    Fs: float = number(
        0.0, kinds.EFFORT, "coulomb", "friction of constant size", NOT_NEGATIVE, parameter=True
    )
    v_s: float = number(
        1e-3, kinds.RATE, "coulomb_rate", "over which `coulomb` changes sign", POSITIVE, parameter=True
    )
    k: float = number(
        0.0, kinds.STIFFNESS, "stiffness", "of a spring on the joint", NOT_NEGATIVE, parameter=True
    )
    q_0: float = number(
        0.0, kinds.POSITION, "rest", "where the spring is at rest", parameter=True, alike=True
    )
    q_min: float = number(-np.inf, kinds.POSITION, "min", "lowest joint value; checked, not enforced")
    q_max: float = number(np.inf, kinds.POSITION, "max", "highest joint value; checked, not enforced")
    body: FlexibleBody | None = held(optional(partial(of_type, kind=FlexibleBody)), default=None)
    drive_stiffness: float | None = number(
        None,
        kinds.STIFFNESS,
        "drive_stiffness",
        "of a compliance between the motor and the link",
        POSITIVE,
        parameter=True,
    )
    drive_damping: float = number(
        0.0, kinds.DAMPING, "drive_damping", "of that compliance", NOT_NEGATIVE, parameter=True
    )

    def __post_init__(self) -> None:
        check_fields(self)
        if not self.q_min < self.q_max:
            raise InputError(f"Joint.q_min is {self.q_min} and q_max {self.q_max}; q_min must be less")
        if self.body is not None:
            check_link(self)
        check_drive(self)

    __repr__ = told

    @property
    def mass(self) -> float:
        """The mass of its link, kg."""
        return self.M if self.body is None else self.body.moments.m


@dataclass(frozen=True, eq=False)
class Tip:
    """A spherical joint to the platform: the point `offset` (3,) m of link `frame` (from 1; 0 is the
    leg's base) holds the platform's attachment number `attachment` (from 0); `flexure` acts against its
    turning."""

    frame: int = field(metadata=about(integer))
    offset: Given = held(exact((3,)), default=(0.0, 0.0, 0.0), kind=kinds.LENGTH)
    attachment: int = field(default=0, metadata=about(integer))
    flexure: Flexure | None = held(optional(partial(of_type, kind=Flexure)), default=None)

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def soft(self) -> bool:
        """True where its flexure lets it leave the platform's point."""
        return self.flexure is not None and self.flexure.soft

    @property
    def holding(self) -> "Tip":
        """The tip that does not leave the platform's point; itself where it is not soft."""
        if self.flexure is None or not self.flexure.soft:
            return self
        return replace(self, flexure=replace(self.flexure, translation=None, translation_damping=None))


@dataclass(frozen=True, eq=False)
class Leg:
    """A tree of joints on the base: `rotation` (3, 3) and `origin` (3,) m of Σ0i in Σ0.

    Without joints it is a post, whose tips are on frame 0: spherical joints that stand on the base.
    `posture` (n,) are joint values near which the leg works. Where the inverse geometry has several
    solutions they name the branch, where it has no closed form they start Newton's method; without
    them it is the leg type's first branch, and zeros. `couplings` are stiffnesses on several joints together.

    Raises InputError where the tree has a loop, a tip is on no link, a coupling is across a branch, or a
    joint or a tip on a flexible link is at none of its attachments.
    """

    rotation: Given = held(single_rotation)
    origin: Given = held(exact((3,)), kind=kinds.LENGTH)
    joints: Held[Sequence[Joint], tuple[Joint, ...]] = held(partial(all_of_type, kind=Joint))
    tips: Held[Sequence[Tip], tuple[Tip, ...]] = held(partial(all_of_type, kind=Tip))
    posture: Held[ArrayLike | None, Array | None] = held(default=None)
    couplings: Held[Sequence[Coupling], tuple[Coupling, ...]] = held(
        partial(all_of_type, kind=Coupling), default=()
    )

    def __post_init__(self) -> None:
        check_fields(self)
        for j, joint in enumerate(self.joints, start=1):
            if not 0 <= joint.antecedent < j:
                raise InputError(
                    f"Leg.joints: joint {j} has antecedent {joint.antecedent}; it must be a "
                    f"lower joint number, or 0 for the base, so that the tree has no loop"
                )
        if not self.tips:
            raise InputError("Leg.tips is empty; a leg holds the platform by at least one tip")
        for tip in self.tips:
            if tip.frame > len(self.joints):
                links = f"links 1 … {len(self.joints)}, and" if self.joints else "no links, only"
                raise InputError(f"Tip.frame is {tip.frame}; this leg has {links} its base, frame 0")
        if self.posture is not None:
            object.__setattr__(self, "posture", exactly("Leg.posture", self.posture, (len(self.joints),)))
        check_couplings(self.couplings, self.antecedents)
        _ = self.seats  # raises

    def __repr__(self) -> str:
        held = ", ".join(str(tip.attachment) for tip in self.tips)
        return f"Leg: {self.word} at {listed(self.origin)} m, holds {held}"

    @property
    def structure(self) -> tuple[object, ...]:
        """The properties that two legs must share to be computed in one pass."""
        joints = tuple((type(j), j.antecedent, j.sigma, j.mu, j.drive_stiffness is None) for j in self.joints)
        tips = tuple((t.frame, t.flexure is not None, t.soft) for t in self.tips)
        return joints, tips, self.modes, self.seats, tuple(each.joints for each in self.couplings)

    @cached_property
    def modes(self) -> tuple[int, ...]:
        """The number of elastic coordinates of each link; zero for rigid ones."""
        return tuple(0 if joint.body is None else joint.body.modes for joint in self.joints)

    @property
    def soft(self) -> bool:
        """True where a tip is soft."""
        return any(tip.soft for tip in self.tips)

    @property
    def holding(self) -> "Leg":
        """The leg whose tips do not leave the platform's points; itself where none is soft."""
        return replace(self, tips=[tip.holding for tip in self.tips]) if self.soft else self

    @property
    def size(self) -> int:
        """The number of coordinates z = (q, e, δ) of the leg."""
        return len(self.joints) + self.bends

    @property
    def bends(self) -> int:
        """The number of its elastic coordinates: of its links, link by link, then of its drives."""
        return sum(self.modes) + len(self.drives)

    @cached_property
    def drives(self) -> tuple[int, ...]:
        """The joints, from 0, whose motors drive through a compliance."""
        return tuple(j for j, joint in enumerate(self.joints) if joint.drive_stiffness is not None)

    @cached_property
    def seats(self) -> Seats:
        """The attachments of flexible links at which joints and tips sit."""
        bodies = [joint.body for joint in self.joints]
        places = [placed(joint) for joint in self.joints]
        antecedents = [joint.antecedent - 1 for joint in self.joints]
        tips = [(tip.frame - 1, np.asarray(tip.offset)) for tip in self.tips]
        found = seats(bodies, antecedents, places, tips)
        check_turns(bodies, self.joints, self.tips)
        return found

    @property
    def pattern(self) -> str:
        """The joints as letters, R and P."""
        return "".join("RP"[j.sigma] for j in self.joints)

    @property
    def antecedents(self) -> tuple[int, ...]:
        """Antecedents of the joints, 0 for the base."""
        return tuple(j.antecedent for j in self.joints)

    @property
    def word(self) -> str:
        """The joints as letters, R and P, the actuated ones underlined by a star: 'RRP*'; 'post' for none."""
        return "".join("RP"[j.sigma] + "*" * j.mu for j in self.joints) or "post"


def placed(joint: Joint) -> tuple[Array, Array]:
    """A point of a joint's axis, and its direction (3,), in the frame of the antecedent: of a joint that
    turns its frame's origin, of one that slides where it is with r = 0."""
    sg, cg, sa, ca = np.sin(joint.gamma), np.cos(joint.gamma), np.sin(joint.alpha), np.cos(joint.alpha)
    axis = np.array([sg * sa, -cg * sa, ca])
    foot = np.array([joint.d * cg, joint.d * sg, joint.b])
    return foot + (0.0 if joint.sigma else joint.r) * axis, axis


def deviations(joint: Joint, alpha: float) -> list[float]:
    """The differences of γ, b, d from zero and of α from a value, by which leg types recognise a row."""
    return [joint.gamma, joint.b, joint.d, joint.alpha - alpha]
