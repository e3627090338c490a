"""Couplings: springs and dampers that act on several joints of a leg together, as a flexure does."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import exactly, whole_numbers
from parflex.base.errors import InputError
from parflex.base.held import Held
from parflex.robot.fields import check_fields, held
from parflex.robot.flexure import check_not_negative
from parflex.robot.words import told


def numbers(name: str, value: Any) -> tuple[int, ...]:
    """Joint numbers, each once and from 1."""
    found = tuple(int(j) for j in whole_numbers(name, value))
    if not found or min(found) < 1 or len(set(found)) < len(found):
        raise InputError(f"{name} is {list(found)}; name joints by their numbers, from 1, each once")
    return found


@dataclass(frozen=True, eq=False)
class Coupling:
    """A stiffness and damping on n joints of a leg, each the antecedent of the next: K (q − q_0) + D q̇.

    `joints` (n,) are their numbers in the leg, from 1; `stiffness` K and `damping` D (n, n) are in N/m, N/rad
    = N m/m and N m/rad by the joints' types, `rest` q_0 (n,) in m and rad. It acts on the joint variables q;
    angles are within half a turn of the rest. Six joints without mass and a 6 × 6 matrix are a flexure.

    Raises InputError where a matrix or the rest has another size, or a matrix is not symmetric or has a
    negative direction.

    >>> Coupling((1, 2), [[30.0, 4.0], [4.0, 20.0]]).rest.tolist()
    [0.0, 0.0]
    """

    joints: Held[Sequence[int], tuple[int, ...]] = held(numbers)
    stiffness: Held[ArrayLike, Array] = held()
    damping: Held[ArrayLike, Array] = held(default=0.0)
    rest: Held[ArrayLike, Array] = held(default=0.0)

    def __post_init__(self) -> None:
        check_fields(self)
        n = len(self.joints)
        for name, shape in (("stiffness", (n, n)), ("damping", (n, n)), ("rest", (n,))):
            value: Any = getattr(self, name)
            value = np.zeros(shape) if isinstance(value, (int, float)) and value == 0 else value
            object.__setattr__(self, name, exactly(f"Coupling.{name}", value, shape))
        for name in ("stiffness", "damping"):
            check_not_negative(f"Coupling.{name}", getattr(self, name))

    __repr__ = told


def check_couplings(couplings: Sequence[Coupling], antecedents: Sequence[int]) -> None:
    """Raise InputError where a coupling is on joints that there are not, or across a branch of the tree;
    antecedents are from 1, 0 for the base."""
    for number, coupling in enumerate(couplings):
        check_row(f"Leg.couplings[{number}].joints", coupling.joints, antecedents)


def check_row(name: str, joints: Sequence[int], antecedents: Sequence[int]) -> None:
    """Raise InputError where joints, from 1, are not there, or not each the antecedent of the next."""
    if max(joints) > len(antecedents):
        raise InputError(f"{name} is {list(joints)}; this leg has joints 1 … {len(antecedents)}")
    for first, second in pairwise(joints):
        if antecedents[second - 1] != first:
            raise InputError(
                f"{name} is {list(joints)}, a coupling across a branch of the tree: joint {second} does not "
                f"follow joint {first} but {antecedents[second - 1] or 'the base'}; name joints each of "
                f"which is the antecedent of the next"
            )
