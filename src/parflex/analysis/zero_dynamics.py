"""How well an output is commanded: gains, what bending makes of them, elastic zero dynamics."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from parflex.analysis.mobility import null_space, scaled_closure
from parflex.analysis.search import at_rest
from parflex.analysis.singularities import by_rows, check_gain, gain_ratio, ratio
from parflex.base.array import Array
from parflex.kernels import models as kernels
from parflex.kernels import motion
from parflex.mechanics.closure import ALL, accelerated, carried_part, displaced, size_of, units
from parflex.mechanics.output import Output
from parflex.robot.layout import coordinates
from parflex.robot.robot import Robot
from parflex.robot.state import State

if TYPE_CHECKING:
    from parflex.model.model import Model

STEP = 1e-6  # of the platform's size, for differences


@dataclass(frozen=True)
class OutputReport:
    """An output about an equilibrium.

    gain_ratio holds the eigenvalues (o,) of what bending makes of the output's acceleration: 1
    where the platform might as well be rigid, negative where it accelerates against its actuators.
    poles (1/s) are those of the motion that is left while the output is held still.
    """

    state: State
    forces: Array  # (m,)
    conditioning: float  # largest over smallest singular value of ∂output/∂Γ, lengths scaled
    gain_ratio: Array  # (o,), complex where they pair
    poles: Array  # (2 n,) complex

    @property
    def sign(self) -> int:
        """Of det ∂output/∂Γ against that of a rigid platform."""
        return int(np.sign(np.prod(self.gain_ratio).real))

    @property
    def stable(self) -> bool:
        """Whether the motion that is left dies away."""
        return bool(np.all(self.poles.real < 0))

    def __str__(self) -> str:
        """A paragraph to read."""
        weakest = self.gain_ratio[np.argmin(np.abs(self.gain_ratio))].real
        words = [f"∂output/∂Γ has condition number {self.conditioning:.3g}; bending leaves"]
        words.append(f"{100 * weakest:.3g} % of the weakest gain of a rigid platform.")
        if self.sign < 0:
            words.append("Its determinant has the opposite sign.")
        if len(self.poles):
            worst = self.poles[np.argmax(self.poles.real)]
            words.append(f"The rightmost pole of the elastic zero dynamics is {worst:.4g} 1/s:")
            words.append(
                "control of this output " + ("leaves the modes stable." if self.stable else "is unstable.")
            )
        return " ".join(words)


def output_report(model: "Model", state: State, output: Output) -> OutputReport:
    """The report about the equilibrium in the pose of a state."""
    robot = model.robot
    x, forces = at_rest(model, "state", state)
    gains = model.function(kernels.gains, output)(x)
    check_gain(robot, output, x, *gains)
    flexible, rigid = (by_rows(robot, output, g) for g in gains)
    return OutputReport(
        model.state(x),
        forces,
        conditioning=1.0 / max(float(ratio(flexible)), np.finfo(float).tiny),
        gain_ratio=np.linalg.eigvals(gain_ratio(flexible, rigid)),
        poles=zero_poles(model, x, forces, output),
    )


def zero_poles(model: "Model", x: Array, forces: Array, output: Output) -> Array:
    """Poles (2 n,) of the motion left about an equilibrium x while the output does not accelerate.

    By central differences of the inverse model, along the motions that keep closure and output.
    """
    robot, n = model.robot, model.robot.layout.carried
    T = held_motions(model.robot, x, output)
    platform, joints = np.split(T, [6 + robot.layout.modes])
    kept = np.concatenate([platform, carried_part(robot, joints.T).T])
    steps = STEP * size_of(robot) * np.concatenate([T.T, -T.T])
    states = np.concatenate(
        [displaced(robot, np.broadcast_to(x, (len(steps), len(x))), steps)]
        + [accelerated(robot, np.broadcast_to(x, (len(steps), len(x))), steps)]
    )
    none = np.zeros(6 + robot.layout.modes)
    target = np.zeros(output.size)
    Gamma = model.function(kernels.inverse, output)(states, target, none, forces)[0]
    rates = model.function(motion.derivative)(states, Gamma, none)[0]
    N = robot.layout.modes
    a = np.concatenate([rates[:, 7:13], rates[:, 13 + N : 13 + 2 * N], rates[:, len(x) - n :]], axis=-1)
    plus_place, minus_place, plus_rate, minus_rate = np.split(a @ np.linalg.pinv(kept).T, 4)
    span = 2 * STEP * size_of(robot)
    A, B = (plus_place - minus_place).T / span, (plus_rate - minus_rate).T / span
    one, zero = np.eye(len(A)), np.zeros(A.shape)
    return np.sort_complex(np.linalg.eigvals(np.block([[zero, one], [A, B]])))


def held_motions(robot: Robot, x: Array, output: Output) -> Array:
    """Motions (6 + N + n, d) that the closure allows and the output does not see."""
    c, N = coordinates(x, robot.layout), robot.layout.modes
    every = np.eye(6 + N)
    seen = output.linear(robot.platform, c, every[:6], every[6:])
    blind = np.zeros((output.size, all_joints(robot)))
    scale = units(robot, ALL)
    rows = np.hstack([seen, blind]) * scale
    return scale[:, None] * null_space(np.vstack([scaled_closure(robot, x), rows]))


def all_joints(robot: Robot) -> int:
    """n, the joints of all legs."""
    return sum(len(leg.joints) for leg in robot.legs)
