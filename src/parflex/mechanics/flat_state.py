"""States as the flat vectors that the models read, and back: the first thing that every call does.

A state of a robot with lower mobility, or with joints of its own, satisfies the closure or is no state.
"""

from dataclasses import replace

import numpy as np

from parflex.base.array import Array
from parflex.base.check import broadcast_together, of_type
from parflex.base.errors import InputError, NotConverged
from parflex.base.spatial import within_half_a_turn
from parflex.mechanics.closure import ALL, CLOSED, JOINTS, POSE, closed, with_rates
from parflex.mechanics.legs.base import LegGroup, joints_at, tips_at
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.ordering import joints_of
from parflex.mechanics.system import examined
from parflex.robot.layout import checked_flat, pack, unpack
from parflex.robot.leg import Leg
from parflex.robot.robot import Robot
from parflex.robot.state import State

FAR = 0.5  # rad, between a joint that is given and the closed form's: another branch

LegJoints = tuple[Array | None, ...]


def flat_state(mechanism: Mechanism, state: State) -> Array:
    """The flat state (…, size); joints that it carries are closed by Newton's method.

    Soft tips are closed too, and do not move off, where the state does not name a leg's joints or rates.

    Raises InputError where the state does not fit the robot, or its joints are on another branch.
    """
    layout = mechanism.layout
    of_type("state", state, State)
    check_joints(mechanism.robot, state)
    if any(layout.joints):
        x = on_base(mechanism, pack(started(mechanism.robot, state), layout))
        x = unstretched(mechanism, x, state) if mechanism.soft else x
        x = with_rates(mechanism, closed(mechanism, x, JOINTS)[0], JOINTS)
    else:
        x = on_base(mechanism, pack(state, layout))
    if state.joints is not None:
        x = on_branches(mechanism, x, state.joints)
        check_branch(mechanism, x, state.joints)
    return x


def on_base(mechanism: Mechanism, x: Array) -> Array:
    """Flat states, one for each motion of the base; raises InputError where they do not broadcast."""
    base = mechanism.base
    if base is None or base.position.ndim == 1:
        return x
    broadcast_together(state=x, base=base.position)
    batch = np.broadcast_shapes(x.shape[:-1], base.position.shape[:-1])
    return np.broadcast_to(x, (*batch, x.shape[-1]))


def unstretched(mechanism: Mechanism, x: Array, state: State) -> Array:
    """The flat state with soft tips closed by the joints of legs for which a state names none, and staying as
    far off by the rates of legs for which it names none.

    The legs' own geometry finds these joints; a leg that cannot reach keeps those of `x`.
    """
    layout, soft, x = (
        mechanism.layout,
        [leg.soft for leg in mechanism.robot.legs],
        x + 0.0,
    )
    nothing = (None,) * len(soft)
    open_legs, open_rates = (
        [number for number, given in enumerate(named or nothing) if soft[number] and given is None]
        for named in (state.joints, state.joint_rates)
    )
    if open_legs:
        firm = [None if off else q for off, q in zip(soft, state.joints or nothing, strict=True)]
        tight = replace(mechanism.tight, base=mechanism.base)
        held = flat_state(tight, replace(state, joints=tuple(firm), joint_rates=None))
        found = joints_of(examined(tight, held)[0]).q
        for number in open_legs:
            place, q = layout.at.joints.start + of(layout.by_leg[0][number]), found[number]
            x[..., place] = np.where(np.isfinite(q), q, x[..., place])
    if open_rates:
        held = with_rates(shut(mechanism), x, JOINTS)
        for number in open_rates:
            place = layout.at.joint_rates.start + of(layout.by_leg[0][number])
            x[..., place] = held[..., place]
    return x


def of(part: slice) -> Array:
    """The places of a slice."""
    return np.arange(part.start, part.stop)


def shut(mechanism: Mechanism) -> Mechanism:
    """The mechanism whose soft tips hold the platform as others do; itself without soft tips."""
    if not mechanism.soft:
        return mechanism
    groups = tuple(group._replace(soft=(False,) * len(group.soft)) for group in mechanism.groups)
    return replace(mechanism, groups=groups)


