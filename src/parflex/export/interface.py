"""Which functions are exported, and their arrays: in the order of the legs, whatever the kernels' own."""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.kernels import models as kernels
from parflex.kernels import motion
from parflex.kernels.kernel import Kernel
from parflex.kernels.projection import projection
from parflex.mechanics.output import Output
from parflex.robot.robot import Robot

OPTIONAL = ("w", "preload")  # inputs that may be NULL, which stands for zeros


class Routine(NamedTuple):
    """A kernel as a C function: the names of its arrays, and what is said of it."""

    kernel: Kernel
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    words: str
    closure: bool = True  # whether a state off the closure is refused

    @property
    def arrays(self) -> list[tuple[str, int]]:
        """Names and lengths of all arrays, inputs first."""
        sizes = (*self.kernel.inputs, *self.kernel.outputs)
        return list(zip((*self.inputs, *self.outputs), sizes, strict=True))


def routines(robot: Robot, output: Output) -> tuple[Routine, ...]:
    """All functions of a robot; the projection where the closure is a condition on its state."""
    found = (
        Routine(
            in_leg_order(kernels.direct(robot), f=2, health=3),
            ("x", "u", "w"),
            ("Vd", "qdd_e", "f", "health"),
            "Direct model: accelerations and contact forces under actuator forces u and loads w.",
        ),
        Routine(
            in_leg_order(kernels.inverse(robot, output), f=3, health=5),
            ("x", "target", "w", "preload"),
            ("u", "Vd", "qdd_e", "f", "gain", "health"),
            "Inverse model: actuator forces for a wanted acceleration, and what goes with them. With "
            "more actuators than rows of the target they are the nearest to preload.",
        ),
        Routine(
            in_leg_order(motion.derivative(robot), health=2),
            ("x", "u", "w"),
            ("xd", "powers", "health"),
            "Derivative of the state in time, for simulation. It does not complain of states off the "
            "closure, which the stages of an integrator are.",
            closure=False,
        ),
    )
    if robot.closed:
        return found
    closing = Routine(
        in_leg_order(projection(robot), health=1),
        ("x",),
        ("projected", "health"),
        "One step of Newton's method from x towards the closure of the legs, in the metric of the robot's "
        "mass. health is that of x; it does not complain of its gaps. Call it after each step of an "
        "integrator, with x as projected, too, until the gaps are small: once or twice.",
        closure=False,
    )
    return (*found, closing)


def in_leg_order(kernel: Kernel, health: int, f: int | None = None) -> Kernel:
    """The kernel with its outputs `health` and `f` in the order of the legs instead of the groups."""
    robot = kernel.subject[0]
    order = {health: health_order(robot)}
    if f is not None:
        order[f] = contact_order(robot)

    def function(*inputs: Array) -> tuple[Array, ...]:
        found = kernel.function(*inputs)
        return tuple(a[..., order[i]] if i in order else a for i, a in enumerate(found))

    return replace(kernel, function=function)


def tips(robot: Robot) -> list[tuple[int, int]]:
    """Leg and attachment of each tip, in the order of the legs."""
    return [(number, tip.attachment) for number, leg in enumerate(robot.legs) for tip in leg.tips]


def contact_order(robot: Robot) -> Array:
    """For each contact force component by leg and tip, its place in the order of the groups."""
    places = {attachment: i for i, attachment in enumerate(robot.tip_attachments.tolist())}
    return triples([places[attachment] for _, attachment in tips(robot)])


def health_order(robot: Robot) -> Array:
    """For each entry of the exported health, its place in the order of `assembly.health`.

    Exported are the reach of all legs, their regularity, the gaps at the tips of legs that do not
    close by themselves, and the rates of the gaps.
    """
    parts_of: list[dict[int, list[int]]] = [{}, {}, {}, {}]
    reach, regular, gap, rate = parts_of
    start = 0
    for group in robot.groups:
        for parts in (reach, regular):
            start = numbered(parts, group.legs, 1, start)
    for group in robot.groups:
        if not group.closed:
            for parts in (gap, rate):
                start = numbered(parts, group.legs, 3 * len(group.tip_frames), start)
    every = [parts[leg] for parts in parts_of for leg in sorted(parts)]
    return np.array([place for part in every for place in part], dtype=int)


def numbered(parts: dict[int, list[int]], legs: Sequence[int], width: int, start: int) -> int:
    """Give each leg `width` places from `start` on; where they end."""
    for i, leg in enumerate(legs):
        parts[leg] = list(range(start + width * i, start + width * (i + 1)))
    return start + width * len(legs)


def triples(places: Sequence[int]) -> Array:
    """The places of the three components of each."""
    return (3 * np.array(places, dtype=int)[:, None] + np.arange(3)).reshape(-1)
