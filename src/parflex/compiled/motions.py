"""Control laws with the motion they cause, each one function: what a simulation integrates.

All read (x, t 1, row, w 6 + N, pushes 6 L), with `row` what the law reads at that time, w a
generalised force, and pushes the wrenches (F, N) at some places of the platform; and give
(Γ, ẋ, powers, contact forces by tip, health) as in `kernels.motion_of`. The law knows of no load.
"""

from collections.abc import Callable

import numpy as np

from parflex import assembly, dynamics
from parflex.array import Array, join, mtv, mv, transpose
from parflex.compiled.kernels import Kernel, motion_of, sizes
from parflex.output import Output
from parflex.platform import axial
from parflex.robot import Robot
from parflex.segment import SEGMENT, along
from parflex.wrench import Place, pushed

GAINS = 12  # kp 6, kd 6
Places = tuple[Place, ...]
Forces = Callable[[assembly.System, Array, Array], Array]  # of the system, the time (…,) and the row


def steady(robot: Robot, places: Places) -> Kernel:
    """Forces as they stand in the row (m)."""
    return motion("steady", robot, robot.n_forces, lambda system, t, row: row, places)


def springs(robot: Robot, places: Places) -> Kernel:
    """Springs and dampers on the actuated joints; the row is (Γ_0 m, kp m, kd m, reference m).

    Angles are known up to full turns.
    """
    m = robot.n_forces
    slides = np.array([joint.sigma for leg in robot.legs for joint in leg.joints if joint.mu])

    def forces(system: assembly.System, t: Array, row: Array) -> Array:
        preload, kp, kd, wanted = (row[..., i * m : (i + 1) * m] for i in range(4))
        ahead = wanted - assembly.actuated_positions(robot, system)
        turned = np.arctan2(np.sin(ahead), np.cos(ahead))
        ahead = slides * ahead + (1 - slides) * turned
        return preload + kp * ahead - kd * assembly.joint_rates(robot, system)

    return motion("springs", robot, 4 * m, forces, places)


def tracking(robot: Robot, output: Output, places: Places) -> Kernel:
    """Computed torque along a trajectory; the row is (segment 21, gains 12, preload m).

    The wanted motion is that of `segment.along`, gains are (kp 6, kd 6). The target is
    V̇_d + kd (V_d − V) + kp e, all resolved in Σp, of which the output takes its rows; the attitude
    error is the axial part of RᵀR_d, which for small angles is their rotation vector.
    """

    def forces(system: assembly.System, t: Array, row: Array) -> Array:
        wanted, now = along(row[..., :SEGMENT], t), system.x
        gains, preload = row[..., SEGMENT : SEGMENT + GAINS], row[..., SEGMENT + GAINS :]
        R_pd = np.matmul(transpose(now.rotation), wanted.rotation)
        place = mtv(now.rotation, wanted.position - now.position)
        error = join([place, 0.5 * axial(R_pd)])
        twist, acceleration = (
            join([mv(R_pd, part[..., :3]), mv(R_pd, part[..., 3:])])
            for part in (wanted.twist, wanted.acceleration)
        )
        kp, kd = gains[..., :6], gains[..., 6:]
        target = (acceleration + kd * (twist - now.twist) + kp * error)[..., list(output.axes)]
        none = np.zeros(6 + robot.platform.modes)
        return dynamics.inverse_of(robot, system, target, none, output, preload).forces

    return motion("tracking", robot, SEGMENT + GAINS + robot.n_forces, forces, places, output)


def motion(name: str, robot: Robot, row_size: int, forces: Forces, places: Places, *chosen: Output) -> Kernel:
    """The kernel of a law that is given by its forces."""
    n, N, m, k = sizes(robot)

    def function(x: Array, t: Array, row: Array, w: Array, pushes: Array) -> tuple[Array, ...]:
        system = assembly.assembled(robot, x)
        c = system.x
        u = forces(system, t[..., 0], row)
        load = w + pushed(robot.platform, places, pushes, c.rotation, c.elastic)
        return (u, *motion_of(robot, system, x, u, load), assembly.health(system))

    inputs = (n, 1, row_size, 6 + N, 6 * len(places))
    outputs = (m, n, 3, k, assembly.health_size(robot))
    return Kernel(name, function, inputs, outputs, (robot, places, *chosen))
