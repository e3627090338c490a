"""The observer of bending: a run whose modes take over diverges, whatever its first symptom."""

from collections import deque

import numpy as np

from parflex.analysis.health import check_finite
from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.model.core import Core
from parflex.robot.joint_words import actuator_units
from parflex.simulation.laws.bound import BoundLaw
from parflex.simulation.laws.verdict import duration
from parflex.simulation.observers import Advance, Observer

FAR = 0.5  # of the platform's size: a deformation at an attachment that no linear body has
NOTED = 0.01  # of it: a deformation that can put a leg out of its reach
TAKEN_OVER = 10.0  # elastic energy over the largest of all else that was seen before
OUTGROWN = 1e3  # elastic energy over its median up to then
KEPT = 200  # states that show how it came to the end
PART = 1e6  # the part of the last energy from which its growth is told


class Growth(Observer):
    """The run ends where the platform bends beyond all measure; the cause of such an end is told."""

    def __init__(self, core: Core, law: BoundLaw) -> None:
        self._mechanism, self._law = core.mechanism, law
        moments = core.mechanism.platform.body.moments
        self._inertia = np.trace(moments.P0) * np.eye(3) - moments.P0
        self._t: list[float] = []
        self._elastic: list[float] = []  # J
        self._states: deque[Array] = deque(maxlen=KEPT)  # the last ones
        self._other = 0.0  # J, the largest kinetic energy of the platform as a whole

    def begin(self, y: Array) -> None:
        self._look(0.0, y)

    def see(self, advance: Advance) -> None:
        self._look(advance.stepper.t, advance.stepper.y)
        if self._deformation() > FAR or advance.stopped:
            advance.stopped = self.diagnosis() or advance.stopped

    def diagnosis(self) -> str:
        last, usual = self._elastic[-1], float(np.median(self._elastic))
        if self._deformation() < NOTED or last < max(TAKEN_OVER * self._other, OUTGROWN * usual):
            return ""
        before = max(i for i, energy in enumerate(self._elastic) if i == 0 or energy < last / PART)
        span = duration(self._t[-1] - self._t[before])
        return (
            f"the motion diverges: within {span} the platform's elastic energy has grown from "
            f"{self._elastic[before]:.2g} to {last:.2g} J{self._forces()}; "
            f"the control makes its modes unstable, as its verdict tells before a run, or the loads do"
        )

    def last_states(self) -> tuple[Array, Array]:
        return np.array(self._t[-len(self._states) :]), np.array(self._states)

    def _look(self, t: float, y: Array) -> None:
        """Note the energies in y (size,) at a time; a state that is no number is no state."""
        if not np.all(np.isfinite(y)):
            return
        at, body = self._mechanism.layout.at, self._mechanism.platform.body
        self._states.append(y.copy())
        twist = self._law.loads.standpoint.seen(t, y)[at.twist]  # of the base's speed nothing can be told
        q, qd = y[at.elastic], y[at.elastic_rate]
        v, omega = twist[:3], twist[3:]
        self._other = max(self._other, 0.5 * float(body.moments.m * v @ v + omega @ self._inertia @ omega))
        self._t.append(t)
        self._elastic.append(0.5 * float(q @ (self._mechanism.platform.stiffness * q) + qd @ body.m_ee @ qd))

    def _deformation(self) -> float:
        """The largest deformation at an attachment, of the platform's size."""
        bend = self._states[-1][self._mechanism.layout.at.elastic]
        moved = self._mechanism.platform.body.attachment_shapes @ bend
        return float(np.max(np.linalg.norm(moved, axis=-1), initial=0.0)) / self._mechanism.size

    def _forces(self) -> str:
        """The largest force in words, where the law still gives one."""
        try:
            forces = self._law.forces(self._t[-1], self._states[-1][: -self._law.works])
            check_finite(forces)
        except InputError:
            return ""
        units = actuator_units(self._mechanism.robot)
        return f", and the largest actuator force to {np.max(np.abs(forces), initial=0.0):.2g} {units}"
