"""Assembly branches, and the joints of a state that name them."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.base.spatial import within_half_a_turn
from parflex.mechanics.legs.base import LegGroup, joints_at, tips_at
from parflex.mechanics.ordering import joints_of
from parflex.mechanics.system import examined
from parflex.robot.leg import Leg
from parflex.robot.robot import Robot
from parflex.robot.state import State

FAR = 0.5  # rad, between a joint that is given and the closed form's: another branch


def check_joints(robot: Robot, state: State) -> None:
    """Raise InputError where the joints that a state names are not those of the legs."""
    if state.joints is None and state.joint_rates is None:
        return
    counts = [len(leg.joints) for leg in robot.legs]
    for name in ("joints", "joint_rates"):
        values = getattr(state, name)
        if values is not None and len(values) != len(counts):
            raise InputError(f"State.{name} has {len(values)} entries; this robot has {len(counts)} legs")
        for number, (value, count) in enumerate(zip(values or (), counts, strict=False)):
            if value is not None and value.shape[-1] != count:
                raise InputError(
                    f"State.{name}[{number}] has shape {value.shape}; this leg has {count} joints, so the "
                    f"last axis must be {count} long"
                )


def check_branch(robot: Robot, x: Array, joints: Sequence[Array | None]) -> None:
    """Raise InputError where a leg with closed form stands otherwise than the joints that are given."""
    stands = joints_of(robot, examined(robot, x)[0]).q
    for number, (leg, given) in enumerate(zip(robot.legs, joints, strict=True)):
        if given is None or robot.layout.joints[number]:
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
    """How far joints (…, n) are turned from a reference, rad; zero for sliding ones."""
    turns = np.array([1 - joint.sigma for joint in leg.joints])
    return turns * np.abs(within_half_a_turn(q - reference))


def other_branches(robot: Robot, joints: Sequence[Array | None]) -> tuple[int, ...]:
    """Numbers of the legs without a posture whose joints (…, n_i) are on another branch than theirs.

    Of a batch the first state counts; whether the others agree is checked with the closure.
    """
    found: list[int] = []
    for group in robot.groups:
        if group.type.carries or any(joints[n] is None for n in group.legs):
            continue
        q = np.stack([first_of(joints[n]) for n in group.legs])
        found += [n for n in differing(group, q) if robot.legs[n].posture is None]
    return tuple(sorted(found))


def first_of(q: Array | None) -> Array:
    """One (n,) of a batch (…, n)."""
    every = np.asarray(q)
    return every.reshape(-1, every.shape[-1])[0] if every.size else np.zeros(every.shape[-1])


def differing(group: LegGroup, q: Array) -> list[int]:
    """Legs whose joints q (L, n) are on another branch than the group has them on."""
    at = joints_at(group.chain, q)
    with np.errstate(invalid="ignore", divide="ignore"):
        branch = group.type.branch(group, at, tips_at(group, at))
    return [group.legs[i] for i in np.flatnonzero(branch != group.branch)]


def on_branches(robot: Robot, numbers: Sequence[int], joints: Sequence[Array | None]) -> Robot:
    """The robot with these legs on the branch of the joints."""
    legs = tuple(
        replace(leg, posture=first_of(joints[n])) if n in numbers else leg for n, leg in enumerate(robot.legs)
    )
    return replace(robot, legs=legs)
