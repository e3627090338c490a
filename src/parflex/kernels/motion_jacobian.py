"""The derivative of the motion under a law: what an implicit integrator asks for.

It is exact, by way of the small motions of `Layout.motions`.
"""

from collections.abc import Callable

import numpy as np

from parflex.base.array import Array, block, merged, skew, stack
from parflex.base.spatial import quaternion_rate
from parflex.kernels.jacobians import load_of
from parflex.kernels.kernel import Kernel, Vectors, kernel
from parflex.mechanics import system as assembly
from parflex.mechanics.derivatives import sensitivity
from parflex.mechanics.wrench import Place
from parflex.robot.layout import Coordinates, Layout

ForceChange = tuple[Array, Array]  # Γ (…, m), and its derivative (…, m, 12 + 2 N + 2 n) by the small motions
Drive = Callable[[assembly.System, Array, Array], ForceChange]  # of the system, time (…,) and row


def motion_jacobian(motion: Kernel, places: tuple[Place, ...], drive: Drive) -> Kernel:
    """The kernel of ∂ẋ/∂x by rows; it reads what the motion reads, whose forces are those of `drive`."""
    mechanism = motion.mechanism
    layout, n, bent = mechanism.layout, mechanism.layout.size, 6 + mechanism.platform.modes

    def function(x: Array, time: Array, row: Array, load: Array, pushes: Array) -> Vectors:
        system, held = assembly.assembled(mechanism, x), load_of(mechanism, places, load, pushes)
        forces, by_motion = drive(system, time[..., 0], row)
        at = sensitivity.solved(system, forces, held(system.x))
        accelerations = sensitivity.by_state(system, at, held, by_motion)
        unit, motions = np.eye(layout.motion_size), layout.motions
        rates = [
            place_rate(layout, system.x),
            accelerations[..., :6, :] - drift(layout, system.x),
            unit[motions.elastic_rate],
            accelerations[..., 6:bent, :],
            unit[motions.joint_rates],
            accelerations[..., bent:, :],
        ]
        place, *rest = (by_flat_state(layout, x, rows) for rows in rates)
        fixed = np.zeros((len(layout.branched), n))
        return {"slopes": merged(block([[part] for part in (place, turn_rate(layout, x), *rest, fixed)]))}

    name, sizes = f"{motion.name}_jacobian", {**motion.inputs, "slopes": n * n}
    return kernel(name, function, mechanism, ("slopes",), motion.chosen, **sizes)


def by_flat_state(layout: Layout, x: Array, rows: Array) -> Array:
    """Rows (…, r, M) by the small motions, turned into rows (…, r, size) by the flat state.

    δθ = 2 Im(q̄ δq) / |q|².
    """
    quaternion, motions = x[..., layout.at.quaternion], layout.motions
    w, v = quaternion[..., :1], quaternion[..., 1:]
    turned = block([[-v[..., None], w[..., None] * np.eye(3) - skew(v)]])
    length = np.sum(quaternion * quaternion, axis=-1)
    by_quaternion = rows[..., motions.rotation] @ (2.0 * turned / length[..., None, None])
    fixed = np.zeros((rows.shape[-2], len(layout.branched)))
    rest = rows[..., motions.velocity.start :]
    return block([[rows[..., motions.position], by_quaternion, rest, fixed]])


def turn_rate(layout: Layout, x: Array) -> Array:
    """∂ of the quaternion's rate (…, 4, size)."""
    quaternion, omega = x[..., layout.at.quaternion], x[..., layout.at.twist][..., 3:]
    by_quaternion = stack([quaternion_rate(e, omega) for e in np.eye(4)])
    by_omega = stack([quaternion_rate(quaternion, e) for e in np.eye(3)])
    still = np.zeros((4, layout.size - layout.at.twist.stop))
    return block([[np.zeros((4, 3)), by_quaternion, np.zeros((4, 3)), by_omega, still]])


def place_rate(layout: Layout, x: Coordinates) -> Array:
    """∂(R v_p) (…, 3, M)."""
    turned = -x.rotation @ skew(x.twist[..., :3])
    still = np.zeros((3, layout.motion_size - layout.motions.velocity.stop))
    return block([[np.zeros((3, 3)), turned, x.rotation, still]])


def drift(layout: Layout, x: Coordinates) -> Array:
    """∂(ω × v_p, 0) (…, 6, M): the rate that the components of v_p lose as Σp turns."""
    v_p, omega = x.twist[..., :3], x.twist[..., 3:]
    none, still = np.zeros((3, 3)), np.zeros((6, layout.motion_size - layout.motions.omega.stop))
    change = block([[skew(omega), -skew(v_p)], [none, none]])
    return block([[np.zeros((6, 6)), change, still]])
