"""Kernels of robots whose springs have rests that move: `rest` (2 s,) is one more input."""

from collections.abc import Callable

from parflex.kernels.inputs import remade
from parflex.kernels.kernel import Kernel
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.spring_rests import own_rests, with_rests

REST = "rest"


def moved_rests(mechanism: Mechanism, build: Callable[..., Kernel], *chosen: object) -> Kernel:
    """The kernel that `build` makes of the mechanism and its other arguments, with the rests of the s springs
    and their rates, r then ṙ, as an input.

    Inputs that are not given are zero: give `own_rests` where nothing moves.
    """
    return remade(mechanism, REST, own_rests(mechanism), with_rests, build, *chosen)
