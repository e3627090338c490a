"""The motion of the actuated joints along a trajectory: lengths of struts, angles of cranks."""

from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from parflex.analysis.health import check_finite, check_health, single
from parflex.base.array import Array, join
from parflex.base.check import finite, of_type
from parflex.base.errors import InputError
from parflex.kernels import joints as kernels
from parflex.kernels.kernel import Vectors
from parflex.kernels.segment import Sample, along
from parflex.mechanics.mechanism import Mechanism
from parflex.model.core import Core, core_of
from parflex.model.model import Model
from parflex.robot.state import State
from parflex.simulation.trajectory import Trajectory, check_along

BLOCK = 4096  # instants at once, whose numbers the processor's cache holds


class LegMotion(NamedTuple):
    """The actuated joints at instants (…,), in the order of the forces, each (…, m); m and rad, s."""

    positions: Array
    rates: Array
    accelerations: Array


def leg_motion(
    model: Model, trajectory: Trajectory, t: ArrayLike, *, state: State | None = None
) -> LegMotion:
    """Positions, rates and accelerations of the actuated joints along a trajectory, at times t (…,) s.

    Platform and legs are bent as in `state` and at rest in their bend, by default undeformed. Legs with two
    branches stand on those that the state names, and joints that are carried are looked for from its own.
    Its pose is not looked at. Angles are continuous in t, where it has several instants in half a turn.

    A robot of fewer than six freedoms needs a trajectory that its legs allow. Accelerations of joints that
    are carried are those of least squares at the tips; they are exact where the closure holds.

    Raises InputError for a batch of states, for a pose that the legs do not allow, and where tips leave
    carried joints free; OutOfReach and SingularPose where a leg's inverse geometry fails.

    >>> import parflex as pf
    >>> model = pf.Model(pf.robots.gough_stewart(modes=0), "numpy")
    >>> up = model.robot.home.position + (0, 0, 0.1)
    >>> way = pf.Trajectory.of(model.robot.home, [pf.MoveTo(up, duration=0.5)])
    >>> leg_motion(model, way, [0.0, 0.25, 0.5]).positions.shape
    (3, 6)
    """
    core, times = core_of(model), finite("t", t)
    of_type("trajectory", trajectory, Trajectory)
    check_determined(core.mechanism)
    like = core.robot.home if state is None else state
    single("state", core.flat(like))
    order = np.argsort(times, axis=None, kind="stable")
    ordered = np.ravel(times)[order]
    parts = [ordered[i : i + BLOCK] for i in range(0, max(1, len(ordered)), BLOCK)]
    found = [moved(core, trajectory, part, like) for part in parts]
    q, qd, qdd = (np.concatenate([block[name] for block in found]) for name in LegMotion._fields)
    back, shape = np.argsort(order), (*times.shape, core.mechanism.n_forces)
    return LegMotion(*(a[back].reshape(shape) for a in (continuous(core.mechanism, q), qd, qdd)))


def moved(core: Core, trajectory: Trajectory, t: Array, like: State) -> Vectors:
    """The answers of the kernel at times (T,), checked."""
    rows, x = trajectory.rows(t), core.flat(replace(like, elastic_rate=0.0, leg_elastic_rate=None))
    if any(core.mechanism.layout.joints):
        x = carrying(core, along(rows, t), like)
    found = core.functions(kernels.leg_motion)(x=x, time=t[:, None], row=rows)
    check_along(partial(check_health, core.mechanism), t, found["health"])
    check_finite(found["accelerations"])
    return found


def carrying(core: Core, wanted: Sample, like: State) -> Array:
    """The flat states (T, size) of a motion: carried joints found from those of a state, soft tips closed, on
    its branches."""
    layout, branches = core.mechanism.layout, core.mechanism.layout.at.branches
    firm = [n > 0 and not leg.soft for leg, n in zip(core.robot.legs, layout.joints, strict=True)]
    given = like.joints and [q if own else None for q, own in zip(like.joints, firm, strict=True)]
    pose = wanted.position, wanted.rotation, wanted.twist
    near = State(*pose, like.elastic, joints=given, leg_elastic=like.leg_elastic)
    x = core.flat(near)
    return join([x[..., : branches.start], core.flat(like)[branches]])


def continuous(mechanism: Mechanism, q: Array) -> Array:
    """Positions (T, m) whose angles do not jump by full turns."""
    turning = np.flatnonzero(~mechanism.slides[mechanism.driven][mechanism.force_order])
    angles = q[:, turning]
    return q + (np.unwrap(angles, axis=0) - angles) @ np.eye(q.shape[1])[turning]


def check_determined(mechanism: Mechanism) -> None:
    """Raise InputError where a leg that carries its joints has more than its tips have coordinates."""
    for group in mechanism.groups:
        tips = 3 * len(group.tip_frames)
        if group.type.carries and group.chain.n > tips:
            raise InputError(
                f"leg {group.legs[0] + 1} has {group.chain.n} joints, and its tips have {tips} coordinates: "
                f"a trajectory does not determine how they move"
            )
