"""Equilibria of many poses at once, of robots whose legs close by themselves, on the compiled models.

Newton's method for the accelerations of the direct model, which vanish at rest, with exact derivatives: for
the bend, the carried coordinates and the forces where the pose is held, and for the pose too where the forces
are given. Near rest the derivatives of the last step serve again.

What is not settled beyond doubt is left to `equilibrium.py`: poses from which the steps do not become shorter
and shorter, those next to a singularity, and those whose stiffness might not be positive.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from parflex.analysis.equilibrium import stiff_motions
from parflex.analysis.health import SINGULAR
from parflex.analysis.mobile_mass import mobile_mass
from parflex.analysis.mobility import rank
from parflex.analysis.statics import scales
from parflex.base.array import Array, mv, transpose
from parflex.base.spatial import rotation_from_quaternion
from parflex.compiled.backend import Function
from parflex.kernels.jacobians import Places, direct_jacobian
from parflex.kernels.kernel import Vectors
from parflex.kernels.rest import unrest
from parflex.mechanics.closure import LARGEST_TURN, displaced
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.system import assembled

STEPS = 30
NEAR = 1e-6  # of the platform's size: steps from which on the derivatives stay
SETTLED = 1e-12  # of it: what the shortest step must be; round-off leaves 1e-16
SHORTER = 0.5  # than the last step, or it is the last
REGULAR = 1e7  # largest product of the norms of gains and of their inverse
NEUTRAL = 1e9  # that of stiffnesses, beyond which something might move that nothing pulls back
SURE = 1e-6  # share of a stiffness that what is found positive has to spare
CHUNK = 256  # states at a time, so that their matrices stay near the processor

Build = Callable[..., Function]  # of a kernel's builder and what else it takes


class Given(NamedTuple):
    """Flat states to begin with, forces, and wrenches side by side; a row for each equilibrium."""

    x: Array  # (B, size)
    forces: Array  # (B, m)
    pushes: Array  # (B, 6 L)


class Found(NamedTuple):
    """Flat states at rest, the forces that hold them, and which of them are beyond doubt."""

    x: Array  # (B, size)
    forces: Array  # (B, m)
    sure: Array  # (B,)


class Slopes(NamedTuple):
    """Derivatives of accelerations, all in the robot's scale, and what solves with them."""

    by_state: Array  # (B, r, r)
    inverse: Array  # (B, p, p), of the part by what is sought of the state
    by_forces: Array  # (B, r, m)
    eased: Array  # (B, p, m), inverse · by_forces
    gains: Array  # (B, 6, m), of the pose by forces while all else follows; (B, 0, m) where it is sought
    held: Array  # (B, m, 6), their inverse, the shortest
    regular: Array  # (B,)
    by_load: Array  # (B, 6 + N, 6 + N), of pose and modes by a generalised force, in SI


class Quick(NamedTuple):
    """A robot, and what its equilibria are found with."""

    mechanism: Mechanism
    places: Places
    slopes: Function
    unrest: Function
    first: int  # of the entries of (pose, q_e, s) that are sought: 6 where the pose is held, or 0
    scale: Array  # (r,), what makes these entries comparable, in metres

    @property
    def size(self) -> int:
        """The number r of entries of (pose, q_e, s)."""
        return len(self.scale)


def quick(mechanism: Mechanism, build: Build, places: Places, posed: bool) -> Quick:
    """The means to find the equilibria of a robot, in poses that are held or under forces."""
    first = 6 + mechanism.platform.modes
    every = scales(mechanism)
    scale = np.concatenate([every[:first], every[first:][mechanism.kept]])
    return Quick(
        mechanism, places, build(direct_jacobian, places), build(unrest, places), 6 if posed else 0, scale
    )


def has_quick(mechanism: Mechanism, x: Array, posed: bool) -> bool:
    """True where this file may find equilibria from a flat state (size,): the legs close by themselves, and
    where the pose is held they allow all motions of Σp and have motors for them."""
    if not mechanism.closed or (posed and mechanism.n_forces < 6):
        return False
    return not (posed and mechanism.soft) or rank(stiff_motions(mechanism, x)) == 6


def equilibria(robot: Quick, given: Given) -> Found:
    """The equilibria from flat states, chunk by chunk."""
    return in_chunks(lambda part: settled(robot, part), given)


