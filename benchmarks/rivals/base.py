"""What a program must offer to be compared: calls to be timed, and what they answered."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from sample import Sample


class Task(NamedTuple):
    """One way to ask for a model at one state: `call` is timed, `answer` reads what it found.

    The direct model answers (V̇_p 6, q̈_e N) in Σp, the inverse model Γ (m).
    """

    call: Callable[[], object]
    answer: Callable[[], np.ndarray]


class Rival(ABC):
    """A program that has read a sample.

    `remark` says what a reader of its figures must know; `tolerance` is the agreement that it must reach.
    """

    name: str
    remark: str = ""
    tolerance: float = 1e-9  # of programs that answer to round-off

    def __init__(self, sample: Sample) -> None:
        self.sample = sample

    @abstractmethod
    def direct(self, s: int) -> dict[str, Task]:
        """The ways to compute the accelerations that `sample.forces[s]` causes at state s."""

    def inverse(self, s: int) -> dict[str, Task]:
        """The ways to compute the forces for `sample.target[s]` at state s; none where it has none."""
        return {}


def joints_at(sample: Sample, s: int) -> tuple[np.ndarray, np.ndarray]:
    """q, q̇ of all legs side by side."""
    return tuple(np.concatenate([leg[s] for leg in legs]) for legs in (sample.q, sample.qd))


def actuated(sample: Sample) -> np.ndarray:
    """Which of the joints of all legs, side by side, have actuators."""
    return np.array([bool(joint.mu) for leg in sample.legs for joint in leg.joints])


def in_platform_axes(components: np.ndarray, twist: np.ndarray) -> np.ndarray:
    """V̇_p from the rates of the twist's components in Σp: v̇_p gains ω × v."""
    gained = np.cross(twist[3:], twist[:3])
    return components + np.concatenate([gained, np.zeros(3)])
