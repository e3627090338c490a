"""The tables of couplings: stiffness and damping on several joints of a leg together."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.robot.leg import Leg


class Coupled(NamedTuple):
    """A coupling that L legs of equal structure have on the same n joints, from 0."""

    joints: tuple[int, ...]
    stiffness: Array  # (L, n, n)
    damping: Array  # (L, n, n)
    rest: Array  # (L, n)


def coupled(leg: Leg) -> tuple[Coupled, ...]:
    """The tables of the couplings of one leg."""
    return tuple(
        Coupled(tuple(j - 1 for j in c.joints), c.stiffness[None], c.damping[None], c.rest[None])
        for c in leg.couplings
    )


def side_by_side_couplings(alike: Sequence[Coupled]) -> Coupled:
    """The tables of one coupling of legs of equal structure as one."""
    tables = (np.concatenate(parts) for parts in zip(*(each[1:] for each in alike), strict=True))
    return Coupled(alike[0].joints, *tables)


def of_first(coupling: Coupled, count: int) -> Coupled:
    """The tables of the first so many legs."""
    return Coupled(coupling.joints, *(table[:count] for table in coupling[1:]))
