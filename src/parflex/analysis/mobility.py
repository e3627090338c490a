"""Mobility: freedoms, redundant constraints, singularities of both kinds and their directions."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array
from parflex.mechanics.closure import EVERY, POSE, actuated_rows, closure_matrix, displaced, tip_matrix, units
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.system import assembled

RANK = (
    1e-6  # of matrices with entries of order 1; near a serial singularity joints go with the root of a pose
)
HAIR = 1e-14  # of the platform's size: what round-off may put a pose beyond reach


@dataclass(frozen=True)
class Mobility:
    """The freedoms that the legs leave at a state where nothing gives: elastic coordinates of platform and
    legs aside, and soft tips as if they held the platform.

    Twists are (v, ω) in Σp, m/s and rad/s, wrenches (f, n) in Σp, N and N m, with unit largest
    component in the scale of the platform.
    """

    freedoms: int  # of the platform
    internal: int  # further motions, of legs alone, that no actuator holds
    actuators: int
    rows: int  # closure equations, 3 per tip
    rank: int  # independent ones, elastic coordinates included
    not_unique: tuple[int, ...]  # attachments whose contact force is not unique
    parallel: Array  # (k, 6) twists that locked actuators leave free
    serial: Array  # (k, m) actuator rates that leave the platform still
    locked: Array  # (c, 6) wrenches that the legs carry without their actuators

    @property
    def redundant(self) -> int:
        """Closure equations that follow from the others."""
        return self.rows - self.rank

    def __str__(self) -> str:
        """A paragraph to read."""
        words = [f"The platform has {self.freedoms} freedoms, driven by {self.actuators} actuators."]
        if self.internal:
            words.append(f"The legs have {self.internal} motions of their own that leave it still.")
        words.append(f"Of {self.rows} closure equations {self.rank} are independent.")
        if self.not_unique:
            held = ", ".join(map(str, self.not_unique))
            words.append(f"The contact forces at attachments {held} are not unique; the shortest are given.")
        for twist in self.parallel:
            words.append(f"Parallel singularity: locked actuators leave the twist {show(twist)} free.")
        for rates in self.serial:
            words.append(f"Serial singularity: actuator rates {show(rates)} leave the platform still.")
        if len(self.serial):
            words += [f"The legs lock it against {show(wrench)}." for wrench in self.locked]
        return " ".join(words)


class Motions(NamedTuple):
    """All motions of a robot that does not bend: columns, in the robot's scale."""

    platform: Array  # (6, d), angular rows in metres
    actuated: Array  # (m, d)


def mobility(mechanism: Mechanism, x: Array) -> Mobility:
    """The mobility at one flat state."""
    lengths = np.repeat([1.0, mechanism.size], 3)
    G = scaled_tips(mechanism, x)
    Z_p, Z_a = motions(mechanism, G)
    still, locked = null_space(Z_p), null_space(Z_a)
    independent = rank(G)
    clash = null_space(G.T).reshape(len(mechanism.attachments), 3, len(G) - independent)
    pressed = mechanism.attachments[np.linalg.norm(clash, axis=(1, 2)) > 1e-6]
    return Mobility(
        freedoms=rank(Z_p),
        internal=null_space(np.vstack([Z_p, Z_a])).shape[1],
        actuators=mechanism.n_forces,
        rows=len(G),
        rank=independent,
        not_unique=tuple(sorted(int(a) for a in pressed)),
        parallel=unit(span(Z_p @ locked)) / lengths,
        serial=unit(span(Z_a @ still)),
        locked=unit(null_space(Z_p.T).T) * lengths,
    )


def reached(mechanism: Mechanism, x: Array) -> Array:
    """The flat state; one that round-off alone puts beyond a leg's reach is moved within it."""
    steps = HAIR * mechanism.size * np.diag(units(mechanism, POSE))
    near = displaced(
        mechanism, np.broadcast_to(x, (2 * len(steps) + 1, len(x))), np.vstack([0 * steps[:1], steps, -steps])
    )
    with np.errstate(invalid="ignore", divide="ignore"):
        G = closure_matrix(assembled(mechanism, near))
    within = np.all(np.isfinite(G), axis=(-2, -1))
    return x if within[0] or not np.any(within) else near[np.argmax(within)]


def scaled_tips(mechanism: Mechanism, x: Array) -> Array:
    """[−Wᵀ J] (3k, 6 + N + z) of all tips at a flat state, its columns in the robot's scale."""
    return tip_matrix(assembled(mechanism, x)) * units(mechanism, EVERY)


def scaled_closure(mechanism: Mechanism, x: Array) -> Array:
    """The rows (r, 6 + N + z) of it of the tips that are not soft."""
    return closure_matrix(assembled(mechanism, x)) * units(mechanism, EVERY)


def motions(mechanism: Mechanism, G: Array) -> Motions:
    """The motions that a scaled closure allows while neither platform nor legs bend."""
    rigid = units(mechanism, POSE) > 0
    Z = null_space(G[:, rigid])
    S = actuated_rows(mechanism) * units(mechanism, POSE)
    return Motions(Z[:6], S[:, rigid] @ Z)


def freed_twist(mechanism: Mechanism, x: Array) -> Array:
    """The twist (6,), largest entry 1, that locked actuators hold least."""
    Z_p, Z_a = motions(mechanism, scaled_tips(mechanism, x))
    weakest = Z_p @ np.linalg.svd(Z_a)[2][-1]
    twist = weakest / np.repeat([1.0, mechanism.size], 3)
    return twist / np.max(np.abs(twist))


def null_space(a: Array) -> Array:
    """An orthonormal basis (n, d) of the vectors that a (r, n) takes to zero."""
    return np.linalg.svd(a)[2][rank(a) :].T


def span(a: Array) -> Array:
    """An orthonormal basis (d, r) of the columns of a (r, n), by rows."""
    return np.linalg.svd(a)[0].T[: rank(a)]


def rank(a: Array) -> int:
    """The number of singular values that are not round-off, of matrices with entries of order 1."""
    return int(np.sum(np.linalg.svd(a, compute_uv=False) > RANK))


def unit(rows: Array) -> Array:
    """The rows, scaled to largest entry 1."""
    which = np.argmax(np.abs(rows), axis=-1, keepdims=True) if rows.size else np.zeros((0, 1), dtype=int)
    return rows / np.take_along_axis(rows, which, axis=-1)


def show(vector: Array) -> str:
    """A vector in few digits."""
    return np.array2string(vector + 0.0, precision=3, suppress_small=True)