def state_of(mechanism: Mechanism, x: Array) -> State:
    """The state of a flat vector (…, size); with all joints where they name the branch of a leg.

    Raises InputError for a wrong length, values that are not finite, or a quaternion of length zero.
    """
    layout = mechanism.layout
    found = unpack(x, layout)
    if not layout.branched:
        return found
    legs = joints_of(examined(mechanism, checked_flat(x, layout))[0])
    return replace(found, joints=legs.q, joint_rates=legs.qd)


def projected(mechanism: Mechanism, state: State) -> Array:
    """The flat state on the closure nearest to a state: its pose is moved, or else its bend too.

    Raises NotConverged where there is none near.
    """
    x = flat_state(mechanism, state)
    for freedom in (POSE, ALL):
        found, gap = closed(mechanism, x, freedom)
        if np.all(gap <= 10 * CLOSED * mechanism.size):
            return with_rates(mechanism, found, freedom)
    raise NotConverged(
        f"no state on the closure was found near the given one: a gap of {np.max(gap):.1e} m remains at "
        f"some tip; give a pose nearer to one the robot can take, and the legs' joints with it"
    )


def started(robot: Robot, state: State) -> State:
    """The state with the legs' postures where it names no joints."""
    given = state.joints or (None,) * len(robot.legs)
    postures = [np.zeros(len(leg.joints)) if leg.posture is None else leg.posture for leg in robot.legs]
    joints = tuple(p if q is None else q for q, p in zip(given, postures, strict=True))
    return replace(state, joints=joints)


def check_joints(robot: Robot, state: State) -> None:
    """Raise InputError where the joints and elastic coordinates that a state names are not the legs'."""
    for name, counts, what in (
        ("joints", [len(leg.joints) for leg in robot.legs], "joints"),
        ("joint_rates", [len(leg.joints) for leg in robot.legs], "joints"),
        ("leg_elastic", [leg.bends for leg in robot.legs], "elastic coordinates"),
        ("leg_elastic_rate", [leg.bends for leg in robot.legs], "elastic coordinates"),
    ):
        values = getattr(state, name)
        if values is not None and len(values) != len(counts):
            raise InputError(f"State.{name} has {len(values)} entries; this robot has {len(counts)} legs")
        for number, (value, count) in enumerate(zip(values or (), counts, strict=False)):
            if value is not None and value.shape[-1] != count:
                raise InputError(
                    f"State.{name}[{number}] has shape {value.shape}; this leg has {count} {what}, so the "
                    f"last axis must be {count} long"
                )


def on_branches(mechanism: Mechanism, x: Array, joints: LegJoints) -> Array:
    """The flat state with the branches that joints name, of legs whose branch is an entry of it."""
    start = mechanism.layout.at.branches.start
    for group in mechanism.groups:
        for leg, place in zip(group.legs, group.branched, strict=True):
            if place.size and (q := joints[leg]) is not None:
                x = np.array(x)
                x[..., start + place[0]] = branch_at(group, leg, q)
    return x


def branch_at(group: LegGroup, leg: int, q: Array) -> Array:
    """The branch (…,), ±1, of a leg of a group with joints q (…, n)."""
    at = joints_at(group.chain, q[..., None, :])
    with np.errstate(invalid="ignore", divide="ignore"):
        return group.type.branch(group, at, tips_at(group, at))[..., group.legs.index(leg)]


def check_branch(mechanism: Mechanism, x: Array, joints: LegJoints) -> None:
    """Raise InputError where a leg with closed form stands otherwise than the joints that are given."""
    stands = joints_of(examined(mechanism, x)[0]).q
    for number, (leg, given) in enumerate(zip(mechanism.robot.legs, joints, strict=True)):
        if given is None or not leg.joints or mechanism.layout.joints[number]:
            continue
        turn = turned(leg, stands[number], given).reshape(-1, len(leg.joints))
        where = np.argwhere(turn.T > FAR)
        if len(where):
            j = where[0][0]
            raise InputError(
                f"State.joints[{number}] is on another assembly branch than leg {number + 1}: joint "
                f"{j + 1} differs by {np.nanmax(turn[:, j]):.2f} rad; leave it None, or give "
                f"the leg a posture on the branch that you want"
            )


def turned(leg: Leg, q: Array, reference: Array) -> Array:
    """The angles (…, n) rad between joints and a reference; zero for sliding ones."""
    turns = np.array([1 - joint.sigma for joint in leg.joints])
    return turns * np.abs(within_half_a_turn(q - reference))
