"""The state of a robot: its platform's pose, twist and bend, and the joints of its legs."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import finite, rotation_matrix
from parflex.base.errors import InputError
from parflex.base.held import Given, Held
from parflex.robot.fields import batched, check_fields, held
from parflex.robot.words import counted, listed


def per_leg(name: str, values: Any) -> tuple[Array | None, ...] | None:
    """One (…, n_i) array, or None, per leg."""
    if values is None:
        return None
    if not isinstance(values, (list, tuple)):
        raise InputError(f"{name} is {type(values).__name__}; give a tuple with one (…, n_i) per leg")
    return tuple(
        None if value is None else finite(f"{name}[{number}]", value, (None,))
        for number, value in enumerate(values)
    )


PerLeg: TypeAlias = Held[Sequence[ArrayLike | None] | None, tuple[Array | None, ...] | None]


@dataclass(frozen=True, eq=False)
class State:
    """Pose, twist and elastic coordinates of the platform; leading axes are batch axes.

    position (…, 3) m and rotation (…, 3, 3) place Σp in Σ0; twist (…, 6) is (v_p, ω_p) in Σp,
    m/s and rad/s; elastic and elastic_rate (…, N) are q_e and q̇_e (0: undeformed, at rest).

    joints and joint_rates, one (…, n_i) per leg, matter to legs whose inverse geometry has no closed
    form: Newton's method starts from them (by default from the leg's posture, with the rates that
    the platform imposes). For other legs they may be None; where given they name the assembly branch
    of a leg without a posture, and are checked against that of one with a posture.

    leg_elastic and leg_elastic_rate, one (…, N_i) per leg, are the elastic coordinates of flexible links,
    link by link, and their rates; None, of all legs or of one, stands for undeformed and at rest.

    Raises InputError for wrong shapes, values that are not finite, or a matrix that is no rotation.

    >>> states = State(position=[[0, 0, 1.0], [0, 0, 1.1]], rotation=np.eye(3), elastic=[1e-3, 0, 0])
    >>> states.batch, states[1].position
    ((2,), array([0. , 0. , 1.1]))
    """

    position: Given = held(batched((3,)))
    rotation: Given = held(rotation_matrix)
    twist: Given = held(batched((6,)), default=(0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    elastic: Given = held(finite, default=0.0)
    elastic_rate: Given = held(finite, default=0.0)
    joints: PerLeg = held(per_leg, default=None)
    joint_rates: PerLeg = held(per_leg, default=None)
    leg_elastic: PerLeg = held(per_leg, default=None)
    leg_elastic_rate: PerLeg = held(per_leg, default=None)

    def __post_init__(self) -> None:
        check_fields(self)
        _ = self.batch  # the leading axes must broadcast

    def __repr__(self) -> str:
        coordinates = counted(
            np.shape(self.elastic)[-1] if np.ndim(self.elastic) else 0, "elastic coordinate"
        )
        if self.batch:
            return f"State: a batch {self.batch}, {coordinates}"
        angle = np.degrees(np.arccos(np.clip((np.trace(self.rotation) - 1) / 2, -1, 1)))
        return (
            f"State: position {listed(self.position)} m, turned by {angle:.4g} deg\n"
            f"  twist {listed(self.twist)} m/s and rad/s, {coordinates}"
        )

    def __getitem__(self, index: Any) -> "State":
        """States of a batch, chosen along its leading axes."""
        batch = self.batch

        def chosen(value: Any, core: int) -> Any:
            if value is None or np.ndim(value) == 0:
                return value
            return np.broadcast_to(value, batch + np.shape(value)[-core:])[index]

        parts = [chosen(value, core) for value, core in self._arrays()]
        legs = [
            None if values is None else tuple(chosen(value, 1) for value in values)
            for values in self._by_leg()
        ]
        return State(*parts, *legs)

    @cached_property
    def batch(self) -> tuple[int, ...]:
        """The common leading axes."""
        legs = [(value, 1) for values in self._by_leg() for value in values or ()]
        shapes = [value.shape[:-core] for value, core in (*self._arrays(), *legs) if value is not None]
        if not any(shapes):
            return ()
        try:
            return np.broadcast_shapes(*shapes)
        except ValueError:
            raise InputError(
                f"State: the leading (batch) axes of position, rotation, twist, elastic, "
                f"elastic_rate, and of the legs' fields, are {shapes}; they must broadcast together"
            ) from None

    @property
    def still(self) -> "State":
        """The state at rest in the same place, with the same bend and joints."""
        return State(
            self.position,
            self.rotation,
            elastic=self.elastic,
            joints=self.joints,
            leg_elastic=self.leg_elastic,
        )

    def _by_leg(self) -> tuple[tuple[Array | None, ...] | None, ...]:
        """The fields of the legs."""
        return self.joints, self.joint_rates, self.leg_elastic, self.leg_elastic_rate

    def _arrays(self) -> tuple[tuple[Any, int], ...]:
        """The platform's fields, with the number of axes of one item."""
        return (
            (self.position, 1),
            (self.rotation, 2),
            (self.twist, 1),
            (self.elastic, 1),
            (self.elastic_rate, 1),
        )
