"""Kinds of legs by what their builder knows: bars, lengths and a drive become joints and tips."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.base.plausible import derived
from parflex.robot.bar import Bar, beam_of
from parflex.robot.leg import Joint, Leg, Tip
from parflex.robots.links import Link, link


class LegKind(ABC):
    """A kind of leg as data; its joints, in modified Denavit–Hartenberg parameters, stand in Σ0i."""

    word: ClassVar[str]  # its name in robot files

    @property
    @abstractmethod
    def joints(self) -> tuple[Joint, ...]:
        """The joints and the links that they carry."""

    @property
    @abstractmethod
    def tips(self) -> tuple[Tip, ...]:
        """The spherical joints to the platform."""

    def placed(
        self,
        rotation: ArrayLike,
        origin: ArrayLike,
        attachments: Sequence[int],
        posture: ArrayLike | None = None,
    ) -> Leg:
        """The leg of this kind on a base frame, with the platform's attachment that each tip holds."""
        tips = tuple(replace(tip, attachment=held) for tip, held in zip(self.tips, attachments, strict=True))
        return Leg(rotation, origin, self.joints, tips, posture)


def bar_link(bar: Bar, along: Sequence[float]) -> Link:
    """The link that a bar is, from the origin of the link's frame along a unit vector (3,): M, MS and I, or
    the body of one that bends."""
    if bar.flexible:
        with derived():
            return {"body": beam_of(bar, along).body}
    e = np.asarray(along, dtype=float)
    axial, across = bar.inertia_at_com
    ee = np.outer(e, e)
    return link(bar.kilograms, bar.centre * e, axial * ee + across * (np.eye(3) - ee))


def rod_link(rod: Bar) -> Link:
    """The link of a strut's rod, which slides along z: from the tip at its frame's origin down, or, where it
    bends, from the piston at its other end, in whose frame it is clamped, up to the tip."""
    if rod.flexible:
        return {"r": -length_of(rod, "rod")} | bar_link(rod, (0, 0, 1))
    return bar_link(rod, (0, 0, -1))


def rod_end(rod: Bar) -> tuple[float, float, float]:
    """The tip (3,) m in the frame of a strut's rod."""
    return (0.0, 0.0, length_of(rod, "rod") if rod.flexible else 0.0)


def length_of(bar: Bar, name: str) -> float:
    """The distance between the joints at the ends of a bar; raises InputError where it has no length."""
    if bar.length is None:
        raise InputError(f"{name}.length is missing; give the distance between its joints")
    return bar.length


def towards(axis: ArrayLike, name: str) -> dict[str, Any]:
    """γ and α (rad) that turn z to an axis (3,), x staying level: z = (sin γ sin α, −cos γ sin α, cos α).

    Raises InputError for a vector of no length.
    """
    x, y, z = unit(axis, name)
    level = float(np.hypot(x, y))
    if level == 0.0:
        return {"alpha": 0.0 if z > 0 else np.pi}
    side = -1.0 if y > 0 or (y == 0 and x < 0) else 1.0  # −π/2 < γ ≤ π/2
    return {
        "gamma": float(np.arctan2(side * x, -side * y)) + 0.0,
        "alpha": side * float(np.arctan2(level, z)),
    }


def unit(axis: ArrayLike, name: str) -> Array:
    """A vector (3,) of length 1 along an axis."""
    vector = np.asarray(axis, dtype=float)
    size = float(np.linalg.norm(vector))
    if size == 0.0:
        raise InputError(f"{name} is {vector.tolist()}; give a direction")
    return vector / size
