"""Control laws with the motion they cause, each one function: what a simulation integrates.

All read (x, t 1, row, w 6 + N, pushes 6 L), with `row` what the law reads at that time, w a
generalised force, and pushes the wrenches (F, N) at some places of the platform; and give
(Γ, ẋ, powers, contact forces by tip, health) as in `kernels.motion_of`. The law reckons with no load.
"""

from collections.abc import Callable

import numpy as np

from parflex.base.array import Array, join, mtv, mv, transpose
from parflex.kernels.kernel import Kernel, sizes
from parflex.kernels.motion import motion_of
from parflex.kernels.segment import SEGMENT, along
from parflex.mechanics import dynamics
from parflex.mechanics import system as assembly
from parflex.mechanics.dynamics import Acceleration
from parflex.mechanics.output import Output
from parflex.mechanics.platform import axial
from parflex.mechanics.wrench import Place, pushed
from parflex.robot.layout import Coordinates
from parflex.robot.robot import Robot

GAINS = 12  # kp 6, kd 6
Places = tuple[Place, ...]
Answer = tuple[Array, Acceleration]  # Γ, and what moves under it and the load
Law = Callable[[assembly.System, Array, Array, Array], Answer]  # of the system, time (…,), row and load


def steady(robot: Robot, places: Places) -> Kernel:
    """Forces as they stand in the row (m)."""

    def law(system: assembly.System, t: Array, row: Array, load: Array) -> Answer:
        return row, dynamics.direct_of(robot, system, row, load)

    return motion("steady", robot, robot.n_forces, law, places)


def springs(robot: Robot, places: Places) -> Kernel:
    """Springs and dampers on the actuated joints; the row is (Γ_0 m, kp m, kd m, reference m).

    Angles are known up to full turns.
    """

    def law(system: assembly.System, t: Array, row: Array, load: Array) -> Answer:
        u = spring_forces(robot, system, row)
        return u, dynamics.direct_of(robot, system, u, load)

    return motion("springs", robot, 4 * robot.n_forces, law, places)


def spring_forces(robot: Robot, system: assembly.System, row: Array) -> Array:
    """Γ (…, m) of springs and dampers."""
    slides = np.array([joint.sigma for leg in robot.legs for joint in leg.joints if joint.mu])
    preload, kp, kd, wanted = quarters(row)
    ahead = wanted - assembly.actuated_positions(robot, system)
    turned = np.arctan2(np.sin(ahead), np.cos(ahead))
    ahead = slides * ahead + (1 - slides) * turned
    return preload + kp * ahead - kd * assembly.joint_rates(robot, system)


def quarters(row: Array) -> list[Array]:
    """Γ_0, kp, kd and the reference (…, m) in a row of springs."""
    m = row.shape[-1] // 4
    return [row[..., i * m : (i + 1) * m] for i in range(4)]


def tracking(robot: Robot, output: Output, places: Places) -> Kernel:
    """Computed torque along a trajectory; the row is (segment 21, gains 12, preload m).

    The wanted motion is that of `segment.along`, gains are (kp 6, kd 6). The target is
    V̇_d + kd (V_d − V) + kp e, all resolved in Σp, of which the output takes its rows; the attitude
    error is the axial part of RᵀR_d, which for small angles is their rotation vector.
    """

    def law(system: assembly.System, t: Array, row: Array, load: Array) -> Answer:
        target, preload = tracked(system.x, t, row, output), row[..., SEGMENT + GAINS :]
        none = np.zeros(6 + robot.platform.modes)
        found = dynamics.inverse_of(robot, system, target, none, output, preload, unforeseen=load)
        return found.forces, found.acceleration

    return motion("tracking", robot, SEGMENT + GAINS + robot.n_forces, law, places, output)


def tracked(now: Coordinates, t: Array, row: Array, output: Output) -> Array:
    """The target (…, o) of computed torque at times (…,)."""
    wanted, gains = along(row[..., :SEGMENT], t), row[..., SEGMENT : SEGMENT + GAINS]
    R_pd = np.matmul(transpose(now.rotation), wanted.rotation)
    place = mtv(now.rotation, wanted.position - now.position)
    error = join([place, 0.5 * axial(R_pd)])
    twist, acceleration = (
        join([mv(R_pd, part[..., :3]), mv(R_pd, part[..., 3:])])
        for part in (wanted.twist, wanted.acceleration)
    )
    kp, kd = gains[..., :6], gains[..., 6:]
    return (acceleration + kd * (twist - now.twist) + kp * error)[..., list(output.axes)]


def motion(name: str, robot: Robot, row_size: int, law: Law, places: Places, *chosen: Output) -> Kernel:
    """The kernel of a law."""
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
