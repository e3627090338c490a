"""A run as the variables of its result are computed from it."""

from functools import cached_property

import numpy as np

from parflex.base.array import Array
from parflex.kernels.moved_base import BASE
from parflex.kernels.segment import Sample
from parflex.mechanics.energy import Energies, energies
from parflex.mechanics.ordering import Joints, joints_of
from parflex.mechanics.paths import Paths, leg_paths
from parflex.mechanics.system import System, assemble
from parflex.model.core import Core
from parflex.robot.carrying import Base, base_of, seen
from parflex.robot.layout import Coordinates, coordinates
from parflex.simulation.integrate import Run
from parflex.simulation.laws.controller import Controller
from parflex.simulation.laws.law import Replay
from parflex.simulation.surroundings.imposed import IMPOSED
from parflex.simulation.surroundings.standpoint import carried_motion

WORKS = ("actuators", "wrenches", "dissipated")  # of every run, in the order of its powers


class Recorded:
    """The states of a run, what its law did, and what several variables need; computed at first need."""

    def __init__(self, core: Core, run: Run, replay: Replay, controller: Controller) -> None:
        self.core, self.mechanism, self.robot = core, core.mechanism, core.robot
        self.run, self.replay, self.controller = run, replay, controller
        self.works = dict(zip((*WORKS, *replay.imposed), run.works.T, strict=True))  # each (T,) J
        self.t = run.t  # (T,) s

    @cached_property
    def state(self) -> Coordinates:
        """The states (T, …)."""
        return coordinates(self.run.x, self.mechanism.layout)

    @cached_property
    def system(self) -> System:
        """The mechanics at the states, in surroundings that move."""
        mechanism = self.mechanism
        for name, rows in self.replay.imposed.items():
            mechanism = IMPOSED[name].changed(mechanism, rows)
        return assemble(mechanism, self.state)

    @cached_property
    def base(self) -> Base | None:
        """The motion of the base, each (T, …); None where it does not move."""
        flat = self.replay.imposed.get(BASE)
        return None if flat is None else base_of(flat)

    @cached_property
    def relative(self) -> Coordinates | None:
        """The states as they are seen from the base; None where it does not move."""
        flat = self.replay.imposed.get(BASE)
        return None if flat is None else coordinates(seen(flat, self.run.x), self.mechanism.layout)

    @cached_property
    def joints(self) -> Joints:
        """Joint positions and rates, (T, n_i) for each leg."""
        return joints_of(self.system)

    @cached_property
    def leg_elastic(self) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
        """Elastic coordinates of the legs and their rates, (T, N_i) for each leg."""
        places = self.mechanism.layout.by_leg[1]
        e, ed = (tuple(s[:, at] for at in places) for s in (self.state.s, self.state.sd))
        return e, ed

    @cached_property
    def paths(self) -> Paths:
        """The legs as points and axes in the world."""
        return leg_paths(self.system)

    @cached_property
    def energies(self) -> Energies:
        """Energies (T,) J."""
        return energies(self.system)

    @cached_property
    def acceleration(self) -> Array:
        """(T, 6) of the platform frame, resolved in its axes: the rates of the twist, and ω × v."""
        twist, found = self.state.twist, self.replay.rate[:, self.mechanism.layout.at.twist].copy()
        found[:, :3] += np.cross(twist[:, 3:], twist[:, :3])
        return found

    @cached_property
    def elastic_acceleration(self) -> Array:
        """(T, N)."""
        return self.replay.rate[:, self.mechanism.layout.at.elastic_rate]

    @cached_property
    def wanted(self) -> Sample | None:
        """The motion in the world that was to be followed, if one was."""
        way, flat = self.controller.trajectory, self.replay.imposed.get(BASE)
        if way is None:
            return None
        sample = way.sample(self.t)
        return carried_motion(flat, sample) if flat is not None and self.controller.seen_from_base else sample

    @cached_property
    def wanted_joints(self) -> Array | None:
        """The actuated joints (T, m) that were to be taken, if some were."""
        return self.controller.wanted_joints(self.t)

    @cached_property
    def attachment_deformation(self) -> Array:
        """(T, k, 3) m, in platform axes."""
        body = self.robot.platform
        shapes = body.shapes[:, list(body.attachments)]  # (N, k, 3)
        return np.einsum("tn,nka->tka", self.state.elastic, shapes)
