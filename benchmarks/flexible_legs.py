"""A Gough–Stewart robot whose cylinders and rods bend, as parflex and Exudyn both can have it.

It is the reference robot of the tests (`tests/support/flexlegs.py`) without rotors, springs and flexures, of
which Exudyn has none between bodies, and without gravity. Its cylinders bend at any rate but are straight: of
a section that is turned, on which a joint sits, the two programs have maps that differ.
"""

from dataclasses import dataclass, replace
from functools import cache, cached_property

import numpy as np
from scipy.spatial.transform import Rotation

import flexlegs
import oracle
import parflex as pf

ARRAYS = flexlegs.arrays("gs_flexlegs")
STATES = 4
WANDER = 0.05  # m, rad from home
FORCE = 100.0  # N
SHAKE = 0.01 * 150.0**2  # the size of ω² e


@dataclass(frozen=True, eq=False)
class Bending:
    """S states of the robot; in the words of `sample.Sample`, as far as programs ask for them."""

    robot: pf.Robot
    cloud: oracle.NodalPlatform  # the platform in its nodes
    platform: pf.State  # with the elastic coordinates of the legs
    forces: np.ndarray  # (S, m)

    @property
    def legs(self) -> tuple[pf.Leg, ...]:
        return self.robot.legs

    @property
    def body(self) -> pf.FlexibleBody:
        return self.robot.platform

    @property
    def gravity(self) -> np.ndarray:
        return self.robot.gravity

    @cached_property
    def model(self) -> pf.Model:
        """The readable reference."""
        return pf.Model(self.robot, "numpy")

    @cached_property
    def q(self) -> tuple[np.ndarray, ...]:
        return self.model.joints(self.platform).q

    @cached_property
    def qd(self) -> tuple[np.ndarray, ...]:
        return self.model.joints(self.platform).qd

    @cached_property
    def wanted(self) -> np.ndarray:
        """The reference's (V̇_p 6, q̈_e N, ë of leg after leg), one row per state."""
        found = self.model.direct(self.platform, self.forces)
        return np.concatenate([found.platform, found.elastic, *found.leg_elastic], axis=-1)


@cache
def robot() -> pf.Robot:
    """The reference robot with what both programs know."""
    whole = flexlegs.robot("gs_flexlegs")
    legs = [
        replace(
            leg,
            joints=tuple(replace(joint, IA=0.0, k=0.0, q_0=0.0) for joint in leg.joints),
            tips=tuple(replace(tip, flexure=None) for tip in leg.tips),
        )
        for leg in whole.legs
    ]
    return pf.Robot(legs, whole.platform, (0.0, 0.0, 0.0), whole.home_pose)


@cache
def moving() -> Bending:
    """Poses about home, with random rates of platform, modes and legs, and random forces."""
    rng, (place, axes), legs = np.random.default_rng(7), robot().home_pose, robot().legs
    turns = Rotation.from_rotvec(rng.uniform(-WANDER, WANDER, (STATES, 3))).as_matrix()
    straight = np.zeros((STATES, ARRAYS["link2_frequencies"].size))
    states = pf.State(
        place + rng.uniform(-WANDER, WANDER, (STATES, 3)),
        axes @ turns,
        rng.normal(0.0, 0.5, (STATES, 6)),
        bent(rng, "platform"),
        rng.normal(0.0, 0.5, (STATES, robot().platform.modes)),
        leg_elastic=[np.hstack([straight, bent(rng, "link3")]) for _ in legs],
        leg_elastic_rate=[rng.normal(0.0, 1.0, (STATES, sum(leg.modes))) for leg in legs],
    )
    return Bending(robot(), cloud(), states, rng.uniform(-FORCE, FORCE, (STATES, robot().n_forces)))


@cache
def at_rest() -> Bending:
    """The same poses and forces, nothing in motion."""
    states = moving().platform
    still = replace(
        states,
        twist=np.zeros_like(states.twist),
        elastic_rate=np.zeros_like(states.elastic_rate),
        leg_elastic_rate=[np.zeros_like(rate) for rate in states.leg_elastic_rate],
    )
    return replace(moving(), platform=still)


def bent(rng: np.random.Generator, name: str) -> np.ndarray:
    """Random elastic coordinates (S, N) of a body."""
    omega = ARRAYS[f"{name}_frequencies"]
    return SHAKE / omega**2 * rng.standard_normal((STATES, len(omega)))


def cloud() -> oracle.NodalPlatform:
    """The platform's nodes."""
    names = "node_positions", "node_masses", "shapes", "frequencies", "damping_ratio", "attachment_nodes"
    return oracle.nodal_platform(*(ARRAYS[f"platform_{name}"] for name in names))
