"""The derivative of the motion under a law: what an implicit integrator asks for.

It is exact, by way of the small motions of `tangent.py`, for robots whose state carries no joints.
"""

from collections.abc import Callable

import numpy as np

from parflex.base.array import Array, block, merged, skew, stack
from parflex.base.spatial import quaternion_rate
from parflex.kernels.jacobians import load_of
from parflex.kernels.kernel import Kernel, sizes
from parflex.mechanics import system as assembly
from parflex.mechanics.derivatives import sensitivity
from parflex.mechanics.wrench import Place
from parflex.robot.layout import Coordinates
from parflex.robot.robot import Robot

ForceChange = tuple[Array, Array]  # Γ (…, m), and its derivative (…, m, 12 + 2 N) by the small motions
Drive = Callable[[assembly.System, Array, Array], ForceChange]  # of the system, time (…,) and row


def motion_jacobian(motion: Kernel, places: tuple[Place, ...], drive: Drive) -> Kernel:
    """The kernel of ∂ẋ/∂x by rows; it reads what the motion reads, whose forces are those of `drive`."""
    robot: Robot = motion.subject[0]
    n = sizes(robot)[0]

    def function(x: Array, t: Array, row: Array, w: Array, pushes: Array) -> tuple[Array, ...]:
        system, load = assembly.assembled(robot, x), load_of(robot, places, w, pushes)
        u, by_motion = drive(system, t[..., 0], row)
        at = sensitivity.solved(robot, system, u, load(system.x))
        accelerations = sensitivity.by_state(robot, system, at, load, at.JAS @ by_motion)
        rates = [
            place_rate(system.x),
            accelerations[..., :6, :] - drift(system.x),
            bending_rate(system.x),
            accelerations[..., 6:, :],
        ]
        place, *rest = (by_flat_state(x, rows) for rows in rates)
        return (merged(block([[part] for part in (place, turn_rate(x), *rest)])),)

    return Kernel(f"{motion.name}_jacobian", function, motion.inputs, (n * n,), motion.subject)


def by_flat_state(x: Array, rows: Array) -> Array:
    """Rows (…, r, 12 + 2 N) by the small motions, turned into rows (…, r, 13 + 2 N) by the flat state.

    δθ = 2 Im(q̄ δq) / |q|².
    """
    w, v = x[..., 3:4], x[..., 4:7]
    turned = block([[-v[..., None], w[..., None] * np.eye(3) - skew(v)]])
    length = np.sum(x[..., 3:7] * x[..., 3:7], axis=-1)
    by_quaternion = rows[..., 3:6] @ (2.0 * turned / length[..., None, None])
    return block([[rows[..., :3], by_quaternion, rows[..., 6:]]])


def turn_rate(x: Array) -> Array:
    """∂ of the quaternion's rate (…, 4, 13 + 2 N)."""
    quaternion, omega = x[..., 3:7], x[..., 10:13]
    by_quaternion = stack([quaternion_rate(e, omega) for e in np.eye(4)])
    by_omega = stack([quaternion_rate(quaternion, e) for e in np.eye(3)])
    still = np.zeros((4, x.shape[-1] - 13))
    return block([[np.zeros((4, 3)), by_quaternion, np.zeros((4, 3)), by_omega, still]])


def place_rate(x: Coordinates) -> Array:
    """∂(R v_p) (…, 3, 12 + 2 N)."""
    still, N = np.zeros((3, 3)), x.elastic.shape[-1]
    turned = -x.rotation @ skew(x.twist[..., :3])
    return block([[still, turned, x.rotation, still, np.zeros((3, 2 * N))]])


def drift(x: Coordinates) -> Array:
    """∂(ω × v_p, 0) (…, 6, 12 + 2 N): the rate that the components of v_p lose as Σp turns."""
    v_p, omega = x.twist[..., :3], x.twist[..., 3:]
    none, N = np.zeros((3, 3)), x.elastic.shape[-1]
    change = block([[skew(omega), -skew(v_p)], [none, none]])
    return block([[np.zeros((6, 6)), change, np.zeros((6, 2 * N))]])


def bending_rate(x: Coordinates) -> Array:
    """∂q̇_e (N, 12 + 2 N)."""
    N = x.elastic.shape[-1]
    return np.eye(12 + 2 * N)[12 + N :]
