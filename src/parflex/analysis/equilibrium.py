"""Static equilibrium: platform and legs bend until all forces balance.

Damped Newton with the exact stiffness of `statics.py`, for the bend, the carried coordinates of the legs, and
either the forces of the actuators, where a pose or the actuated joints are given, or the pose, where the
forces are.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from parflex.analysis.buckling import check_stability
from parflex.analysis.health import check_health, on_closure, single
from parflex.analysis.mobility import freed_twist, motions, null_space, rank, scaled_tips, show, span
from parflex.analysis.statics import Statics, firmness, held_load, loose_twist, statics, stiffness
from parflex.base.array import Array
from parflex.base.check import of_type
from parflex.base.errors import InputError, NotConverged
from parflex.compiled.functions import Functions
from parflex.mechanics.closure import ALL, CLOSED, LARGEST_TURN, closed, displaced
from parflex.mechanics.derivatives.changes import Load
from parflex.mechanics.flat_state import projected, state_of
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.system import examined
from parflex.robot.layout import Layout
from parflex.robot.state import State
from parflex.robot.wrench import Wrench

STEPS = 40
SETTLED = 1e-18  # of the platform's size: a step that is round-off
NEARLY = 1e-9  # of it: a step that may be the last, where round-off leaves no shorter one
SHORTEST = 1e-3  # of a Newton step
NEUTRAL = 1e-10  # of the largest stiffness: motions along which nothing pulls
BALANCED = 1e-9  # of the largest force

Hold = Callable[[Statics], Array]  # rows (c, d) of motions that are not free


class Step(NamedTuple):
    """A step of Newton's method at a flat state, its length in metres, and the forces (m,) there."""

    at: Statics
    motion: Array  # (6 + N + z,)
    length: float
    forces: Array


def equilibrium(
    mechanism: Mechanism,
    start: Array,
    moved: Callable[[Array, Array], Array],
    hold: Hold | None,
    load: Load,
    forces: Array,
) -> tuple[Array, Array]:
    """The flat state at rest, and the actuator forces (m,) that hold it, from a flat state and forces.

    `moved` takes a flat state and a displacement to a flat state on the closure. The forces are sought for
    where some motions are held, else they stay.

    Raises InputError for a mode without stiffness, NotConverged where no forces hold the platform, where what
    bends is too soft, or where a leg buckles.
    """
    check_firm(mechanism)
    now = first = newton_step(mechanism, start, hold, load, forces)
    for _ in range(STEPS):
        if now.length <= SETTLED * mechanism.size:
            break
        later = shortened(mechanism, now, moved, hold, load)
        if later is None:
            break
        now = later
    check_found(mechanism, first, now, hold, load)
    return now.at.x, now.forces


def check_firm(mechanism: Mechanism) -> None:
    """Raise InputError for a mode without stiffness."""
    bends = np.concatenate([np.full(mechanism.platform.modes, True), mechanism.bends])
    if not np.all(firmness(mechanism)[6:][bends] > 0):
        raise InputError("a mode has zero frequency; without stiffness there is no equilibrium")


def newton_step(mechanism: Mechanism, x: Array, hold: Hold | None, load: Load, forces: Array) -> Step:
    """The step from a flat state, by H at the forces there; where motions are held with the shortest forces
    that leave nothing along them."""
    at = statics(mechanism, x, load)
    free = np.eye(len(at.push)) if hold is None else null_space(hold(at))
    H = stiffness(at, forces, load) if free.shape[1] else np.zeros((len(free), len(free)))
    lengths = np.linalg.norm(H @ free, axis=0)
    firm = lengths > NEUTRAL * max(
        float(np.max(lengths, initial=0.0)), float(np.max(np.abs(at.push), initial=0.0)) / mechanism.size
    )
    free, lengths = free[:, firm], lengths[firm]
    soft = H @ free / lengths
    if hold is not None:
        rest = null_space(soft.T).T
        forces = np.linalg.lstsq(rest @ at.drive, -rest @ at.push, rcond=1e-10)[0]
    eased = np.linalg.lstsq(soft, at.push + at.drive @ forces, rcond=1e-12)[0]
    zeta = free @ (eased / lengths)
    length = float(np.max(np.abs(at.basis @ zeta), initial=0.0))
    longest = LARGEST_TURN * mechanism.size
    return Step(at, at.T @ (zeta * min(1.0, longest / max(length, 1e-300))), length, forces)


def shortened(
    mechanism: Mechanism, now: Step, moved: Callable[[Array, Array], Array], hold: Hold | None, load: Load
) -> Step | None:
    """The step after the longest part of a step that is followed by a shorter one; None where none is."""
    part = 1.0
    while part >= (1.0 if now.length <= NEARLY * mechanism.size else SHORTEST):
        try:
            later = newton_step(mechanism, moved(now.at.x, part * now.motion), hold, load, now.forces)
            if later.length < now.length:
                return later
        except (InputError, np.linalg.LinAlgError):  # out of reach, or off the closure
            pass
        part /= 4
    return None


