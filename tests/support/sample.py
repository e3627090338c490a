"""A robot with states on its closure, in the words of the library and in those of the oracle."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

import oracle
import parflex as pf


@dataclass(frozen=True, eq=False, repr=False)
class Sample:
    """S states; `q`, `qd` are one (S, n_i) per leg. As the oracle asks, it has `legs` and `gravity`."""

    legs: tuple[pf.Leg, ...]
    body: pf.FlexibleBody
    cloud: oracle.NodalPlatform  # the same platform for the oracle
    gravity: np.ndarray
    home_pose: tuple
    platform: pf.State  # the platform's part of the states
    q: list[np.ndarray]
    qd: list[np.ndarray]
    forces: np.ndarray  # (S, m)
    target: np.ndarray  # (S, o)
    rows: tuple[int, ...] = tuple(range(6))  # of V̇_p that the target prescribes

    @cached_property
    def robot(self) -> pf.Robot:
        return pf.Robot(self.legs, self.body, self.gravity, self.home_pose)

    @cached_property
    def states(self) -> pf.State:
        return with_joints(self.platform, self.q, self.qd)

    @property
    def output(self) -> pf.FrameOutput:
        return pf.FrameOutput(self.rows)

    def system(self, s: int) -> oracle.System:
        """The oracle's system at state s."""
        q, qd = ([leg[s] for leg in legs] for legs in (self.q, self.qd))
        return oracle.system(self, self.cloud, self.platform[s], start=q, rates=qd)

    def tip_motions(self, state: pf.State) -> tuple[list, list]:
        """World positions and velocities of the platform's points, one (t, 3) per leg."""
        held = [tip.attachment for leg in self.legs for tip in leg.tips]
        points = self.cloud.attachments[held], self.cloud.attachment_shapes[held]
        last = np.cumsum([len(leg.tips) for leg in self.legs])[:-1]
        places, velocities, *_ = self.cloud.point_motion(state, *points)
        return np.split(places, last), np.split(velocities, last)

    def open(self, state: pf.State, q: Sequence) -> tuple[float, float]:
        """How far the legs at joint values q are from the platform (m), and how far from following it with
        any joint rates (m/s)."""
        gap, slip = 0.0, 0.0
        for leg, q_i, place, velocity in zip(self.legs, q, *self.tip_motions(state), strict=True):
            _, tips, J = oracle.tree(leg, q_i)
            qd = oracle.joint_rates(leg, q_i, velocity)
            gap = max(gap, np.max(np.abs(tips - place)))
            slip = max(slip, np.max(np.abs(oracle.tip_rows(leg, J) @ qd - velocity.ravel())))
        return gap, slip

    @cached_property
    def systems(self) -> list[oracle.System]:
        return [self.system(s) for s in range(len(self.forces))]

    @cached_property
    def direct(self) -> oracle.Motion:
        """The oracle's answer to `forces`."""
        pairs = zip(self.systems, self.forces, strict=True)
        return oracle.stacked([oracle.direct_of(at, forces) for at, forces in pairs])

    @cached_property
    def inverse(self) -> oracle.Motion:
        """The oracle's answer to `target`."""
        pairs = zip(self.systems, self.target, strict=True)
        return oracle.stacked([oracle.inverse_of(at, target, self.rows) for at, target in pairs])


def with_joints(state: pf.State, q: Sequence, qd: Sequence) -> pf.State:
    """The state with joint values and rates, one array per leg."""
    return pf.State(*(getattr(state, name) for name in FIELDS), joints=tuple(q), joint_rates=tuple(qd))


FIELDS = ("position", "rotation", "twist", "elastic", "elastic_rate")
