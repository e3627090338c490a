"""The motion that forces or a control law cause, with the powers that go with it."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from parflex.base.array import Array, cross, dot, join, mv
from parflex.base.spatial import quaternion_rate
from parflex.kernels.kernel import Kernel, Vectors, kernel
from parflex.mechanics import dynamics
from parflex.mechanics import system as assembly
from parflex.mechanics.dynamics import Acceleration
from parflex.mechanics.energy import dissipation, rests_power
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.output import Output
from parflex.mechanics.spring_rests import rests_move
from parflex.mechanics.wrench import Place, pushed


class Driven(NamedTuple):
    """The effect of a law: Γ (…, m), the accelerations under it and the load, the rate of its memory."""

    forces: Array
    acceleration: Acceleration
    memory_rate: Array = np.zeros(0)


ForceLaw = Callable[[assembly.System, Array, Array, Array], tuple[Any, ...]]  # of system, time, row and load


def derivative(mechanism: Mechanism) -> Kernel:
    """ẋ and the powers under given forces and load."""

    def function(x: Array, forces: Array, load: Array) -> Vectors:
        system = assembly.assembled(mechanism, x)
        found = dynamics.direct_of(system, forces, load)
        return motion_of(system, x, forces, load, found) | {"health": assembly.health(system)}

    return kernel("derivative", function, mechanism, ("rate", "powers", "health"))


def motion(
    name: str,
    mechanism: Mechanism,
    row: int,
    law: ForceLaw,
    places: tuple[Place, ...],
    *chosen: Output,
    memory: int = 0,
    example: Array | None = None,
) -> Kernel:
    """The kernel of the motion under a law: what a simulation integrates.

    `row` (of that length) is what the law reads at a time, load a generalised force, and pushes are the
    wrenches (F, N) at L places of the platform. The law's memory, so many numbers, stands behind the state
    in x; the law reads it behind its row. `example` is a row, where any numbers would make no sense.
    """
    size = mechanism.layout.size

    def function(x: Array, time: Array, row: Array, load: Array, pushes: Array) -> Vectors:
        x, remembered = x[..., :size], x[..., size:]
        system = assembly.assembled(mechanism, x)
        c = system.x
        load = load + pushed(mechanism.platform.body, places, pushes, c.rotation, c.elastic)
        forces, found, memory_rate = Driven(*law(system, time[..., 0], join([row, remembered]), load))
        moved = motion_of(system, x, forces, load, found)
        moved["rate"] = join([moved["rate"], memory_rate])
        contact = assembly.tip_forces(system, found.contact)[..., mechanism.contact_order]
        return {"forces": forces, "contact": contact} | moved | {"health": assembly.health(system)}

    outputs = ("forces", "rate", "powers", "contact", "health")
    sizes = {"row": row, "pushes": 6 * len(places), "x": size + memory, "rate": size + memory}
    made = kernel(name, function, mechanism, outputs, (places, *chosen), **sizes)
    return made if example is None else replace(made, near={"row": example})


def motion_of(system: assembly.System, x: Array, forces: Array, load: Array, found: Acceleration) -> Vectors:
    """ẋ by the accelerations found, and the powers of actuators, loads, damping (a loss), and of a floor and
    of rests that move."""
    c, mechanism = system.x, system.mechanism
    v_p, omega = c.twist[..., :3], c.twist[..., 3:]
    rate = found.platform - join([cross(omega, v_p), np.zeros(3)])
    powers = [
        dot(forces, assembly.joint_rates(system)),
        dot(load[..., :6], c.twist) + dot(load[..., 6:], c.elastic_rate),
        dissipation(system),
    ]
    if mechanism.base is not None:
        zdd = assembly.leg_accelerations(system, forces, found.contact)
        powers.append(assembly.floor_power(system, zdd, found.contact))
    if rests_move(mechanism):
        powers.append(rests_power(system))
    turn = quaternion_rate(x[..., mechanism.layout.at.quaternion], omega)
    carried = [c.sd, assembly.carried_accelerations(system, forces, found.contact)]
    fixed = np.zeros(len(mechanism.layout.branched))
    moved = join([mv(c.rotation, v_p), turn, rate, c.elastic_rate, found.elastic, *carried, fixed])
    return {"rate": moved, "powers": join([power[..., None] for power in powers])}
