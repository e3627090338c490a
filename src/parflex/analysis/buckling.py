"""Equilibria that do not last: legs that buckle under their load, platforms that their weight bends on."""

from typing import NamedTuple

import numpy as np

from parflex.analysis.mobility import null_space
from parflex.analysis.statics import Statics, link_stiffness, stiffness
from parflex.base.array import Array
from parflex.base.errors import NotConverged
from parflex.mechanics import dynamics
from parflex.mechanics.derivatives.changes import Load
from parflex.mechanics.system import tip_forces


class Bend(NamedTuple):
    """The stiffness of a leg along motions that leave its tips and its actuators where they are."""

    leg: int
    loaded: Array  # (b, b)
    alone: Array  # (b, b), of its links without load
    tips: slice  # of the leg's contact forces, group by group


def check_stability(at: Statics, forces: Array, load: Load) -> None:
    """Raise NotConverged where a flexible leg buckles at an equilibrium, or the platform bends on."""
    mechanism = at.system.mechanism
    if not mechanism.platform.modes and not np.any(mechanism.bends):
        return
    H = stiffness(at, forces, load)
    for bend in bends(at, H):
        if np.linalg.eigvalsh(bend.loaded)[0] <= 0:
            raise NotConverged(buckled(at, bend, forces, load))
    softest = platform_stiffness(at, H)
    if len(softest) and np.linalg.eigvalsh(softest)[0] <= 0:
        raise NotConverged(
            "the equilibrium in this pose does not last: the platform is too soft for its weight and loads, "
            "which bend it on; raise its frequencies or move the pose"
        )


def bends(at: Statics, H: Array) -> list[Bend]:
    """The flexible legs, one by one."""
    mechanism, found = at.system.mechanism, []
    first, tip = 6 + mechanism.platform.modes, 0
    for leg in at.system.legs:
        group, z = leg.group, leg.group.chain.size
        rows = 3 * len(group.tip_frames)
        for i, number in enumerate(group.legs):
            if any(group.chain.modes):
                places = slice(first, first + z)
                held = np.concatenate([leg.J[i], group.S.T]) * at.scale[places]
                own = null_space(held / np.linalg.norm(held, axis=-1, keepdims=True))
                along = np.linalg.pinv(at.basis)[:, places] @ own
                alone = own * at.scale[places][:, None]
                strained = alone.T @ (link_stiffness(group)[i][:, None] * alone)
                found.append(Bend(number, symmetric(along.T @ H @ along), strained, slice(tip, tip + rows)))
            first, tip = first + z, tip + rows
    return found


def buckled(at: Statics, bend: Bend, forces: Array, load: Load) -> str:
    """The leg, its load, and the load that it carries."""
    from scipy.linalg import eigh

    contact = dynamics.direct_of(at.system, forces, load(at.system.x)).contact
    carried = float(np.linalg.norm(tip_forces(at.system, contact)[bend.tips]))
    firm = bend.alone + 1e-12 * np.trace(bend.alone) * np.eye(len(bend.alone))
    share = float(eigh(firm - bend.loaded, firm, eigvals_only=True)[-1])
    return (
        f"leg {bend.leg + 1} is loaded with {carried:.4g} N and buckles from {carried / share:.4g} N on, so "
        f"that the equilibrium in this pose does not last; make its links stiffer, or lessen the load"
    )


def platform_stiffness(at: Statics, H: Array) -> Array:
    """The stiffness (b, b) of motions of the modes that leave the pose, with legs that do not bend."""
    mechanism = at.system.mechanism
    first = 6 + mechanism.platform.modes
    legs = at.basis[first:][mechanism.bends]
    unbent = null_space(np.concatenate([at.basis[:6], legs]))
    still = null_space(np.concatenate([at.basis[:first], legs]))
    bending = unbent - still @ (still.T @ unbent)
    along = np.linalg.svd(bending)[0][:, : unbent.shape[1] - still.shape[1]]
    return symmetric(along.T @ H @ along)


def symmetric(a: Array) -> Array:
    """The symmetric part of a matrix."""
    return 0.5 * (a + a.T)
