"""The motion under the legs' servos, compiled: references, feed-forward and feedback."""

from dataclasses import replace

import numpy as np

from parflex.base.array import Array, split
from parflex.kernels.kernel import Kernel
from parflex.kernels.motion import Driven, motion
from parflex.kernels.motion_jacobian import ForceChange, motion_jacobian
from parflex.kernels.segment import SEGMENT, along, resting
from parflex.mechanics import dynamics
from parflex.mechanics import system as assembly
from parflex.mechanics.derivatives.joint_tangent import joint_tangent
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.wrench import Place
from parflex.robot.layout import Coordinates
from parflex.simulation.laws.joint_pd import joints_ahead


def servo(mechanism: Mechanism, places: tuple[Place, ...]) -> Kernel:
    """The motion under servos; the row is (segment, start, span, bend, its change, kp m, kd m)."""

    def law(system: assembly.System, t: Array, row: Array, load: Array) -> Driven:
        u, _ = servo_forces(system, t, row)
        return Driven(u, dynamics.direct_of(system, u, load))

    example = example_row(mechanism, 2)
    return motion("servo", mechanism, len(example), law, places, example=example)


def servo_with_integral(mechanism: Mechanism, places: tuple[Place, ...]) -> Kernel:
    """The motion under servos that remember ∫ e dt (m); the row is that of `servo`, and ki m."""
    m = mechanism.n_forces

    def law(system: assembly.System, t: Array, row: Array, load: Array) -> Driven:
        u, ahead = servo_forces(system, t, row[..., : -2 * m])
        u = u + row[..., -2 * m : -m] * row[..., -m:]
        return Driven(u, dynamics.direct_of(system, u, load), ahead)

    example = example_row(mechanism, 3)
    return motion("servo_with_integral", mechanism, len(example), law, places, memory=m, example=example)


def servo_jacobian(mechanism: Mechanism, places: tuple[Place, ...]) -> Kernel:
    """The derivative of the motion under servos without an integral."""

    def drive(system: assembly.System, t: Array, row: Array) -> ForceChange:
        *_, kp, kd = parted(mechanism, row)
        tangent = joint_tangent(system)
        change = -kp[..., None] * tangent.positions - kd[..., None] * tangent.rates
        return servo_forces(system, t, row)[0], change

    return motion_jacobian(servo(mechanism, places), places, drive)


def example_row(mechanism: Mechanism, gains: int) -> Array:
    """A row that rests at home, with so many gains for each actuator."""
    home = mechanism.robot.home
    bend, kept = np.zeros(2 * bends(mechanism)), np.ones(gains * mechanism.n_forces)
    return np.concatenate([resting(home.position, home.rotation).row, [0.0, 1.0], bend, kept])


def bends(mechanism: Mechanism) -> int:
    """The number of elastic coordinates, of platform and legs, where no joints are carried."""
    return mechanism.platform.modes + mechanism.layout.carried


def parted(mechanism: Mechanism, row: Array) -> list[Array]:
    """A row by its parts: segment, (start, span), bend, its change, kp, kd."""
    N, m = bends(mechanism), mechanism.n_forces
    return split(row, [(SEGMENT,), (2,), (N,), (N,), (m,), (m,)])


def servo_forces(system: assembly.System, t: Array, row: Array) -> tuple[Array, Array]:
    """Γ (…, m) without the integral, and what the joints lack (…, m)."""
    *_, kp, kd = parted(system.mechanism, row)
    wanted, acceleration = reference(system.mechanism, t, row, system.x.branches)
    ahead = joints_ahead(system, assembly.actuated_positions(wanted))
    faster = assembly.joint_rates(wanted) - assembly.joint_rates(system)
    return dynamics.frozen_inverse(wanted, acceleration)[0] + kp * ahead + kd * faster, ahead


def reference(mechanism: Mechanism, t: Array, row: Array, branches: Array) -> tuple[assembly.System, Array]:
    """The robot where the trajectory wants it at times (…,), and the wanted V̇_p (…, 6).

    The bend of platform and legs passes from one sagging equilibrium to the next as the fifth-order
    polynomials of moves do. The trajectory is one on a base at rest.
    """
    segment, times, bend, change, _, _ = parted(mechanism, row)
    sample, span, N = along(segment, t), times[..., 1:], mechanism.platform.modes
    tau = (t[..., None] - times[..., :1]) / span
    left = 1 - tau
    part = tau * tau * tau * (10 - 15 * tau + 6 * tau * tau)
    rate = 30 * tau * tau * left * left / span
    pose = sample.position, sample.rotation, sample.twist
    bent, bending = bend + part * change, rate * change
    own = bent[..., :N], bending[..., :N], bent[..., N:], bending[..., N:]
    place = Coordinates(*pose, *own, branches)
    return assembly.assemble(replace(mechanism, base=None), place), sample.acceleration
