"""Gains of the legs' servos: those that suit the robot, and whether they are stable when sampled."""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.model.core import Core

ZETA = 0.7  # the damping ratio of a servo's default
PARTS = 0.9 ** np.arange(1, 130)  # of a frequency, down to a millionth
SERVO = 2 * np.pi * 20.0  # rad/s, its frequency where the platform does not bend too easily


class Gains(NamedTuple):
    """kp and kd (m,) of servos."""

    kp: Array
    kd: Array


def default_gains(core: Core) -> Gains:
    """Gains that give each leg ζ = 0.7 at 20 Hz, or at half the lowest elastic frequency if that is lower.

    The frequency is that of a mode of the robot with locked legs. A leg's effective mass is the force that
    accelerates its joint by one unit while the other motors are free and the platform does not bend,
    1 / (∂q̈_a/∂Γ)_ii: the mean square of the closed loop's frequencies then is the square of the servo's.
    """
    motions = core.at_home
    mass = 1.0 / np.diag(motions.joint_mobility())
    omega = min(SERVO, 0.5 * lowest(motions.locked_poles()))
    return Gains(mass * omega**2, 2 * ZETA * omega * mass)


def lowest(poles: Array) -> float:
    """The lowest frequency rad/s of poles that oscillate; infinite where none do."""
    swinging = np.abs(poles[np.abs(poles.imag) > 1e-3 * np.abs(poles.real)])
    return float(np.min(swinging, initial=np.inf))


def check_sampled(core: Core, kp: Array, kd: Array, ki: Array, rate: float) -> None:
    """Raise InputError for gains (m,) that are unstable at samples of `rate` Hz though nothing bends.

    The forces are held from sample to sample, of joints and rates that are measured without delay.
    """
    mobility = core.at_home.joint_mobility()

    def radius(part: float) -> float:
        return sampled_radius(mobility, part**2 * kp, part * kd, part**3 * ki, 1.0 / rate)

    if radius(1.0) <= 1.0 + 1e-9:
        return
    where = f"at {rate:g} samples a second the legs' servos are unstable, even if nothing bends"
    part = next((part for part in PARTS if radius(part) <= 1.0), None)
    if part is None:
        raise InputError(f"kd is too low beside kp and ki: {where}; raise it, or leave the gains out")
    raise InputError(
        f"kp, kd or ki is too high: {where}; take {part**2:.2g} times kp and {part:.2g} times kd, or name "
        f"the rate (Hz) of a faster controller"
    )


def sampled_radius(mobility: Array, kp: Array, kd: Array, ki: Array, T: float) -> float:
    """The largest |z| of q̈ = mobility Γ, Γ = −kp q − kd q̇ − ki Σ q T, held for T s at a time."""
    one, none = np.eye(len(kp)), np.zeros((len(kp), len(kp)))
    free = np.block([[one, T * one, none], [none, one, none], [T * one, none, one]])
    pushed = np.vstack([0.5 * T**2 * mobility, T * mobility, none])
    closed = free - pushed @ np.hstack([np.diag(kp), np.diag(kd), np.diag(ki)])
    if not np.any(ki):
        closed = closed[: 2 * len(kp), : 2 * len(kp)]
    return float(np.max(np.abs(np.linalg.eigvals(closed))))
