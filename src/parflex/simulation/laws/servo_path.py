"""A trajectory as the legs' servos read it: the robot's bend along it, and whether the legs reach."""

from functools import partial
from itertools import pairwise

import numpy as np

from parflex.analysis.equilibrium import at_rest
from parflex.analysis.health import check_legs
from parflex.base.array import Array
from parflex.mechanics.system import System, health
from parflex.model.core import Core
from parflex.robot.state import State
from parflex.simulation.laws.servo_motion import reference
from parflex.simulation.trajectory import Trajectory, check_along, told_at

SAME = 1e-12  # m, and of the entries of rotations: poses that differ by round-off
INSTANTS = 50  # in each segment, at which the legs' reach is looked at


def sagging(core: Core, way: Trajectory) -> Array:
    """The numbers behind the segments in a servo's rows (n, 2 + 2 b): start, span, bend and its change.

    The bends are those of the equilibria in the poses where segments meet.
    """
    times = way.starts[1:]
    poses = np.stack([np.append(*way.sample(time)[:2]) for time in times])
    _, first, place = np.unique(np.round(poses, 12), axis=0, return_index=True, return_inverse=True)
    found = np.stack([bend_at(core, way, time) for time in times[first]])[np.ravel(place)]
    bend = np.concatenate([found[:1], found])
    change = np.concatenate([0 * found[:1], np.diff(found, axis=0), 0 * found[:1]])
    start = np.append(times[0], times)
    span = np.concatenate([[1.0], np.diff(times), [1.0]])
    return np.hstack([start[:, None], span[:, None], bend, change])


def bend_at(core: Core, way: Trajectory, time: float) -> Array:
    """The bend (b,) of platform and legs in the equilibrium at a time; raises as `at_rest`, with that."""
    pose, home, at = way.sample(time), core.robot.home, core.mechanism.layout.at
    apart = np.append(pose.position - home.position, pose.rotation - home.rotation)
    with told_at(time):
        if np.max(np.abs(apart)) <= SAME:
            x = core.at_home.x
        else:
            x, _ = at_rest(core.readable, "trajectory", State(pose.position, pose.rotation))
    return np.concatenate([x[at.elastic], x[at.joints]])


def wanted_system(core: Core, way: Trajectory, rows: Array, t: Array) -> System:
    """The robot where a servo with these rows wants it at times t (T,)."""
    layout = core.mechanism.layout
    home = core.flat(core.robot.home)[layout.at.branches]
    row = rows[way.starts.searchsorted(t, side="right") - 1]
    with np.errstate(invalid="ignore", divide="ignore"):
        return reference(core.mechanism, t, row, np.broadcast_to(home, (len(t), len(home))))[0]


def check_reach(core: Core, way: Trajectory, rows: Array) -> None:
    """Raise OutOfReach or SingularPose, with the time, where a leg cannot follow a trajectory."""
    stretches = pairwise(np.append(way.starts[1:], way.duration))
    t = np.unique(np.concatenate([np.linspace(*ends, INSTANTS) for ends in stretches]))
    found = health(wanted_system(core, way, rows, t))
    check_along(partial(check_legs, core.mechanism), t, found)
