"""A trajectory as the legs' servos read it: how the robot sags along it, and whether the legs reach."""

from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np

from parflex.analysis.equilibrium import at_rest
from parflex.analysis.health import check_legs
from parflex.base.array import Array, join
from parflex.mechanics.dynamics import frozen_inverse
from parflex.mechanics.flat_state import flat_state
from parflex.mechanics.held import held
from parflex.mechanics.system import actuated_positions, assembled, health
from parflex.model.core import Core
from parflex.robot.state import State
from parflex.simulation.laws.joint_pd import way_to
from parflex.simulation.laws.servo_motion import Reference, reference
from parflex.simulation.trajectory import Trajectory, check_along, told_at

SAME = 1e-12  # m, and of the entries of rotations: poses that differ by round-off
INSTANTS = 50  # in each segment, at which the legs' reach is looked at


def sagging(core: Core, way: Trajectory) -> Array:
    """The numbers behind the segments in a servo's rows (n, 2 + 2 b): start, span, sag and its change.

    The sags are those of the equilibria in the poses where segments meet.
    """
    times = way.starts[1:]
    poses = np.stack([np.append(*way.sample(time)[:2]) for time in times])
    _, first, place = np.unique(np.round(poses, 12), axis=0, return_index=True, return_inverse=True)
    found = np.stack([sag_at(core, way, time) for time in times[first]])[np.ravel(place)]
    sag = np.concatenate([found[:1], found])
    change = np.concatenate([0 * found[:1], np.diff(found, axis=0), 0 * found[:1]])
    start = np.append(times[0], times)
    span = np.concatenate([[1.0], np.diff(times), [1.0]])
    return np.hstack([start[:, None], span[:, None], sag, change])


def sag_at(core: Core, way: Trajectory, time: float) -> Array:
    """The sag (b,) in the equilibrium at a time: the bend of platform and legs, and, where tips are soft, how
    far the actuated joints and their forces are from those of a robot whose tips hold; raises as `at_rest`,
    with the time."""
    pose, home, at = way.sample(time), core.robot.home, core.mechanism.layout.at
    apart = np.append(pose.position - home.position, pose.rotation - home.rotation)
    with told_at(time):
        if np.max(np.abs(apart)) <= SAME:
            x, forces = core.at_home.x, core.at_home.forces
        else:
            x, forces = at_rest(core.readable, "trajectory", State(pose.position, pose.rotation))
        return sag_of_tips(core, x, forces) if core.mechanism.soft else join([x[at.elastic], x[at.joints]])


def sag_of_tips(core: Core, x: Array, forces: Array) -> Array:
    """The sag (b,) of a robot with soft tips in an equilibrium x (size,) under forces (m,)."""
    firm = held(core.mechanism)
    y = flat_state(firm, replace(core.state(x), joints=None, joint_rates=None))
    own, held_up = assembled(core.mechanism, x), assembled(firm, y)
    further = way_to(firm, actuated_positions(own) - actuated_positions(held_up))
    more = forces - frozen_inverse(held_up, np.zeros(6))[0]
    return join([y[firm.layout.at.elastic], y[firm.layout.at.joints], further, more])


def wanted(core: Core, way: Trajectory, rows: Array, t: Array) -> Reference:
    """The references of a servo with these rows at times t (T,)."""
    layout = core.mechanism.layout
    home = core.flat(core.robot.home)[layout.at.branches]
    row = rows[way.starts.searchsorted(t, side="right") - 1]
    with np.errstate(invalid="ignore", divide="ignore"):
        return reference(core.mechanism, t, row, np.broadcast_to(home, (len(t), len(home))))


def check_reach(core: Core, way: Trajectory, rows: Array) -> None:
    """Raise OutOfReach or SingularPose, with the time, where a leg cannot follow a trajectory."""
    stretches = pairwise(np.append(way.starts[1:], way.duration))
    t = np.unique(np.concatenate([np.linspace(*ends, INSTANTS) for ends in stretches]))
    system = wanted(core, way, rows, t).system
    check_along(partial(check_legs, system.mechanism), t, health(system))
