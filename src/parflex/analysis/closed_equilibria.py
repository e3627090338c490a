"""Equilibria of many poses at once, of robots whose legs have to be closed, in poses that are held.

As `equilibria.py`, along motions Z that the closure allows: with Y their part of all that the state holds and
U the directions in which the legs allow Σp to move where nothing bends,

    Yᵀ (a + K Y ζ + B δΓ) = 0,    Uᵀ Y_p ζ = 0,

after which the pose is the nearest one that the legs allow the bent platform. All is in the robot's scale.
"""

from typing import NamedTuple

import numpy as np

from parflex.analysis.equilibria import (
    SETTLED,
    SHORTER,
    STEPS,
    Found,
    Given,
    Quick,
    by_displacement,
    chosen,
    healthy,
    in_chunks,
    norm,
    rows_of,
    surely_positive,
)
from parflex.analysis.statics import mass, scales
from parflex.base.array import Array, block, mtv, mv, transpose
from parflex.compiled.backend import Function
from parflex.mechanics.closure import CLOSED, LARGEST_TURN, POSE, closed, displaced
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.system import assembled

INDEPENDENT = 1e-6  # of the largest row or column: less of one is left when those before it are taken out
REGULAR = 1e9  # largest product of the norms of the equations and of their inverse


class OnClosure(NamedTuple):
    """A robot, and what its equilibria are found with."""

    quick: Quick
    closure: Function
    scale: Array  # (6 + N + z,)

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism."""
        return self.quick.mechanism

    def equations(self, x: Array) -> tuple[Array, Array]:
        """Gaps (B, r) and closure matrix (B, r, 6 + N + z)."""
        found = self.closure.each(x=x)
        return found["gap"], found["matrix"].reshape((len(x), -1, len(self.scale)))


class Motions(NamedTuple):
    """The motions that a robot is free to make at each of B states, in its scale."""

    Z: Array  # (B, 6 + N + z, d)
    Y: Array  # (B, 6 + N + n, d)
    held: Array  # (B, m, d), those that are held
    regular: Array  # (B,)


def has_motions(mechanism: Mechanism) -> bool:
    """True where this file may find equilibria: no tip is soft, and there is a motor for each motion that the
    legs allow where nothing bends."""
    rows = mechanism.rows_unbent
    rigid = 6 + int(np.sum(~mechanism.bends))
    return not mechanism.soft and rows is not None and rigid - len(rows.kept) == mechanism.n_forces


def on_closure(quick: Quick, closure: Function) -> OnClosure:
    """The means to find the equilibria of a robot."""
    return OnClosure(quick, closure, scales(quick.mechanism))


def equilibria_on_closure(robot: OnClosure, given: Given) -> Found:
    """The equilibria from flat states, chunk by chunk."""
    return in_chunks(lambda part: settled_on_closure(robot, part), given)


def settled_on_closure(robot: OnClosure, given: Given) -> Found:
    """Newton's method from the rows given; a row is done where its step does not become shorter."""
    size, forces = robot.mechanism.size, given.forces
    start = near(robot, given.x)
    none, going = np.full(len(start), False), np.full(len(start), True)
    best, trial, shortest = Found(start, forces, none), start, np.full(len(start), np.inf)
    sure = none
    for _ in range(STEPS):
        motions = motions_at(robot, trial)
        step, forces, regular = newton_step(robot, motions, trial, forces, given.pushes)
        length = np.max(np.abs(step), axis=-1, initial=0.0)
        length = np.where(np.isfinite(length), length, np.inf)
        better = going & (length < SHORTER * shortest)
        best = Found(chosen(better, trial, best.x), chosen(better, forces, best.forces), none)
        sure = np.where(better, motions.regular & regular, sure)
        shortest, going = np.where(better, length, shortest), better & (length > 0)
        if not np.any(going):
            break
        part = np.minimum(1.0, LARGEST_TURN * size / np.maximum(length, 1e-300))
        trial = chosen(going, moved(robot, start, trial, part[:, None] * step), best.x)
        forces = chosen(going, forces, best.forces)
    gap = np.max(np.abs(robot.equations(best.x)[0]), axis=-1, initial=0.0)
    sure = sure & (shortest <= SETTLED * size) & (gap <= 10 * CLOSED * size)
    sure = sure & healthy(robot.quick, start) & healthy(robot.quick, best.x)
    return best._replace(sure=sure & lasting(robot, best, given.pushes))


