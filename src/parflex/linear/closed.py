"""Feedback of the actuated joints: servos, springs and dampers, and locked motors."""

from typing import Any, NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.linear.point import Point
from parflex.mechanics.closure import actuated_rows


class Feedback(NamedTuple):
    """Γ = −kp q − kd q̇ − ki ∫ q dt of the actuated joints q = S ζ, as accelerations ζ̈ and as forces."""

    K: Array  # (d, d)
    C: Array  # (d, d)
    integrals: Array  # (i, d): the joints whose integrals are states
    by_integrals: Array  # (d, i)
    forces_by_place: Array  # (m, d)
    forces_by_rate: Array  # (m, d)
    forces_by_integrals: Array  # (m, i)


def feedback_of(point: Point, controller: Any) -> Feedback:
    """The feedback of a controller with gains kp, kd and perhaps ki, scalars or (m,).

    Raises InputError for one without.
    """
    m = len(point.forces)
    kp, kd, ki = gains_of(controller, m)
    S, B = actuated_rows(point.mechanism) @ point.T, point.pushed(forces=np.eye(m))
    integrated = np.flatnonzero(ki)
    by_place, by_rate, by_integrals = -kp[:, None] * S, -kd[:, None] * S, -np.diag(ki)[:, integrated]
    return Feedback(
        B @ by_place, B @ by_rate, S[integrated], B @ by_integrals, by_place, by_rate, by_integrals
    )


def gains_of(controller: Any, m: int) -> tuple[Array, Array, Array]:
    """kp, kd and ki (m,) of a controller; raises InputError for one without."""
    if not all(hasattr(controller, name) for name in ("kp", "kd")):
        named = repr(controller) if isinstance(controller, str) else type(controller).__name__
        raise InputError(
            f"controller is {named}, which has no gains kp and kd of the actuated joints; give a JointPD, a "
            f'Servo, or "locked" for motors that stand still'
        )
    kp, kd, ki = (np.asarray(getattr(controller, name, 0.0)) + np.zeros(m) for name in ("kp", "kd", "ki"))
    return kp, kd, ki