def in_chunks(settled: Callable[[Given], Found], given: Given) -> Found:
    """All rows, some at a time, as `settled` finds them."""
    parts = [given_part(given, slice(i, i + CHUNK)) for i in range(0, len(given.x), CHUNK)]
    with np.errstate(all="ignore"):  # a bad pose shows as one that is not sure
        return together([of_chunk(settled, part) for part in parts])


def together(parts: list[Found]) -> Found:
    """All that is found, chunk below chunk."""
    x, forces, sure = (np.concatenate(each) for each in zip(*parts, strict=True))
    return Found(x, forces, sure)


def given_part(given: Given, rows: Any) -> Given:
    """Some rows of what is given."""
    return Given(*(part[rows] for part in given))


def of_chunk(settled: Callable[[Given], Found], given: Given) -> Found:
    """The equilibria of some rows; one is not sure where a matrix is singular to the last bit."""
    try:
        return settled(given)
    except (np.linalg.LinAlgError, ValueError):  # of the readable models also a leg out of reach
        if len(given.x) > 1:
            halves = slice(0, len(given.x) // 2), slice(len(given.x) // 2, None)
            return together([of_chunk(settled, given_part(given, half)) for half in halves])
        return Found(given.x, given.forces, np.array([False]))


def settled(robot: Quick, given: Given) -> Found:
    """Newton's method from the rows given; a row is done where its step does not become shorter."""
    x, forces = given.x, given.forces
    none, every = np.full(len(x), False), np.full(len(x), True)
    best, trial, going = Found(x, forces, none), x, every
    shortest, slopes = np.full(len(x), np.inf), None
    limit, near = LARGEST_TURN * robot.mechanism.size, NEAR * robot.mechanism.size
    if robot.first and forces.shape[-1] > 6:
        near = 0.0  # which forces are the shortest is a matter of the derivatives, too
    for _ in range(STEPS):
        if slopes is None or np.max(shortest[going]) > near:
            slopes = slopes_at(robot, trial, forces, given.pushes)
        step, forces = newton_step(robot, slopes, trial, forces, given.pushes)
        length = np.max(np.abs(step), axis=-1, initial=0.0)
        length = np.where(np.isfinite(length), length, np.inf)
        better = going & (length < SHORTER * shortest)
        best = Found(chosen(better, trial, best.x), chosen(better, forces, best.forces), none)
        shortest, going = np.where(better, length, shortest), better & (length > 0)
        if not np.any(going):
            break
        part = np.minimum(1.0, limit / np.maximum(length, 1e-300))
        trial = chosen(going, moved(robot, trial, part[:, None] * step), best.x)
        forces = chosen(going, forces, best.forces)
    assert slopes is not None
    sure = (shortest <= SETTLED * robot.mechanism.size) & slopes.regular & lasting(robot, best.x, slopes)
    return best._replace(sure=sure & healthy(robot, given.x) & healthy(robot, best.x))


def healthy(robot: Quick, x: Array) -> Array:
    """True (B,) where no leg is out of reach or singular, and no flexure nearly turned about."""
    margins = robot.unrest.each(x=x)["health"][:, robot.mechanism.health.margins]
    return np.min(margins, axis=-1, initial=np.inf) > SINGULAR


def chosen(which: Array, new: Array, old: Array) -> Array:
    """Rows (B, n) that are new where `which` (B,) says so."""
    return np.where(which[:, None], new, old)


def newton_step(robot: Quick, slopes: Slopes, x: Array, forces: Array, pushes: Array) -> tuple[Array, Array]:
    """The step (B, p) in the robot's scale, and the forces (B, m) there: where the pose is held those that
    leave it no acceleration, else as they are."""
    a = robot.unrest.each(x=x, forces=forces, pushes=pushes)["accelerations"] / robot.scale
    eased = mv(slopes.inverse, a[:, robot.first :])
    if robot.first:
        left = a[:, :6] - mv(slopes.by_state[:, :6, 6:], eased)
        change = -mv(slopes.held, left)
        if slopes.gains.shape[-1] > 6:
            change = change + mv(slopes.held, mv(slopes.gains, forces)) - forces
        eased, forces = eased + mv(slopes.eased, change), forces + change
    return -eased, forces


def slopes_at(robot: Quick, x: Array, forces: Array, pushes: Array) -> Slopes:
    """The derivatives at flat states."""
    found = robot.slopes.each(x=x, forces=forces, pushes=pushes)
    scale, first = robot.scale, robot.first
    by_forces = rows_of(found, "by_forces", robot) / scale[:, None]
    K = by_displacement(robot, x, found) * scale / scale[:, None]
    inverse = np.linalg.inv(K[:, first:, first:])
    eased = inverse @ by_forces[:, first:]
    gains = (by_forces[:, :6] - K[:, :6, 6:] @ eased) if first else by_forces[:, :0]
    held = transpose(gains)
    if not first:
        regular = norm(inverse) * norm(K) <= NEUTRAL
    else:
        held = np.linalg.inv(gains) if gains.shape[-1] == 6 else np.linalg.pinv(gains)
        regular = norm(held) * norm(gains) <= REGULAR
    by_load = found["by_load"].reshape((len(x), *2 * (6 + robot.mechanism.platform.modes,)))
    return Slopes(K, inverse, by_forces, eased, gains, held, regular, by_load)


def rows_of(found: Vectors, name: str, robot: Quick) -> Array:
    """The rows (B, r, c) of platform and carried coordinates below each other."""
    of_platform, carried = found[name], found[f"carried_{name}"]
    both = np.concatenate([of_platform, carried], axis=-1)
    return both.reshape((len(both), robot.size, both.shape[-1] // robot.size))


def by_displacement(robot: Quick, x: Array, found: Vectors) -> Array:
    """∂(V̇_p, q̈_e, s̈) (B, r, r) by displacements of Σp in Σp, of the modes and of carried coordinates."""
    by_state, motions = rows_of(found, "by_state", robot), robot.mechanism.layout.motions
    rotation = rotation_from_quaternion(x[:, robot.mechanism.layout.at.quaternion])
    parts = [by_state[..., part] for part in (motions.rotation, motions.elastic, motions.joints)]
    return np.concatenate([by_state[..., motions.position] @ rotation, *parts], axis=-1)


def norm(a: Array) -> Array:
    """The largest sum of a row's magnitudes (B,)."""
    return np.max(np.sum(np.abs(a), axis=-1), axis=-1, initial=0.0)


def moved(robot: Quick, x: Array, step: Array) -> Array:
    """Flat states displaced by steps (B, p) in the robot's scale."""
    mechanism, layout = robot.mechanism, robot.mechanism.layout
    change = step * robot.scale[robot.first :]
    if not robot.first:
        first = layout.displacements.joints.start
        every = np.zeros((len(x), first + len(mechanism.bends)))
        every[:, :first] = change[:, :first]
        every[:, first + mechanism.kept] = change[:, first:]
        return displaced(mechanism, x, every)
    found, N = np.array(x), layout.modes
    found[:, layout.at.elastic] += change[:, :N]
    found[:, layout.at.joints] += change[:, N:]
    return found


def lasting(robot: Quick, x: Array, slopes: Slopes) -> Array:
    """True (B,) where all that bends or is carried has a positive stiffness while the pose is held, without
    doubt; H = −M ∂(V̇_p, q̈_e, s̈)."""
    mechanism = robot.mechanism
    if not mechanism.platform.modes and not np.any(mechanism.bends):
        return np.full(len(x), True)
    carries = mechanism.layout.carried > 0
    M = mobile_mass(assembled(mechanism, x)) if carries else np.linalg.inv(slopes.by_load)
    M = M * robot.scale[:, None] * robot.scale
    return surely_positive(-(M @ slopes.by_state[:, :, 6:])[:, 6:])


def surely_positive(H: Array) -> Array:
    """True (B,) where the symmetric parts of matrices (B, n, n) are positive, with something to spare."""
    H = 0.5 * (H + transpose(H))
    spare = SURE * np.einsum("...ii->...i", H)
    return positive(H - spare[..., None] * np.eye(H.shape[-1]))


def positive(H: Array) -> Array:
    """True (B,) where symmetric matrices (B, n, n) are positive definite."""
    good = np.all(np.isfinite(H), axis=(-2, -1))
    try:
        np.linalg.cholesky(H[good])
    except np.linalg.LinAlgError:
        good[good] = np.linalg.eigvalsh(H[good])[:, 0] > 0
    return good
