"""Small motions about an equilibrium: ζ̈ = K ζ + C ζ̇ + B Γ, and the poles that are left under a law.

ζ are coordinates of the motions T that the closure allows: of Σp, of the modes and of all coordinates of
the legs. The actuated joints move by S ζ.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from parflex.analysis.equilibrium import at_rest
from parflex.analysis.gains import gain_matrix
from parflex.analysis.mobility import motions, null_space, scaled_closure, scaled_tips
from parflex.analysis.statics import held_load, linearised
from parflex.base.array import Array
from parflex.compiled.functions import Functions
from parflex.kernels import models
from parflex.kernels.motion import derivative
from parflex.mechanics.closure import EVERY, accelerated, actuated_rows, displaced, units
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.output import FrameOutput
from parflex.mechanics.system import assembled
from parflex.robot.state import State

STEP = 1e-6  # of the platform's size, for differences

Forces = Callable[[Array], Array]  # Γ (…, m) at flat states (…, size)


@dataclass(frozen=True, eq=False)
class SmallMotions:
    """The motions about an equilibrium, a flat state x, under forces that stay as they are."""

    functions: Functions
    x: Array
    forces: Array  # (m,)

    @cached_property
    def T(self) -> Array:
        """(6 + N + z, d), the motions that the closure allows."""
        return allowed(self.functions.mechanism, self.x)

    @cached_property
    def KC(self) -> tuple[Array, Array]:
        """K (d, d) 1/s² and C (d, d) 1/s."""
        mechanism = self.functions.solvable
        return linearised(assembled(mechanism, self.x), self.T, self.forces, held_load(mechanism, ()))

    @cached_property
    def B(self) -> Array:
        """(d, m), which is linear to round-off: one newton on each actuator."""
        m, none = len(self.forces), np.zeros(6 + self.functions.mechanism.platform.modes)
        states = np.broadcast_to(self.x, (m + 1, len(self.x)))
        pushed = self.forces + np.vstack([np.zeros((1, m)), np.eye(m)])
        a = accelerations(self.functions, states, pushed, none) @ pseudo_inverse(self.functions, self.T).T
        found: Array = (a[1:] - a[0]).T
        return found

    @cached_property
    def S(self) -> Array:
        """(m, d), the motions of the actuated joints."""
        found: Array = actuated_rows(self.functions.mechanism) @ self.T
        return found

    def free_poles(self) -> Array:
        """Poles of the robot under the forces that hold it at rest."""
        return poles(*self.KC)

    def locked_poles(self) -> Array:
        """Poles of the robot whose actuated joints are locked: motions η with S ζ = 0, ζ = Z η.

        The forces that lock it are Γ = −(S B)⁻¹ S (K ζ + C ζ̇).
        """
        Z = null_space(self.S / np.linalg.norm(self.S, axis=1, keepdims=True))
        hold = Z.T - Z.T @ self.B @ np.linalg.pinv(self.S @ self.B) @ self.S
        return poles(*(hold @ part @ Z for part in self.KC))

    def servo_poles(self, kp: Array, kd: Array, ki: Array) -> Array:
        """Poles of the robot whose actuated joints are held by Γ = −kp q − kd q̇ − ki ∫ q dt, gains (m,)."""
        K, C = self.KC
        closed_K, closed_C = K - self.B @ (kp[:, None] * self.S), C - self.B @ (kd[:, None] * self.S)
        if not np.any(ki):
            return poles(closed_K, closed_C)
        d, m = self.B.shape
        return np.sort_complex(
            np.linalg.eigvals(
                np.block(
                    [
                        [np.zeros((d, d)), np.eye(d), np.zeros((d, m))],
                        [closed_K, closed_C, -self.B * ki],
                        [self.S, np.zeros((m, d + m))],
                    ]
                )
            )
        )

    def joint_mobility(self) -> Array:
        """∂q̈_a/∂Γ (m, m) 1/kg of the robot whose platform does not bend."""
        mechanism, output = self.functions.mechanism, FrameOutput()
        gain = gain_matrix(mechanism, output, self.functions(models.gains, output)(x=self.x)["rigid"])
        unbent = motions(mechanism, scaled_tips(mechanism, self.x))
        found: Array = unbent.actuated @ np.linalg.pinv(unbent.platform) @ gain
        return found


def about(functions: Functions, state: State) -> SmallMotions:
    """The small motions about the equilibrium in the pose of a state; raises as `at_rest`."""
    return SmallMotions(functions, *at_rest(functions, "state", state))


def poles(K: Array, C: Array) -> Array:
    """The poles (2 d,) of ζ̈ = K ζ + C ζ̇."""
    one, zero = np.eye(len(K)), np.zeros(K.shape)
    return np.sort_complex(np.linalg.eigvals(np.block([[zero, one], [K, C]])))


def allowed(mechanism: Mechanism, x: Array, *more: Array) -> Array:
    """Motions (6 + N + z, d) that the closure allows, and more rows (…, 6 + N + z) do not see."""
    scale = units(mechanism, EVERY)
    rows = [scaled_closure(mechanism, x), *(row * scale for row in more)]
    return scale[:, None] * null_space(np.vstack(rows))


def slopes(functions: Functions, x: Array, T: Array, forces: Forces) -> tuple[Array, Array]:
    """K and C (d, d) of the motions T about an equilibrium x under a law, by central differences."""
    mechanism, none = functions.mechanism, np.zeros(6 + functions.mechanism.platform.modes)
    step = STEP * mechanism.size
    steps = step * np.concatenate([T.T, -T.T])
    start = np.broadcast_to(x, (len(steps), len(x)))
    states = np.concatenate([displaced(mechanism, start, steps), accelerated(mechanism, start, steps)])
    a = accelerations(functions, states, forces(states), none)
    plus_place, minus_place, plus_rate, minus_rate = np.split(a @ pseudo_inverse(functions, T).T, 4)
    return (plus_place - minus_place).T / (2 * step), (plus_rate - minus_rate).T / (2 * step)


def accelerations(functions: Functions, states: Array, forces: Array, load: Array) -> Array:
    """The accelerations (…, 6 + N + z) of platform, modes and joints that are carried."""
    at = functions.mechanism.layout.at
    rates = functions(derivative)(x=states, forces=forces, load=load)["rate"]
    return np.concatenate([rates[:, part] for part in (at.twist, at.elastic_rate, at.joint_rates)], axis=-1)


def pseudo_inverse(functions: Functions, T: Array) -> Array:
    """(d, 6 + N + z carried), from the accelerations of the state to those of the coordinates of T."""
    mechanism = functions.mechanism
    platform, joints = np.split(T, [mechanism.layout.displacements.joints.start])
    return np.linalg.pinv(np.concatenate([platform, joints[mechanism.kept]]))
