"""Commands of an output: conditioning, gains under bending, elastic zero dynamics."""

from dataclasses import dataclass

import numpy as np

from parflex.analysis.equilibrium import at_rest
from parflex.analysis.gains import check_gain, gain_matrix, gain_ratio, ratio
from parflex.analysis.health import check_finite
from parflex.analysis.posed import check_reached
from parflex.analysis.small_motions import allowed, poles, slopes
from parflex.base.array import Array
from parflex.compiled.functions import Functions
from parflex.kernels import models
from parflex.mechanics.flat_state import state_of
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.output import Output
from parflex.robot.layout import coordinates
from parflex.robot.state import State


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
    check_reached(functions, output, x)
    gains = functions(models.gains, output)(x=x)
    check_finite(gains["flexible"])
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
    """Poles (2 n,) of the motion left about an equilibrium x while the output does not accelerate."""
    mechanism = functions.mechanism
    inverse, none = functions(models.inverse, output), np.zeros(6 + mechanism.platform.modes)
    target = np.zeros(output.size)

    def held(states: Array) -> Array:
        return inverse(x=states, target=target, load=none, preload=forces)["forces"]

    return poles(*slopes(functions, x, held_motions(mechanism, x, output), held))


def held_motions(mechanism: Mechanism, x: Array, output: Output) -> Array:
    """Motions (6 + N + n, d) that the closure allows and the output does not see."""
    return allowed(mechanism, x, output.seen(mechanism, coordinates(x, mechanism.layout)))
