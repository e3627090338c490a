"""The core of a model, which the rest of the library reads: mechanism, compiled functions, checked states."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from parflex.analysis.health import check_health, check_state
from parflex.analysis.small_motions import SmallMotions, about
from parflex.base.array import Array, split
from parflex.base.check import of_type
from parflex.base.errors import InputError
from parflex.compiled import choose
from parflex.compiled.functions import Functions
from parflex.kernels import joints as kernels
from parflex.kernels.moved_base import with_base
from parflex.mechanics.designs import rebuilt
from parflex.mechanics.flat_state import flat_state, state_of
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.ordering import Joints, by_leg
from parflex.mechanics.rests import rested
from parflex.mechanics.system import System, closing_forces, examined, joint_reactions, leg_accelerations
from parflex.robot.base_motion import BaseMotion
from parflex.robot.parameters import Parameters
from parflex.robot.robot import Robot
from parflex.robot.state import State


@dataclass(frozen=True, eq=False)
class Core:
    """A mechanism and its compiled functions, at some values of the parameters."""

    mechanism: Mechanism
    functions: Functions

    @property
    def robot(self) -> Robot:
        """The robot itself."""
        return self.mechanism.robot

    @cached_property
    def readable(self) -> Functions:
        """The functions on NumPy: for what is asked once, and not worth compiling."""
        return Functions(self.mechanism, choose("numpy"), Parameters(self.robot, ()))

    @cached_property
    def at_home(self) -> SmallMotions:
        """The small motions about the equilibrium at home; raises as `equilibrium.at_rest`."""
        return about(self.readable, self.robot.home)

    def at(self, theta: Array) -> "Core":
        """The core at other values θ (P,) of the parameters; it shares all compiled functions.

        Raises InputError for values that the robot itself would refuse.
        """
        mechanism = rested(rebuilt(self.functions.parameters, theta))
        mechanism = replace(mechanism, base=self.mechanism.base)
        return Core(mechanism, self.functions.at(mechanism, theta))

    def on(self, base: BaseMotion | None) -> "Core":
        """The core on a base that moves so; itself without one."""
        if base is None:
            return self
        flat = of_type("base", base, BaseMotion).flat
        mechanism = with_base(self.mechanism, flat)
        return Core(mechanism, self.functions.on(mechanism, flat))

    def weighed(self, acceleration: Array, rotation: Array) -> "Core":
        """The core at rest, seen from a base of such axes (3, 3) whose acceleration (3,) adds to gravity,
        as far as equilibria read it."""
        gravity = rotation.T @ (self.mechanism.gravity - acceleration)
        mechanism = replace(self.mechanism, gravity=gravity)
        return Core(mechanism, self.functions.weighed(mechanism))

    def flat(self, state: State) -> Array:
        """The flat state (…, size), as `flat_state`; one for each motion of a base, where these are many."""
        return flat_state(self.mechanism, state)

    def state(self, x: Array) -> State:
        """The state of a flat vector (…, size), as `state_of`."""
        return state_of(self.mechanism, x)

    def check(self, x: Array, found: Array) -> None:
        """Raise an error where the flat state, by its health, is not one of the robot."""
        check_state(self.functions, x, found)

    def system(self, state: State) -> System:
        """The mechanics at a state or a batch of them: legs, platform, closure.

        Raises InputError for a state off the closure, OutOfReach and SingularPose where a leg's inverse
        geometry fails.
        """
        system, health = examined(self.mechanism, self.flat(state))
        check_health(self.mechanism, health)
        return system


def made(robot: Robot, backend: str, parameters: Sequence[str]) -> Core:
    """The core of a robot; raises InputError for an unknown backend or parameter."""
    mechanism = rested(of_type("robot", robot, Robot))
    return Core(mechanism, Functions(mechanism, choose(backend), Parameters(robot, parameters)))


def joints_at(core: Core, state: State) -> Joints:
    """Positions and rates of the legs' joints at a state; raises as `Core.system`."""
    found = core.functions(kernels.joints).run(x=core.flat(state))
    check_health(core.mechanism, found["health"])
    counts = [(len(leg.joints),) for leg in core.robot.legs]
    return Joints(*(tuple(split(found[name], counts)) for name in ("q", "qd")))


class HasCore(Protocol):
    """A model, seen from below."""

    _core: Core


def core_of(model: HasCore) -> Core:
    """The core of a model; raises InputError where it is none."""
    if not isinstance(getattr(model, "_core", None), Core):
        raise InputError(f"model is {type(model).__name__}; expected a Model")
    return model._core


class LegsMoved(NamedTuple):
    """The mechanics at a state, z̈ (…, L, z) and contact forces (…, 3k), both group by group."""

    system: System
    zdd: list[Array]
    contact: Array

    @property
    def joints(self) -> tuple[Array, ...]:
        """q̈, one (…, n_i) per leg."""
        legs = zip(self.system.legs, self.zdd, strict=True)
        return by_leg(self.system.mechanism, [zdd[..., : leg.group.chain.n] for leg, zdd in legs])

    @property
    def elastic(self) -> tuple[Array, ...]:
        """ë of flexible links, one (…, N_i) per leg."""
        legs = zip(self.system.legs, self.zdd, strict=True)
        return by_leg(self.system.mechanism, [zdd[..., leg.group.chain.n :] for leg, zdd in legs])

    @property
    def reactions(self) -> list[tuple[Array, Array]]:
        """Forces and moments (…, L, n, 3) at the joints, group by group."""
        return joint_reactions(self.system, self.zdd, self.contact)


def legs_moved(
    core: Core, state: State, forces: ArrayLike, contact: Array, theta: Array | None = None
) -> LegsMoved:
    """The legs under forces (…, m) and the contact forces (…, k, 3), by attachment, that go with them, at
    values θ (P,) of the parameters, by default the model's.

    Raises InputError for a batch of values.
    """
    if theta is not None and not np.array_equal(theta, core.functions.theta):
        if theta.ndim > 1:
            raise InputError(
                f"parameters are a batch {theta.shape[:-1]}; the legs' accelerations are known for one value "
                f"of each: ask model.with_parameters(…) for each"
            )
        core = core.at(theta)
    system, held = core.system(state), core.mechanism.attachments
    f = closing_forces(system, contact[..., held, :].reshape((*contact.shape[:-2], 3 * len(held))))
    return LegsMoved(system, leg_accelerations(system, np.asarray(forces, dtype=float), f), f)
