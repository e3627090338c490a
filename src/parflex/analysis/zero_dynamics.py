"""Commands of an output: conditioning, gains under bending, elastic zero dynamics."""

from dataclasses import dataclass

import numpy as np

from parflex.analysis.equilibrium import at_rest
from parflex.analysis.gains import check_gain, gain_matrix, gain_ratio, ratio
from parflex.analysis.mobility import null_space, scaled_closure
from parflex.base.array import Array
from parflex.compiled.functions import Functions
from parflex.kernels import models
from parflex.kernels.motion import derivative
from parflex.mechanics.closure import ALL, accelerated, carried_part, displaced, units
from parflex.mechanics.flat_state import state_of
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.output import Output
from parflex.robot.layout import coordinates
from parflex.robot.state import State

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
        """The sign of det ∂output/∂Γ against that of a rigid platform."""
        return int(np.sign(np.prod(self.gain_ratio).real))

    @property
    def stable(self) -> bool:
        """True where the motion that is left dies away."""
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


def output_report(functions: Functions, state: State, output: Output) -> OutputReport:
    """The report about the equilibrium in the pose of a state."""
    mechanism = functions.mechanism
    x, forces = at_rest(functions, "state", state)
    gains = functions(models.gains, output)(x=x)
    check_gain(mechanism, output, x, gains["flexible"], gains["rigid"])
    flexible, rigid = (gain_matrix(mechanism, output, g) for g in gains.values())
    return OutputReport(
        state_of(mechanism, x),
        forces,
        conditioning=1.0 / max(float(ratio(flexible)), np.finfo(float).tiny),
        gain_ratio=np.linalg.eigvals(gain_ratio(flexible, rigid)),
        poles=zero_poles(functions, x, forces, output),
    )


def zero_poles(functions: Functions, x: Array, forces: Array, output: Output) -> Array:
    """Poles (2 n,) of the motion left about an equilibrium x while the output does not accelerate.

    By central differences of the inverse model, along the motions that keep closure and output.
    """
    mechanism, at = functions.mechanism, functions.mechanism.layout.at
    T = held_motions(mechanism, x, output)
    platform, joints = np.split(T, [mechanism.layout.displacements.joints.start])
    kept = np.concatenate([platform, carried_part(mechanism, joints.T).T])
    step = STEP * mechanism.size
    steps = step * np.concatenate([T.T, -T.T])
    start = np.broadcast_to(x, (len(steps), len(x)))
    states = np.concatenate([displaced(mechanism, start, steps), accelerated(mechanism, start, steps)])
    none, target = np.zeros(6 + mechanism.platform.modes), np.zeros(output.size)
    Gamma = functions(models.inverse, output)(x=states, target=target, load=none, preload=forces)["forces"]
    rates = functions(derivative)(x=states, forces=Gamma, load=none)["rate"]
    a = np.concatenate([rates[:, part] for part in (at.twist, at.elastic_rate, at.joint_rates)], axis=-1)
    plus_place, minus_place, plus_rate, minus_rate = np.split(a @ np.linalg.pinv(kept).T, 4)
    A, B = (plus_place - minus_place).T / (2 * step), (plus_rate - minus_rate).T / (2 * step)
    one, zero = np.eye(len(A)), np.zeros(A.shape)
    return np.sort_complex(np.linalg.eigvals(np.block([[zero, one], [A, B]])))


def held_motions(mechanism: Mechanism, x: Array, output: Output) -> Array:
    """Motions (6 + N + n, d) that the closure allows and the output does not see."""
    c, scale = coordinates(x, mechanism.layout), units(mechanism, ALL)
    every = np.eye(6 + mechanism.platform.modes)
    seen = output.linear(mechanism.platform.body, c, every[:6], every[6:])
    blind = np.zeros((output.size, len(scale) - len(every)))
    rows = np.hstack([seen, blind]) * scale
    return scale[:, None] * null_space(np.vstack([scaled_closure(mechanism, x), rows]))
