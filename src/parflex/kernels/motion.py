"""The motion that forces or a control law cause, with the powers that go with it."""

from collections.abc import Callable

import numpy as np

from parflex.base.array import Array, cross, dot, join, mv
from parflex.base.spatial import quaternion_rate
from parflex.kernels.kernel import Kernel, Vectors, kernel
from parflex.mechanics import chain, dynamics
from parflex.mechanics import system as assembly
from parflex.mechanics.dynamics import Acceleration
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.output import Output
from parflex.mechanics.wrench import Place, pushed

Driven = tuple[Array, Acceleration]  # Γ, and the accelerations under it and the load
ForceLaw = Callable[[assembly.System, Array, Array, Array], Driven]  # of the system, time (…,), row and load


def derivative(mechanism: Mechanism) -> Kernel:
    """ẋ and the powers under given forces and load."""

    def function(x: Array, forces: Array, load: Array) -> Vectors:
        system = assembly.assembled(mechanism, x)
        found = dynamics.direct_of(system, forces, load)
        return motion_of(system, x, forces, load, found) | {"health": assembly.health(system)}

    return kernel("derivative", function, mechanism, ("rate", "powers", "health"))


def motion(
    name: str, mechanism: Mechanism, row: int, law: ForceLaw, places: tuple[Place, ...], *chosen: Output
) -> Kernel:
    """The kernel of the motion under a law: what a simulation integrates.

    `row` (of that length) is what the law reads at a time, load a generalised force, and pushes are the
    wrenches (F, N) at L places of the platform.
    """

    def function(x: Array, time: Array, row: Array, load: Array, pushes: Array) -> Vectors:
        system = assembly.assembled(mechanism, x)
        c = system.x
        load = load + pushed(mechanism.platform.body, places, pushes, c.rotation, c.elastic)
        forces, found = law(system, time[..., 0], row, load)
        answer = {"forces": forces, "contact": found.contact[..., mechanism.contact_order]}
        return answer | motion_of(system, x, forces, load, found) | {"health": assembly.health(system)}

    outputs = ("forces", "rate", "powers", "contact", "health")
    sizes = {"row": row, "pushes": 6 * len(places)}
    return kernel(name, function, mechanism, outputs, (places, *chosen), **sizes)


def motion_of(system: assembly.System, x: Array, forces: Array, load: Array, found: Acceleration) -> Vectors:
    """ẋ by the accelerations found, and the powers of actuators, loads and damping (a loss)."""
    c, mechanism = system.x, system.mechanism
    v_p, omega = c.twist[..., :3], c.twist[..., 3:]
    rate = found.platform - join([cross(omega, v_p), np.zeros(3)])
    lost = dot(c.elastic_rate, mechanism.platform.damping * c.elastic_rate)
    for leg in system.legs:
        lost = lost + np.sum(dot(leg.qd, chain.friction(leg.group.chain, leg.qd)), axis=-1)
    powers = [
        dot(forces, assembly.joint_rates(system)),
        dot(load[..., :6], c.twist) + dot(load[..., 6:], c.elastic_rate),
        lost,
    ]
    turn = quaternion_rate(x[..., mechanism.layout.at.quaternion], omega)
    carried = [c.qd, assembly.carried_accelerations(system, forces, found.contact)]
    fixed = np.zeros(len(mechanism.layout.branched))
    moved = join([mv(c.rotation, v_p), turn, rate, c.elastic_rate, found.elastic, *carried, fixed])
    return {"rate": moved, "powers": join([power[..., None] for power in powers])}
