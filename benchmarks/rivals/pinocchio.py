"""Pinocchio (BSD 2-Clause): rigid platforms, by its constrained dynamics."""

import numpy as np
import pinocchio as pin

from benchmarks.rivals.base import Rival, Task, actuated, in_platform_axes, joints_at
from pin_robot import PinRobot
from sample import Sample


class Pinocchio(Rival):
    """The robot of the tests, `tests/support/pin_robot.py`, its workspaces made once."""

    name = "Pinocchio"
    remark = (
        "has no inverse model of a closed robot: constraintDynamics, its factors for six columns, and a "
        "6 × 6 solve in NumPy"
    )

    def __init__(self, sample: Sample) -> None:
        super().__init__(sample)
        self.robot = PinRobot(sample)
        self.model = self.robot.model
        self.data, self.contacts = self.model.createData(), pin.StdVec_RigidConstraintData()
        for contact in self.robot.contacts:
            self.contacts.append(contact.createData())
        pin.initConstraintDynamics(self.model, self.data, self.robot.contacts, self.contacts)
        self.driven = self.robot.places[actuated(sample)]

    def direct(self, s: int) -> dict[str, Task]:
        q, qd = self.coordinates(s)
        load = np.zeros(self.model.nv)
        load[self.driven] = self.sample.forces[s]
        given = self.model, self.data, q, qd, load, self.robot.contacts, self.contacts
        twist = self.sample.platform[s].twist
        answer = lambda: in_platform_axes(self.data.ddq[:6], twist)  # noqa: E731
        return {"constraintDynamics": Task(lambda: pin.constraintDynamics(*given), answer)}

    def inverse(self, s: int) -> dict[str, Task]:
        """The direct model is affine in Γ: q̈ = q̈(Γ = 0) + G Γ, six rows of which are wanted.

        G follows from the factors of [0, J; Jᵀ, M]; those that `constraintDynamics` leaves are refused as
        out of date, so that they are computed again.
        """
        q, qd = self.coordinates(s)
        twist = self.sample.platform[s].twist
        wanted = self.sample.target[s] - in_platform_axes(np.zeros(6), twist)
        rows = 3 * len(self.contacts)
        columns = np.zeros((rows + self.model.nv, len(self.driven)))
        columns[rows + self.driven, np.arange(len(self.driven))] = 1.0
        data, chol, kept = self.data, self.data.constraint_chol, np.zeros(len(self.driven))
        given = self.model, data, q, qd, np.zeros(self.model.nv), self.robot.contacts, self.contacts

        def call() -> None:
            pin.constraintDynamics(*given)
            chol.compute(self.model, data, self.robot.contacts, self.contacts, 0.0)
            gain = chol.solve(columns)[rows : rows + 6]
            kept[:] = np.linalg.solve(gain, wanted - data.ddq[:6])

        return {"constraintDynamics, its KKT factors, 6 × 6 solve": Task(call, kept.copy)}

    def coordinates(self, s: int) -> tuple[np.ndarray, np.ndarray]:
        """q and q̇ of the free body and the legs."""
        state, places = self.sample.platform[s], self.robot.places
        q, qd = np.zeros(self.model.nq), np.zeros(self.model.nv)
        q[:7] = [*state.position, *pin.Quaternion(np.asarray(state.rotation)).coeffs()]
        qd[:6] = state.twist
        q[places + 1], qd[places] = joints_at(self.sample, s)
        return q, qd
