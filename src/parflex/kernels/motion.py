"""The motion that forces or a control law cause, with the powers that go with it."""

from collections.abc import Callable

import numpy as np

from parflex.base.array import Array, cross, dot, join, mv
from parflex.base.spatial import quaternion_rate
from parflex.kernels.kernel import Kernel, sizes
from parflex.mechanics import chain, dynamics
from parflex.mechanics import system as assembly
from parflex.mechanics.dynamics import Acceleration
from parflex.mechanics.output import Output
from parflex.mechanics.wrench import Place, pushed
from parflex.robot.robot import Robot

Answer = tuple[Array, Acceleration]  # Γ, and the accelerations under it and the load
ForceLaw = Callable[[assembly.System, Array, Array, Array], Answer]  # of the system, time (…,), row and load


def derivative(robot: Robot) -> Kernel:
    """(x, u, w) -> ẋ, powers, health, as in `motion_of`."""
    n, N, m, _ = sizes(robot)

    def function(x: Array, u: Array, w: Array) -> tuple[Array, ...]:
        system = assembly.assembled(robot, x)
        moved, powers = motion_of(robot, system, x, u, w, dynamics.direct_of(robot, system, u, w))
        return moved, powers, assembly.health(system)

    return Kernel("derivative", function, (n, m, 6 + N), (n, 3, assembly.health_size(robot)), (robot,))


def motion(
    name: str, robot: Robot, row_size: int, law: ForceLaw, places: tuple[Place, ...], *chosen: Output
) -> Kernel:
    """The kernel of the motion under a law: what a simulation integrates.

    It reads (x, t 1, row, w 6 + N, pushes 6 L): `row` is what the law reads at that time, w a generalised
    force, and pushes are the wrenches (F, N) at L places of the platform. It gives (Γ, ẋ, powers, contact
    forces by tip, health) as `motion_of`.
    """
    n, N, m, k = sizes(robot)

    def function(x: Array, t: Array, row: Array, w: Array, pushes: Array) -> tuple[Array, ...]:
        system = assembly.assembled(robot, x)
        c = system.x
        load = w + pushed(robot.platform, places, pushes, c.rotation, c.elastic)
        u, found = law(system, t[..., 0], row, load)
        moved, powers = motion_of(robot, system, x, u, load, found)
        return u, moved, powers, found.contact, assembly.health(system)

    inputs = (n, 1, row_size, 6 + N, 6 * len(places))
    outputs = (m, n, 3, k, assembly.health_size(robot))
    return Kernel(name, function, inputs, outputs, (robot, places, *chosen))


def motion_of(
    robot: Robot, system: assembly.System, x: Array, u: Array, w: Array, found: Acceleration
) -> tuple[Array, Array]:
    """ẋ by the accelerations found, and the powers of actuators, wrenches and damping (a loss)."""
    c = system.x
    v_p, omega = c.twist[..., :3], c.twist[..., 3:]
    rate = found.platform - join([cross(omega, v_p), np.zeros(3)])
    lost = dot(c.elastic_rate, robot.platform.damping * c.elastic_rate)
    for leg in system.legs:
        lost = lost + np.sum(dot(leg.qd, chain.friction(leg.group.chain, leg.qd)), axis=-1)
    powers = [
        dot(u, assembly.joint_rates(robot, system)),
        dot(w[..., :6], c.twist) + dot(w[..., 6:], c.elastic_rate),
        lost,
    ]
    turn = quaternion_rate(x[..., 3:7], omega)
    carried = [c.qd, assembly.carried_accelerations(robot, system, u, found.contact)]
    moved = join([mv(c.rotation, v_p), turn, rate, c.elastic_rate, found.elastic, *carried])
    return moved, join([power[..., None] for power in powers])
