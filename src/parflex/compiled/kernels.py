"""The models as functions of flat vectors: what every backend runs.

A state is x (13 + 2N), forces u (m), external generalised forces w (6 + N).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from parflex import assembly, dynamics
from parflex.array import Array, cross, dot, join, merged, mtv, mv, transpose
from parflex.platform import axial
from parflex.robot import Robot
from parflex.spatial import quaternion_rate
from parflex.state import coordinates, state_size


@dataclass(frozen=True)
class Kernel:
    """A function of flat vectors (…, n_i), with the sizes of its inputs and outputs."""

    name: str
    function: Callable[..., tuple[Array, ...]]
    inputs: tuple[int, ...]
    outputs: tuple[int, ...]


def direct(robot: Robot) -> Kernel:
    """(x, u, w) -> V̇_p, q̈_e, contact forces by tip, leg margins."""
    N, m, k = sizes(robot)

    def function(x: Array, u: Array, w: Array) -> tuple[Array, ...]:
        system = assembly.assemble(robot, coordinates(x, N))
        return (*dynamics.direct_of(robot, system, u, w), assembly.leg_margins(system))

    return Kernel("direct", function, (state_size(N), m, 6 + N), (6, N, k, 2 * len(robot.legs)))


def inverse(robot: Robot, output: dynamics.Output) -> Kernel:
    """(x, target, w) -> Γ, V̇_p, q̈_e, contact forces by tip, gain, J_p⁻ᵀ (by rows), leg margins."""
    N, m, k = sizes(robot)

    def function(x: Array, target: Array, w: Array) -> tuple[Array, ...]:
        system = assembly.assemble(robot, coordinates(x, N))
        found = dynamics.inverse_of(robot, system, target, w, output)
        gain, Jp_invT = (merged(a) for a in (found.gain, found.Jp_invT))
        margins = assembly.leg_margins(system)
        return (found.forces, *found.acceleration, gain, Jp_invT, margins)

    return Kernel(
        "inverse",
        function,
        (state_size(N), output.size, 6 + N),
        (m, 6, N, k, output.size * m, 6 * m, 2 * len(robot.legs)),
    )


def derivative(robot: Robot) -> Kernel:
    """(x, u, w) -> ẋ, powers, leg margins, as in `rate_of`."""
    N, m, _ = sizes(robot)

    def function(x: Array, u: Array, w: Array) -> tuple[Array, ...]:
        return rate_of(robot, assembly.assemble(robot, coordinates(x, N)), x, u, w)

    return Kernel("derivative", function, (state_size(N), m, 6 + N), rate_sizes(robot))


def tracking(robot: Robot, output: dynamics.Output) -> Kernel:
    """(x, wanted 24, gains 12, w) -> Γ, gain and J_p⁻ᵀ (by rows), and `rate_of` under Γ.

    wanted = (p 3, R 9 by rows, V 6, V̇ 6) as in `trajectory.Sample`, gains = (kp 6, kd 6). The
    target is V̇_d + kd (V_d − V) + kp e, all resolved in Σp; the attitude error is the axial part
    of RᵀR_d, which for small angles is their rotation vector. Γ does not know of the loads w.
    """
    N, m, _ = sizes(robot)

    def function(x: Array, wanted: Array, gains: Array, w: Array) -> tuple[Array, ...]:
        now = coordinates(x, N)
        R_d = wanted[..., 3:12].reshape(wanted.shape[:-1] + (3, 3))
        R_pd = np.matmul(transpose(now.rotation), R_d)
        place = mtv(now.rotation, wanted[..., :3] - now.position)
        error = join([place, 0.5 * axial(R_pd)])
        twist, acceleration = (
            join([mv(R_pd, wanted[..., i : i + 3]), mv(R_pd, wanted[..., i + 3 : i + 6])]) for i in (12, 18)
        )
        kp, kd = gains[..., :6], gains[..., 6:]
        target = acceleration + kd * (twist - now.twist) + kp * error
        system = assembly.assemble(robot, now)
        found = dynamics.inverse_of(robot, system, target, np.zeros(6 + N), output)
        gain, Jp_invT = (merged(a) for a in (found.gain, found.Jp_invT))
        return (found.forces, gain, Jp_invT, *rate_of(robot, system, x, found.forces, w))

    return Kernel(
        "tracking",
        function,
        (state_size(N), 24, 12, 6 + N),
        (m, output.size * m, 6 * m, *rate_sizes(robot)),
    )


def rate_of(robot: Robot, system: assembly.System, x: Array, u: Array, w: Array) -> tuple[Array, ...]:
    """ẋ, the powers of actuators, wrenches and damping (a loss), and the leg margins."""
    c = coordinates(x, robot.platform.modes)
    Vd, qdd_e, _ = dynamics.direct_of(robot, system, u, w)
    v_p, omega = c.twist[..., :3], c.twist[..., 3:]
    rate = Vd - join([cross(omega, v_p), np.zeros(3)])
    powers = [
        dot(u, assembly.joint_rates(robot, system)),
        dot(w[..., :6], c.twist) + dot(w[..., 6:], c.elastic_rate),
        dot(c.elastic_rate, robot.platform.damping * c.elastic_rate),
    ]
    moved = join([mv(c.rotation, v_p), quaternion_rate(x[..., 3:7], omega), rate, c.elastic_rate, qdd_e])
    return moved, join([power[..., None] for power in powers]), assembly.leg_margins(system)


def rate_sizes(robot: Robot) -> tuple[int, int, int]:
    """Lengths of what `rate_of` returns."""
    return state_size(robot.platform.modes), 3, 2 * len(robot.legs)


def actuators(robot: Robot) -> Kernel:
    """x -> q_a and q̇_a, positions and rates of the actuated joints."""
    N, m, _ = sizes(robot)

    def function(x: Array) -> tuple[Array, ...]:
        system = assembly.assemble(robot, coordinates(x, N))
        return assembly.actuated_positions(robot, system), assembly.joint_rates(robot, system)

    return Kernel("actuators", function, (state_size(N),), (m, m))


def sizes(robot: Robot) -> tuple[int, int, int]:
    """Modes, forces, and contact force components."""
    return robot.platform.modes, robot.n_forces, 3 * len(robot.tip_attachments)
