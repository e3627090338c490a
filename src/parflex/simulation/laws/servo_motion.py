"""The motion under the legs' servos, compiled: references, feed-forward and feedback."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, split
from parflex.kernels.kernel import Kernel
from parflex.kernels.motion import Driven, motion
from parflex.kernels.motion_jacobian import ForceChange, motion_jacobian
from parflex.kernels.segment import SEGMENT, along, resting
from parflex.mechanics import dynamics
from parflex.mechanics import system as assembly
from parflex.mechanics.derivatives.joint_tangent import joint_tangent
from parflex.mechanics.flat_state import flat_state
from parflex.mechanics.held import held
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.wrench import Place
from parflex.robot.layout import Coordinates
from parflex.simulation.laws.joint_pd import joints_ahead


class Reference(NamedTuple):
    """A trajectory as a robot follows it whose soft tips hold the platform, and its actuated joints."""

    system: assembly.System
    acceleration: Array  # V̇_p (…, 6)
    joints: Array  # (…, m), and their rates: at rest those of the robot itself, whose tips sag
    rates: Array
    forces: Array | float  # (…, m), more than the system needs


def servo(mechanism: Mechanism, places: tuple[Place, ...]) -> Kernel:
    """The motion under servos; the row is (segment, start, span, sag, its change, kp m, kd m)."""

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
    sag, kept = np.zeros(2 * sags(mechanism)), np.ones(gains * mechanism.n_forces)
    return np.concatenate([resting(home.position, home.rotation).row, [0.0, 1.0], sag, kept])


def sags(mechanism: Mechanism) -> int:
    """The number of elastic coordinates of platform and legs, and, where tips are soft, of what they change:
    the actuated joints and their forces."""
    return mechanism.platform.modes + held(mechanism).layout.carried + 2 * mechanism.soft * mechanism.n_forces


def parted(mechanism: Mechanism, row: Array) -> list[Array]:
    """A row by its parts: segment, (start, span), sag, its change, kp, kd."""
    n, m = sags(mechanism), mechanism.n_forces
    return split(row, [(SEGMENT,), (2,), (n,), (n,), (m,), (m,)])


def servo_forces(system: assembly.System, t: Array, row: Array) -> tuple[Array, Array]:
    """Γ (…, m) without the integral, and what the joints lack (…, m)."""
    *_, kp, kd = parted(system.mechanism, row)
    wanted = reference(system.mechanism, t, row, system.x.branches)
    ahead, faster = joints_ahead(system, wanted.joints), wanted.rates - assembly.joint_rates(system)
    forward = dynamics.frozen_inverse(wanted.system, wanted.acceleration)[0] + wanted.forces
    return forward + kp * ahead + kd * faster, ahead


def reference(mechanism: Mechanism, t: Array, row: Array, branches: Array) -> Reference:
    """The robot where the trajectory wants it at times (…,).

    Its sag, the bend of platform and legs and what soft tips change, passes from one equilibrium to the next
    as the fifth-order polynomials of moves do. The trajectory is one on a base at rest.
    """
    segment, times, sag, change, _, _ = parted(mechanism, row)
    firm, sample, span, N = held(mechanism), along(segment, t), times[..., 1:], mechanism.platform.modes
    tau = (t[..., None] - times[..., :1]) / span
    left, bends = 1 - tau, N + firm.layout.carried
    part = tau * tau * tau * (10 - 15 * tau + 6 * tau * tau)
    rate = 30 * tau * tau * left * left / span
    pose = sample.position, sample.rotation, sample.twist
    sagged, sagging = sag + part * change, rate * change
    own = sagged[..., :N], sagging[..., :N], sagged[..., N:bends], sagging[..., N:bends]
    place = Coordinates(*pose, *own, branches_of(mechanism, firm, branches, t))
    system = assembly.assemble(replace(firm, base=None), place)
    joints, rates = assembly.actuated_positions(system), assembly.joint_rates(system)
    if not mechanism.soft:
        return Reference(system, sample.acceleration, joints, rates, 0.0)
    further, forces = split(sagged[..., bends:], [(mechanism.n_forces,)] * 2)
    faster, _ = split(sagging[..., bends:], [(mechanism.n_forces,)] * 2)
    return Reference(system, sample.acceleration, joints + further, rates + faster, forces)


def branches_of(mechanism: Mechanism, firm: Mechanism, branches: Array, t: Array) -> Array:
    """The branches of the robot whose soft tips hold: those of the state or, of other legs, those at home."""
    if firm.layout.branched == mechanism.layout.branched:
        return branches
    at_home = flat_state(firm, firm.robot.home)[firm.layout.at.branches]
    return np.broadcast_to(at_home, (*t.shape, len(at_home)))
