"""Any other leg: its joints are carried in the state."""

import numpy as np

from parflex.base.array import Array
from parflex.mechanics.chain import Frames, Joints
from parflex.mechanics.legs.base import LegGroup, LegType, joints_at
from parflex.robot.leg import Leg


class Carried(LegType):
    """A tree without closed form: z and ż are part of the state, its joints solved by Newton at the door."""

    name = "Newton"
    carries = True

    def recognises(self, leg: Leg) -> bool:
        """Every leg."""
        return True

    def joints(self, group: LegGroup, tips: Array, kept: Array) -> Joints:
        """The joints that the state carries."""
        return joints_at(group.chain, kept[..., : group.chain.n], group.bend(kept))

    def rates(
        self, group: LegGroup, frames: Frames, joints: Joints, tips: Array, v: Array, kept: Array
    ) -> Array:
        """The rates that the state carries."""
        return kept[..., : group.chain.n]

    def margins(self, group: LegGroup, joints: Joints, tips: Array) -> tuple[Array, Array]:
        """No margins: a carried leg fails by the closure, which is checked for itself."""
        fine = np.ones(joints.cos.shape[:-1])
        return fine, fine
