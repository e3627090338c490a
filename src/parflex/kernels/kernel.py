"""Kernels: functions of named flat vectors, which every backend can run."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from inspect import signature
from typing import Any

import numpy as np

from parflex.base.array import Array
from parflex.mechanics.flat_state import flat_state
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.spring_rests import rests_move

Vectors = dict[str, Array]

SMALL = 1e-2  # how far inputs lie from what they are near to, where a kernel is tried


@dataclass(frozen=True)
class Kernel:
    """A function of named flat vectors (…, n_i) that gives named flat vectors, with their lengths.

    It is determined by its name and its subject, the robot and what else was chosen; the first input is `x`,
    a flat state of the robot, behind which more may stand. Inputs that a caller does not give are zero.
    """

    name: str
    function: Callable[..., Vectors]
    inputs: Mapping[str, int]
    outputs: Mapping[str, int]
    mechanism: Mechanism
    chosen: tuple[Any, ...] = ()
    near: Mapping[str, Array] = field(default_factory=dict)  # inputs about which it is tried; of others zero

    @property
    def subject(self) -> tuple[Any, ...]:
        """The robot and what else determines the function, down to how its legs and contacts are computed."""
        mechanism = self.mechanism
        ways: list[Any] = [type(group.type) for group in mechanism.groups]
        ways += [mechanism.elimination] if mechanism.elimination else []
        return (mechanism.robot, [f"{way.__module__}.{way.__qualname__}" for way in ways], *self.chosen)

    def probe(self, count: int) -> Vectors:
        """Inputs (count, n_i) near home, in motion, to try an implementation on."""
        rng, mechanism = np.random.default_rng(0), self.mechanism
        home, at = flat_state(mechanism, mechanism.robot.home), mechanism.layout.at
        place = np.arange(len(home))
        moving = (place >= at.twist.start) & (place < at.branches.start)
        x = home + np.where(moving, 1e-3, 0.0) * rng.normal(size=(count, len(home)))
        more = np.zeros((count, self.inputs["x"] - len(home)))
        others = {name: n for name, n in self.inputs.items() if name != "x"}
        tried = {name: rng.uniform(-1, 1, (count, n)) for name, n in others.items()}
        tried |= {name: at + SMALL * tried[name] for name, at in self.near.items()}
        return {"x": np.concatenate([x, more], axis=-1), **tried}


def kernel(
    name: str,
    function: Callable[..., Vectors],
    mechanism: Mechanism,
    outputs: Sequence[str],
    chosen: tuple[Any, ...] = (),
    **sizes: int,
) -> Kernel:
    """The kernel of a function whose parameters bear the names of its inputs.

    Lengths are those of `lengths`, and `sizes` for names that only this kernel has.
    """
    known = lengths(mechanism) | sizes
    inputs = {each: known[each] for each in signature(function).parameters}
    return Kernel(name, function, inputs, {each: known[each] for each in outputs}, mechanism, chosen)


def lengths(mechanism: Mechanism) -> dict[str, int]:
    """The lengths of vectors that several kernels read or give."""
    n, N, m = mechanism.layout.size, mechanism.platform.modes, mechanism.n_forces
    return {
        "x": n,  # the flat state
        "forces": m,  # Γ of the actuators
        "load": 6 + N,  # a generalised force on the platform
        "time": 1,
        "preload": m,  # forces that Γ is to be near to
        "platform": 6,  # V̇_p
        "elastic": N,  # q̈_e
        "contact": 3 * len(mechanism.attachments),  # contact forces by leg and tip
        "health": mechanism.health.size,  # as `system.health`
        "rate": n,  # ẋ
        # of actuators, loads, damping and friction, the floor, rests that move
        "powers": 3 + (mechanism.base is not None) + rests_move(mechanism),
        "positions": m,  # q_a of the actuated joints
        "rates": m,  # q̇_a
        "accelerations": m,  # q̈_a
    }
