"""What a leg is: its table, its tips, and where it stands."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from parflex.base.array import Given
from parflex.base.check import all_of_type, exactly, integer, positive, rotation_matrix, scalar
from parflex.base.errors import InputError

NOT_NEGATIVE = ("M", "IA", "Fv", "Fs", "k")  # of a joint's numbers


@dataclass(frozen=True, eq=False)
class Joint:
    """One row of Table 1 with the inertia of the link it carries; SI units and radians.

    The joint variable is added to `theta` (sigma 0, revolute) or to `r` (sigma 1, prismatic).
    `M`, `MS`, `I` are the link's mass (kg), first moments (kg m) and inertia about the origin of
    the link frame (kg m², products as matrix entries), in link axes; grouped base parameters are
    welcome. `IA` is the rotor inertia seen at the joint (kg m² or kg).

    Friction `Fv` q̇ + `Fs` q̇/√(q̇² + v_s²) (Coulomb's, smoothed over the rate `v_s`) and a spring
    `k` (q − q_0) act on the joint, the spring of a revolute joint within half a turn of `q_0`.
    `q_min` and `q_max` are reported where they are exceeded, not enforced.

    Raises InputError where a value is not finite, a flag is not 0 or 1, M, IA, friction or k is
    negative, v_s is not positive, I is not symmetric, or q_min is not below q_max.
    """

    antecedent: int
    sigma: int
    mu: int = 0
    gamma: float = 0.0
    b: float = 0.0
    alpha: float = 0.0
    d: float = 0.0
    theta: float = 0.0
    r: float = 0.0
    M: float = 0.0
    MS: Given = (0.0, 0.0, 0.0)
    I: Given = field(default_factory=lambda: np.zeros((3, 3)))  # noqa: E741 - the field's symbol
    IA: float = 0.0
    Fv: float = 0.0
    Fs: float = 0.0
    v_s: float = 1e-3
    k: float = 0.0
    q_0: float = 0.0
    q_min: float = -np.inf
    q_max: float = np.inf

    def __post_init__(self) -> None:
        object.__setattr__(self, "antecedent", integer("Joint.antecedent", self.antecedent))
        for name in ("sigma", "mu"):
            if integer(f"Joint.{name}", getattr(self, name)) > 1:
                raise InputError(f"Joint.{name} is {getattr(self, name)!r}; it must be 0 or 1")
        for name in ("gamma", "b", "alpha", "d", "theta", "r", "M", "IA", "Fv", "Fs", "k", "q_0"):
            object.__setattr__(self, name, scalar(f"Joint.{name}", getattr(self, name)))
        for name in NOT_NEGATIVE:
            if getattr(self, name) < 0:
                raise InputError(f"Joint.{name} is {getattr(self, name)}; it cannot be negative")
        object.__setattr__(self, "v_s", positive("Joint.v_s", self.v_s))
        for name in ("q_min", "q_max"):
            object.__setattr__(self, name, limit(f"Joint.{name}", getattr(self, name)))
        if not self.q_min < self.q_max:
            raise InputError(f"Joint.q_min is {self.q_min} and q_max {self.q_max}; q_min must be less")
        object.__setattr__(self, "MS", exactly("Joint.MS", self.MS, (3,)))
        inertia = exactly("Joint.I", self.I, (3, 3))
        if not np.allclose(inertia, inertia.T, rtol=0, atol=1e-12 * np.abs(inertia).max()):
            raise InputError("Joint.I is not symmetric; give products of inertia as matrix entries")
        object.__setattr__(self, "I", inertia)


@dataclass(frozen=True, eq=False)
class Tip:
    """A spherical joint to the platform: the point `offset` (3,) m of link `frame` (from 1) holds
    the platform's attachment number `attachment` (from 0)."""

    frame: int
    offset: Given = (0.0, 0.0, 0.0)
    attachment: int = 0

    def __post_init__(self) -> None:
        object.__setattr__(self, "offset", exactly("Tip.offset", self.offset, (3,)))
        object.__setattr__(self, "frame", integer("Tip.frame", self.frame, 1))
        object.__setattr__(self, "attachment", integer("Tip.attachment", self.attachment))


@dataclass(frozen=True, eq=False)
class Leg:
    """A rigid tree of joints on the base: `rotation` (3, 3) and `origin` (3,) m of Σ0i in Σ0.

    `posture` (n,) are joint values near which the leg works. Where the inverse geometry has several
    solutions they name the branch, where it has no closed form they start Newton's method; without
    them it is the leg type's first branch, and zeros.

    Raises InputError where the tree has a loop or a tip is on no link.
    """

    rotation: Given
    origin: Given
    joints: tuple[Joint, ...]
    tips: tuple[Tip, ...]
    posture: Given = None

    def __post_init__(self) -> None:
        rotation = exactly("Leg.rotation", self.rotation, (3, 3))
        object.__setattr__(self, "rotation", rotation_matrix("Leg.rotation", rotation))
        object.__setattr__(self, "origin", exactly("Leg.origin", self.origin, (3,)))
        object.__setattr__(self, "joints", all_of_type("Leg.joints", self.joints, Joint))
        object.__setattr__(self, "tips", all_of_type("Leg.tips", self.tips, Tip))
        for number, joint in enumerate(self.joints, start=1):
            if not 0 <= joint.antecedent < number:
                raise InputError(
                    f"Leg.joints: joint {number} has antecedent {joint.antecedent}; it must be a "
                    f"lower joint number, or 0 for the base, so that the tree has no loop"
                )
        if not self.tips:
            raise InputError("Leg.tips is empty; a leg holds the platform by at least one tip")
        for tip in self.tips:
            if not 1 <= tip.frame <= len(self.joints):
                raise InputError(f"Tip.frame is {tip.frame}; this leg has links 1 … {len(self.joints)}")
        if self.posture is not None:
            object.__setattr__(self, "posture", exactly("Leg.posture", self.posture, (len(self.joints),)))

    @property
    def structure(self) -> tuple[object, ...]:
        """What two legs must share to be computed in one pass."""
        joints = tuple((j.antecedent, j.sigma, j.mu) for j in self.joints)
        return joints, tuple(t.frame for t in self.tips)

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
        """The joints as letters, R and P, the actuated ones underlined by a star: 'RRP*'."""
        return "".join("RP"[j.sigma] + "*" * j.mu for j in self.joints)


def limit(name: str, value: Any) -> float:
    """One number, which may be infinite."""
    endless = isinstance(value, (float, np.floating)) and np.isinf(value)
    return float(value) if endless else scalar(name, value)


def deviations(joint: Joint, alpha: float) -> list[float]:
    """How far γ, b, d are from zero and α from a value: what a leg type asks of a row."""
    return [joint.gamma, joint.b, joint.d, joint.alpha - alpha]
