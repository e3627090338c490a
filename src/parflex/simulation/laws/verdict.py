"""Verdicts on control laws, told before a run: what they make of small motions about an equilibrium."""

from dataclasses import dataclass

import numpy as np

from parflex.analysis.small_motions import SmallMotions
from parflex.base.array import Array

TOPPLES = (
    "the joints are too soft for the weight, or the pose is near a singularity: raise kp, or change these"
)
FAINT = 1e-4  # of a pole's size: a growth that any real damping takes away


@dataclass(frozen=True)
class Verdict:
    """A law is stable about an equilibrium or not; the pole (1/s) that decides, and a sentence."""

    stable: bool
    pole: complex
    words: str

    def __str__(self) -> str:
        return self.words


def decisive(poles: Array) -> complex:
    """The pole of the fastest growth, or, where none grows, the rightmost one; zero where there are none."""
    if len(poles) == 0:
        return 0j
    growing = poles[poles.real > FAINT * np.abs(poles)]
    return complex(poles[np.argmax(poles.real)] if len(growing) == 0 else growing[np.argmax(growing.real)])


def grows(pole: complex) -> bool:
    """True for a pole whose motion grows, by more than round-off."""
    return pole.real > FAINT * abs(pole)


def pace(pole: complex) -> str:
    """The growth or decay of a motion in words: "grows e-fold in 0.4 ms at 13 kHz"."""
    verb = "grows" if pole.real > 0 else "dies away"
    return f"{verb} e-fold in {duration(1.0 / abs(pole.real))}{swing(pole)}"


def slowest(pole: complex) -> str:
    """The sentence about the motion that dies away last."""
    if abs(pole.real) <= FAINT * abs(pole):
        return f"a mode{swing(pole)} has no damping"
    return f"the slowest motion {pace(pole)}"


def swing(pole: complex) -> str:
    """The frequency of a pole that oscillates, as " at 13 kHz"."""
    hertz = abs(pole.imag) / (2 * np.pi)
    if hertz < 1e-3 * abs(pole):
        return ""
    return f" at {hertz / 1e3:.3g} kHz" if hertz >= 1e3 else f" at {hertz:.3g} Hz"


def duration(seconds: float) -> str:
    """A time in s, ms or µs."""
    for unit, factor in (("s", 1.0), ("ms", 1e3)):
        if seconds * factor >= 1.0:
            return f"{seconds * factor:.3g} {unit}"
    return f"{seconds * 1e6:.3g} µs"


def servo_verdict(name: str, motions: SmallMotions, kp: Array, kd: Array, ki: Array) -> Verdict:
    """The verdict on joints that are held by gains (m,)."""
    worst, locked = (decisive(found) for found in (motions.servo_poles(kp, kd, ki), motions.locked_poles()))
    if grows(locked):
        return Verdict(False, worst, f"{name}: unstable; {buckling(locked)}")
    if grows(worst):
        remedy = "lower ki, or raise kd" if np.any(ki) else TOPPLES
        return Verdict(False, worst, f"{name}: unstable, a motion {pace(worst)}; {remedy}")
    return Verdict(True, worst, f"{name}: stable; {slowest(worst)}")


def buckling(locked: complex) -> str:
    """The sentence about a platform that no gains of the joints hold."""
    return (
        f"the platform buckles on its locked legs ({locked.real:+.3g} 1/s, e-fold in "
        f"{duration(1.0 / locked.real)}), so that no gains of the joints hold it; stiffen it, or use "
        f"computed torque, which feeds back the pose"
    )


def frame_verdict(name: str, poles: Array) -> Verdict:
    """The verdict on a law that holds the platform's frame, by the poles of the zero dynamics."""
    if len(poles) == 0:
        return Verdict(True, 0j, f"{name}: stable, nothing bends")
    worst = decisive(poles)
    if not grows(worst):
        return Verdict(True, worst, f"{name}: stable; while the frame is held, {slowest(worst)}")
    return Verdict(
        False,
        worst,
        f"{name}: unstable; while it holds the platform's frame, a motion of the modes {pace(worst)}; "
        f'use the legs\' servos (kind = "servo"), or a platform without such shapes; docs/why-it-diverges.md',
    )