def near(robot: OnClosure, x: Array) -> Array:
    """The flat states on the closure nearest in pose."""
    return closed(robot.mechanism, x, POSE, robot.equations)[0]


def moved(robot: OnClosure, start: Array, x: Array, step: Array) -> Array:
    """Flat states displaced in the robot's scale, in the poses nearest to those at the start."""
    there, at = displaced(robot.mechanism, x, robot.scale * step), robot.mechanism.layout.at
    found = np.array(start)
    for part in (at.elastic, at.joints):
        found[:, part] = there[:, part]
    return near(robot, found)


def motions_at(robot: OnClosure, x: Array) -> Motions:
    """The motions at flat states on the closure."""
    mechanism, first = robot.mechanism, 6 + robot.mechanism.platform.modes
    assert mechanism.rows_unbent is not None
    G = robot.equations(x)[1] * robot.scale
    Z, whole = complement(G[:, mechanism.solved_rows.kept])
    rigid = np.concatenate([np.arange(6), first + np.flatnonzero(~mechanism.bends)])
    allowed, stiff = complement(G[:, mechanism.rows_unbent.kept][:, :, rigid])
    U, R = np.linalg.qr(allowed[:, :6])
    regular = whole & stiff & independent(R)
    Y = np.concatenate([Z[:, :first], Z[:, first:][:, mechanism.kept]], axis=1)
    return Motions(Z, Y, transpose(U) @ Y[:, :6], regular)


def complement(rows: Array) -> tuple[Array, Array]:
    """Orthonormal vectors (B, n, n − r) that rows (B, r, n) take to zero, and which rows are independent."""
    Q, R = np.linalg.qr(transpose(rows), mode="complete")
    return Q[..., rows.shape[-2] :], independent(R)


def independent(R: Array) -> Array:
    """True (B,) where no diagonal entry of a triangular factor is small."""
    size = np.abs(np.einsum("...ii->...i", R[..., : R.shape[-1], :]))
    return np.min(size, axis=-1, initial=np.inf) > INDEPENDENT * np.max(size, axis=-1, initial=0.0)


def newton_step(
    robot: OnClosure, motions: Motions, x: Array, forces: Array, pushes: Array
) -> tuple[Array, Array, Array]:
    """The step (B, 6 + N + z), the forces (B, m) there, and which equations (B,) are regular."""
    a = robot.quick.unrest.each(x=x, forces=forces, pushes=pushes)["accelerations"] / robot.quick.scale
    K, B = slopes_along(robot, motions, x, forces, pushes)
    stiff = norm(K)[:, None, None]
    unit = stiff / norm(B)[:, None, None]  # of forces
    none = np.zeros((len(x), motions.held.shape[-2], B.shape[-1]))
    equations = block([[K, unit * B], [stiff * motions.held, none]])
    inverse, d = np.linalg.inv(equations), K.shape[-1]
    both = -mv(inverse[:, :, :d], mtv(motions.Y, a))
    regular = norm(inverse) * norm(equations) <= REGULAR
    return mv(motions.Z, both[:, :d]), forces + unit[:, :, 0] * both[:, d:], regular


def slopes_along(
    robot: OnClosure, motions: Motions, x: Array, forces: Array, pushes: Array
) -> tuple[Array, Array]:
    """Yᵀ K Y (B, d, d) and Yᵀ B (B, d, m)."""
    quick, Y = robot.quick, motions.Y
    found = quick.slopes.each(x=x, forces=forces, pushes=pushes)
    K = by_displacement(quick, x, found) * quick.scale / quick.scale[:, None]
    return transpose(Y) @ K @ Y, transpose(Y) @ (rows_of(found, "by_forces", quick) / quick.scale[:, None])


def lasting(robot: OnClosure, found: Found, pushes: Array) -> Array:
    """True (B,) where the motions that are not held have a positive stiffness −Zᵀ M Z (YᵀY)⁻¹ Yᵀ K Y, without
    doubt."""
    mechanism = robot.mechanism
    if not mechanism.platform.modes and not np.any(mechanism.bends):
        return np.full(len(found.x), True)
    motions = motions_at(robot, found.x)
    Z, Y, held, _ = motions
    K, _ = slopes_along(robot, motions, found.x, found.forces, pushes)
    M = mass(assembled(mechanism, found.x)) * robot.scale[:, None] * robot.scale
    H = -(transpose(Z) @ M @ Z) @ np.linalg.solve(transpose(Y) @ Y, K)
    free, _ = complement(held)
    return surely_positive(transpose(free) @ H @ free)
