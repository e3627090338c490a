"""The inverse model of legs that bend with the load and do not swing: ë = ė = 0, and e is an answer."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from parflex.analysis.settling import settled
from parflex.base.array import Array
from parflex.compiled.functions import Functions
from parflex.kernels import models
from parflex.kernels.kernel import Vectors
from parflex.mechanics.closure import ALL, CLOSED, JOINTS, POSE, closed, with_rates
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.output import Output


class StaticLegs(NamedTuple):
    """The flat state (…, size) with bent legs at rest in their bend, and the inverse model's answer there."""

    x: Array
    found: Vectors


def static_legs(
    functions: Functions,
    output: Output,
    x: Array,
    load: Callable[[Array], Array],
    theta: Array,
    **given: Array,
) -> StaticLegs:
    """Legs bent by the forces that an output's target takes, from those of a flat state (…, size).

    `load` gives the generalised force (…, 6 + N) at a flat state; given are target and preload.

    Raises NotConverged where no such bend is found.
    """
    mechanism = functions.mechanism
    bends, function = elastic_entries(mechanism), functions(models.static_inverse, output, theta=theta)
    batch = np.broadcast_shapes(x.shape[:-1], theta.shape[:-1], *(a.shape[:-1] for a in given.values()))
    start = np.broadcast_to(x, np.broadcast_shapes((*batch, x.shape[-1]), load(x).shape[:-1] + x.shape[-1:]))

    def answer(e: Array) -> StaticLegs:
        there = bent_legs(mechanism, start, e)
        return StaticLegs(there, function.run(x=there, load=load(there), **given))

    def excess(e: Array) -> Array:
        with np.errstate(invalid="ignore", divide="ignore"):
            return answer(e).found["excess"][..., bends]

    carried = start[..., mechanism.layout.at.joints]
    scale = mechanism.size * mechanism.roots[mechanism.kept][bends]
    return answer(settled(excess, carried[..., bends], scale))


def bent_legs(mechanism: Mechanism, x: Array, e: Array) -> Array:
    """The flat state (…, size) with legs bent by e (…, n), at rest in their bend.

    Of legs that do not close by themselves it is the nearest that they allow, as `flat_state.projected`
    finds it; not a number where there is none.
    """
    layout, bends = mechanism.layout, elastic_entries(mechanism)
    there = np.array(np.broadcast_to(x, e.shape[:-1] + x.shape[-1:]))
    there[..., layout.at.joints.start + bends] = e
    there[..., layout.at.joint_rates.start + bends] = 0.0
    if mechanism.closed:
        return there
    if any(layout.joints):
        there = closed(mechanism, there, JOINTS)[0]
    found, open_ones = there, np.ones(there.shape[:-1], dtype=bool)
    for freedom in (POSE, ALL):
        nearest, gap = closed(mechanism, there, freedom)
        shut = open_ones & (gap <= 10 * CLOSED * mechanism.size)
        found = np.where(shut[..., None], with_rates(mechanism, nearest, freedom), found)
        open_ones = open_ones & ~shut
        if not np.any(open_ones):
            break
    return np.where(open_ones[..., None], np.nan, found)


def elastic_entries(mechanism: Mechanism) -> Array:
    """The places of the legs' elastic coordinates among the coordinates that the state carries."""
    every = [np.arange(part.start, part.stop) for part in mechanism.layout.by_leg[1]]
    return np.concatenate([np.zeros(0, dtype=int), *every])
