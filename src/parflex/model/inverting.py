"""The inverse model behind its door: moving legs, legs that bend statically, and what is refused."""

import warnings
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from parflex.analysis import gains, health
from parflex.analysis.posed import check_posed
from parflex.analysis.static_legs import static_legs
from parflex.base.array import Array
from parflex.base.check import broadcast_together, finite
from parflex.base.errors import DynamicSingularity, InputError
from parflex.kernels import models as kernels
from parflex.kernels.kernel import Vectors
from parflex.mechanics.ordering import by_attachment
from parflex.mechanics.output import THROUGH_SOFT_TIPS, Output, PlatformOutput
from parflex.model import inputs
from parflex.model.core import Core
from parflex.model.inputs import Values, Wrenches
from parflex.model.results import Forces
from parflex.robot.state import State

MOVING, STATIC = "moving", "static"


class Wanted(NamedTuple):
    """The arguments of the inverse model, checked: an output, its target (…, o), and what goes with them."""

    output: Output
    state: State
    x: Array
    wrenches: Wrenches
    theta: Array
    given: dict[str, Array]  # target and preload


def wanted(
    core: Core,
    state: State,
    target: ArrayLike,
    output: Output | None,
    wrenches: Wrenches,
    preload: ArrayLike | None,
    parameters: Values,
) -> Wanted:
    """The arguments of `Model.inverse`, checked."""
    chosen = inputs.commanded(core, output)
    x, target = core.flat(state), finite("target", target, (chosen.size,))
    given = {"target": target, "preload": inputs.preload(core, preload)}
    load, theta = inputs.load(core, state, wrenches), inputs.theta(core, parameters)
    broadcast_together(state=x, wrenches=load, parameters=theta, **given)
    return Wanted(chosen, state, x, wrenches, theta, given)


def inverse(core: Core, asked: Wanted, legs: Any, allow_ill_posed: Any) -> Forces:
    """The forces of `Model.inverse`, which calls this and is to be two calls from here to its caller."""
    check_legs_word("legs", legs)
    if not isinstance(allow_ill_posed, bool):
        raise InputError(f"allow_ill_posed is {type(allow_ill_posed).__name__}; give True or False")
    if isinstance(asked.output, PlatformOutput) and not len(core.mechanism.firm):
        raise InputError(f"output is a {type(asked.output).__name__}, but {THROUGH_SOFT_TIPS}")
    x, found = static(core, asked) if legs == STATIC else moving(core, asked)
    core.check(x, found["health"])
    health.check_finite(found["gain"])
    beyond = judged(core, asked, x, found["gain"], allow_ill_posed or legs == STATIC)
    if np.any(beyond):
        warnings.warn(gains.beyond_words(beyond), DynamicSingularity, stacklevel=3)
    contact = by_attachment(core.mechanism, found["contact"])
    answer = Forces(found["forces"], found["elastic"], found["platform"], contact)
    return answer.with_legs(bend_of(core, x)) if legs == STATIC else answer


def check_legs_word(name: str, legs: Any) -> None:
    """Raise InputError where a word is none for legs."""
    if not isinstance(legs, str) or legs not in (MOVING, STATIC):
        raise InputError(f'{name} is {legs!r}; give "{MOVING}", or "{STATIC}" for legs that do not swing')


def moving(core: Core, asked: Wanted) -> tuple[Array, Vectors]:
    """The flat states, and the answer of legs that move as they do."""
    load = inputs.load(core, asked.state, asked.wrenches)
    function = core.functions(kernels.inverse, asked.output, theta=asked.theta)
    return asked.x, function.run(x=asked.x, load=load, **asked.given)


def static(core: Core, asked: Wanted) -> tuple[Array, Vectors]:
    """The flat states of bent legs, and the answer there."""
    if core.mechanism.soft:
        raise InputError(
            f'legs="{STATIC}" is for legs that bend and tips that hold the platform, but this robot has soft '
            f"tips, which give too: leave it out with output=JointOutput(), or ask model.equilibrium"
        )
    if not any(core.mechanism.layout.elastic):
        return moving(core, asked)
    none = inputs.load(core, asked.state, ())

    def load(x: Array) -> Array:
        return inputs.load(core, core.state(x), asked.wrenches) if len(asked.wrenches) else none

    return static_legs(core.functions, asked.output, asked.x, load, asked.theta, **asked.given)


def judged(core: Core, asked: Wanted, x: Array, gain: Array, allowed: bool) -> Array:
    """True (…,) beyond a dynamic singularity; raises where the gain (…, o m) is singular, or ill-posed."""
    mechanism, output = core.mechanism, asked.output
    bends = mechanism.gives
    build = kernels.platform_gains if bends else kernels.gains
    other = core.functions(build, output, theta=asked.theta).run(x=x)
    platform = other["flexible"] if bends else gain
    beyond = gains.check_gain(mechanism, output, *gains.spread(x, platform, other["rigid"]))
    if bends and isinstance(output, PlatformOutput):
        check_posed(mechanism, output, *gains.spread(x, gain, platform)[1:], allowed=allowed)
    return beyond


def bend_of(core: Core, x: Array) -> tuple[Array, ...]:
    """The elastic coordinates (…, N_i) of each leg."""
    layout = core.mechanism.layout
    carried = x[..., layout.at.joints]
    return tuple(np.array(carried[..., part]) for part in layout.by_leg[1])
