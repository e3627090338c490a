"""The states at which the models do not exist: legs out of reach, states off the closure, locked legs."""

import math

import numpy as np

from parflex.base.array import Array
from parflex.base.check import index_of
from parflex.base.errors import NO_INERTIA, InputError, NotConverged, OutOfReach, SingularPose
from parflex.compiled.functions import Functions
from parflex.kernels import models
from parflex.mechanics.flat_state import flat_state, projected
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.system import examined
from parflex.robot.state import State

SINGULAR = 1e-8  # smallest acceptable ratio of singular values, lengths scaled by the platform's
LOCKED = 1e-12  # of eigenvalues of the contact system, which go with the squares of the closure's
OFF = 1e-6  # m per metre of platform, and m/s: the largest gap between a tip and its attachment


def on_closure(mechanism: Mechanism, state: State) -> Array:
    """The flat state (…, size) on the closure nearest to a state.

    Raises NotConverged where there is none near, OutOfReach and SingularPose where a leg is why.
    """
    try:
        return projected(mechanism, state)
    except NotConverged:
        check_legs(mechanism, examined(mechanism, flat_state(mechanism, state))[1])
        raise


def single(name: str, x: Array) -> Array:
    """The flat state; raises InputError for a batch."""
    if x.ndim > 1:
        raise InputError(f"{name} is a batch {x.shape[:-1]}; give one state at a time")
    return x


def check_state(functions: Functions, x: Array, health: Array) -> None:
    """Raise an error where the flat state (…, size), by its `system.health` (…, h), is not one of the robot.

    Raises OutOfReach and SingularPose where a leg's inverse geometry fails, InputError off the closure,
    SingularPose where the closure loses a row.
    """
    check_health(functions.mechanism, health)
    if not functions.mechanism.closed:
        check_locking(functions(models.contact_matrix).run(x=x)["matrix"])


def check_health(mechanism: Mechanism, health: Array) -> None:
    """Raise an error where a state is not one of the robot, as `check_legs` and `check_gaps` do."""
    check_legs(mechanism, health)
    check_gaps(mechanism, health)


def check_gaps(mechanism: Mechanism, health: Array) -> None:
    """Raise InputError where a tip is not at its attachment, or leaves it."""
    at, limit = mechanism.health, OFF * min(1.0, mechanism.size)
    every = health[..., at.gap.start :]
    if every.size == 0 or np.max(np.abs(every)) <= limit:
        return
    for part, what, unit in ((at.gap, "", "m"), (at.gap_rate, " velocity", "m/s")):
        gaps = np.abs(health[..., part])
        bad = gaps > limit
        if np.any(bad):
            leg = int(at.gap_legs[np.argwhere(bad)[0][-1]])
            first = tuple(np.argwhere(np.any(bad, axis=-1))[0]) if bad.ndim > 1 else ()
            size = np.max(gaps[first][at.gap_legs == leg])
            carried = mechanism.layout.joints[leg] > 0
            raise off_closure(carried, leg, what, size, unit, bad)


def off_closure(carried: bool, leg: int, what: str, gap: float, unit: str, bad: Array) -> InputError:
    """The error of a state that the legs do not allow."""
    where = index_of(np.any(bad, axis=-1))
    if carried and not what:
        return OutOfReach(
            f"state{where}: no joints of leg {leg + 1} were found that reach its attachment, a gap of "
            f"{gap:.2g} m remains; move the pose, or give State.joints near the solution"
        )
    return InputError(
        f"state{where} is off the closure: a gap{what} of {gap:.2g} {unit} between leg {leg + 1} and its "
        f"attachment, since the legs leave the platform fewer than six freedoms; take the nearest state "
        f"that they allow, model.project(state)"
    )


def check_reach(mechanism: Mechanism, health: Array) -> None:
    """Raise OutOfReach where a leg cannot reach its tip; singular legs are not looked at."""
    if not np.all(health[..., mechanism.health.reach] >= 0):
        check_legs(mechanism, health)


def check_legs(mechanism: Mechanism, health: Array) -> None:
    """Raise an error where a leg cannot reach its tip (OutOfReach) or is singular there (SingularPose), or
    where a flexure is nearly turned about (InputError)."""
    at = mechanism.health
    margins = health[..., at.margins]
    if margins.size == 0 or margins.min() > SINGULAR:
        return
    less = ", or bend its links less" if np.any(mechanism.bends) else ""
    for part, error, what in (
        (at.reach, OutOfReach, f"cannot reach its attachment; move the pose or the base{less}"),
        (at.regularity, SingularPose, "is singular (its passive joints lock); move the pose"),
    ):
        bad = ~(health[..., part] > SINGULAR)
        if np.any(bad):
            where = index_of(np.any(bad, axis=-1))
            raise error(f"pose{where}: leg {np.argwhere(bad)[0][-1] + 1} {what}")
    bad = ~(health[..., at.open] > SINGULAR)
    if np.any(bad):
        where, leg = index_of(np.any(bad, axis=-1)), at.open_legs[np.argwhere(bad)[0][-1]] + 1
        raise InputError(
            f"pose{where}: the flexure at a tip of leg {leg} is within 5 degrees of half a turn from its "
            f"rest, where its energy has no bound; move the pose, or give Flexure.rest near to it"
        )


def check_finite(answer: Array) -> None:
    """Raise SingularPose where the mechanics itself has no answer, though every leg is regular."""
    if not np.isfinite(answer).all():
        where = index_of(~np.all(np.isfinite(answer), axis=-1))
        raise SingularPose(f"at the state{where}, {NO_INERTIA}")


def check_locking(by_rows: Array) -> None:
    """Raise SingularPose where the closure loses a row, by the matrix (…, r r) of the contact system.

    There the legs let the platform go along some twist, or press against each other without end.
    """
    check_finite(by_rows)
    rows = math.isqrt(by_rows.shape[-1])
    matrix = by_rows.reshape(by_rows.shape[:-1] + (rows, rows))
    scale = 1.0 / np.sqrt(np.einsum("...ii->...i", matrix))
    values = np.linalg.eigvalsh(scale[..., :, None] * matrix * scale[..., None, :])
    bad = ~(values[..., 0] > LOCKED * values[..., -1])
    if np.any(bad):
        raise SingularPose(
            f"pose{index_of(bad)} is a constraint singularity: the legs no longer hold the platform against "
            f"some motion that they hold elsewhere (model.mobility names it); move the pose"
        )