def check_found(mechanism: Mechanism, first: Step, now: Step, hold: Hold | None, load: Load) -> None:
    """Raise NotConverged where the last step is not round-off, or ends where nothing lasts.

    The load at which a leg buckles is told as it is at the start, where the leg is straight.
    """
    try:
        if not now.length <= NEARLY * mechanism.size:
            raise NotConverged(not_found(first.at.system.x.position, hold, now.length))
        check_balance(mechanism, now, hold)
        check_stability(now.at, now.forces, load)
    except NotConverged:
        twist = loose_twist(now.at)
        if twist is not None:
            raise NotConverged(
                f"the platform's soft tips carry nothing along the twist (v, ω) = {show(twist)}, along which "
                f"nothing else holds it; give them Flexure.translation there"
            ) from None
        if hold is not None:
            check_stability(first.at, first.forces, load)
        raise


def not_found(place: Array, hold: Hold | None, left: float) -> str:
    """The words for what was looked for with Σp at a place (3,), what remains, and the remedy."""
    if hold is None:
        return (
            f"no equilibrium under these forces was found from the guess, Σp at {show(place)} m: a step of "
            f"{left:.2g} m remains; give a guess nearer to it, or forces that balance the weight"
        )
    return (
        f"no equilibrium with Σp at {show(place)} m was found near the undeformed robot: a step of "
        f"{left:.2g} m remains; it is too soft for its weight and loads at this pose: raise its frequencies "
        f"or move the pose"
    )


def check_balance(mechanism: Mechanism, now: Step, hold: Hold | None) -> None:
    """Raise NotConverged where forces are left along motions that nothing holds."""
    left = now.at.push + now.at.drive @ now.forces
    largest = max(1.0, float(np.max(np.abs(now.at.push), initial=0.0)))
    if np.max(np.abs(left), initial=0.0) > BALANCED * largest:
        none = "no actuator forces hold the platform in this pose" if hold else "these forces hold it nowhere"
        raise NotConverged(
            f"{none}; nothing carries its weight along the "
            f"twist (v, ω) = {show(freed_twist(mechanism, now.at.x))}, nearest to a parallel singularity"
        )


def held_pose(at: Statics) -> Array:
    """Rows (c, d) of the motions of Σp that the legs allow without bending, soft tips at their points."""
    if at.system.mechanism.soft:
        held: Array = span(stiff_motions(at.system.mechanism, at.x)) @ at.basis[:6]
        return held
    first = 6 + at.system.mechanism.platform.modes
    bends = np.concatenate([np.arange(6, first), first + np.flatnonzero(at.system.mechanism.bends)])
    rigid = at.basis @ null_space(at.basis[bends])
    found: Array = span(rigid[:6]) @ at.basis[:6]
    return found


def stiff_motions(mechanism: Mechanism, x: Array) -> Array:
    """Motions (6, d) of Σp, angular rows in metres, that the legs allow where nothing gives."""
    return motions(mechanism, scaled_tips(mechanism, x)).platform


def held_joints(at: Statics) -> Array:
    """Rows (m, d) of the actuated joints."""
    lengths = np.linalg.norm(at.drive, axis=0)
    return (at.drive / np.where(lengths > 0, lengths, 1.0)).T


def at_rest(
    functions: Functions, name: str, state: State, wrenches: Sequence[Wrench] = ()
) -> tuple[Array, Array]:
    """The equilibrium at the pose of a state, as a flat state, and the forces (m,) that hold it.

    Joints that the state names are a start. Raises InputError for a batch, NotConverged as `equilibrium`, and
    as `Model.direct` where the pose is none.
    """
    mechanism = functions.solvable
    of_type(name, state, State)
    still = State(state.position, state.rotation, joints=state.joints)
    start = single(name, on_closure(mechanism, still))
    check_health(mechanism, examined(mechanism, start)[1])

    sags = mechanism.soft and rank(stiff_motions(mechanism, start)) < 6  # along what only soft tips hold

    def moved(x: Array, motion: Array) -> Array:
        there = displaced(mechanism, x, motion)
        there = there if sags else bent(mechanism, start, there)
        return projected(mechanism, state_of(mechanism, there))

    none = np.zeros(mechanism.n_forces)
    return equilibrium(mechanism, start, moved, held_pose, held_load(mechanism, wrenches), none)


def under_forces(
    functions: Functions, forces: Array, guess: State, wrenches: Sequence[Wrench] = ()
) -> tuple[Array, Array]:
    """The equilibrium under actuator forces (m,), as a flat state, from a guess at rest.

    Raises as `at_rest`.
    """
    mechanism = functions.solvable
    of_type("guess", guess, State)
    start = single("guess", on_closure(mechanism, guess.still))
    check_health(mechanism, examined(mechanism, start)[1])

    def moved(x: Array, motion: Array) -> Array:
        found, gap = closed(mechanism, displaced(mechanism, x, motion), ALL)
        if not gap <= 10 * CLOSED * mechanism.size:
            raise NotConverged(f"a gap of {gap:.1e} m remains")
        check_health(mechanism, examined(mechanism, found)[1])
        return found

    return equilibrium(mechanism, start, moved, None, held_load(mechanism, wrenches), forces)


def bent(mechanism: Mechanism, x: Array, like: Array) -> Array:
    """The flat state with the bend and the carried coordinates of another."""
    layout: Layout = mechanism.layout
    other = np.array(x)
    for part in (layout.at.elastic, layout.at.joints):
        other[part] = like[part]
    return other
