"""The motion that forces cause, with the powers that go with it."""

import numpy as np

from parflex.base.array import Array, cross, dot, join, mv
from parflex.base.spatial import quaternion_rate
from parflex.kernels.kernel import Kernel, sizes
from parflex.mechanics import chain, dynamics
from parflex.mechanics import system as assembly
from parflex.robot.robot import Robot


def derivative(robot: Robot) -> Kernel:
    """(x, u, w) -> ẋ, powers, health, as in `motion_of`."""
    n, N, m, _ = sizes(robot)

    def function(x: Array, u: Array, w: Array) -> tuple[Array, ...]:
        system = assembly.assembled(robot, x)
        moved, powers = motion_of(robot, system, x, u, w, dynamics.direct_of(robot, system, u, w))
        return moved, powers, assembly.health(system)

    return Kernel("derivative", function, (n, m, 6 + N), (n, 3, assembly.health_size(robot)), (robot,))


def motion_of(
    robot: Robot, system: assembly.System, x: Array, u: Array, w: Array, found: dynamics.Acceleration
) -> tuple[Array, Array]:
    """ẋ of what the direct model found, and the powers of actuators, wrenches and damping (a loss)."""
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
