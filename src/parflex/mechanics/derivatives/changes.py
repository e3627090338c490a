"""Changes of the equations of motion with the state, at fixed accelerations, contact forces and loads.

Columns are the small motions of `Layout.motions`: (δp 3 in Σ0, δθ 3 in Σp, δv_p 3, δω_p 3, δq_e N, δq̇_e N
[, δs, δṡ]), with the attitude turned by R → R (1 + δθ̂).
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, block, block_diagonal, cross, join, merged, mtv, mv, skew, transpose
from parflex.base.dual import jacobian
from parflex.mechanics.derivatives.leg_tangent import leg_tangent, sections_of
from parflex.mechanics.derivatives.platform_tangent import platform_tangent
from parflex.mechanics.derivatives.tip_motions import leg_by_leg, tilt_slope, tip_motions
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.system import System, by_group, diagonal, tip_moments
from parflex.robot.layout import Coordinates

Load = Callable[[Coordinates], Array]  # external generalised force (…, 6 + N)


class LegChanges(NamedTuple):
    """Changes of the legs' equations by small motions, a column for each."""

    closure: Array  # (…, 3k, M), r_3 − J A⁻¹ r_2
    carried: Array  # (…, n, M), −A⁻¹ r_2 of coordinates that the state carries
    moments: Array  # (…, 3k', M), of flexures on the platform, in Σp, at tips of groups that have them
    pulls: Array  # (…, 3k'', M), of soft tips on the platform, in Σp, at tips of groups that have some


def leg_changes(system: System, mobile: list[Array], qdd: list[Array], f: Array, a: Array) -> LegChanges:
    """The changes under contact forces f (…, k, 3), with accelerations (…, L, z) and a (…, 6 + N).

    mobile are the `seen` of the legs, group by group.
    """
    mechanism, R_p0 = system.mechanism, transpose(system.x.rotation)
    of_tips, forced = tip_changes(system, a), by_group(mechanism, f)
    motions, sections = leg_by_leg(system, tip_motions(system)), sections_of(system)
    by_motion: list[tuple[Array, ...]] = []
    own: list[tuple[Array, ...]] = []
    legs = zip(system.legs, mobile, sections, qdd, forced, motions, of_tips, strict=True)
    for leg, reach, section, zdd, f_i, moved, tips in legs:
        found = leg_tangent(system, leg, section, reach, zdd, f_i)
        rows = tips.shape[-2]
        below = np.zeros((reach.shape[-2] - rows, tips.shape[-1]))
        wide = found.by_tips @ moved + block([[tips], [below]])
        wide = wide + by_turning(found.mobility @ hats(f_i), tips.shape[-1])
        turned = np.concatenate([hats(leg.flexed.moment), hats(leg.flexed.pull)], axis=-2)
        held = found.held_by_tips @ moved + by_turning(turned, tips.shape[-1])
        for parts, both, last in ((by_motion, wide, held), (own, found.own, found.held_own)):
            of_legs = both[..., :rows, :], both[..., rows:, :]
            parts.append((*of_legs, last[..., :rows, :], last[..., rows:, :]))
    closure, carried, moments, pulls = (
        assembled(mechanism, R_p0, [part[i] for part in by_motion], [part[i] for part in own])
        for i in range(4)
    )
    return LegChanges(closure, carried[..., mechanism.carried_order, :], moments, pulls)


def by_turning(columns: Array, count: int) -> Array:
    """Columns (…, r, 3) by δθ among as many, zero, by all motions of the platform (…, r, count)."""
    rows = columns.shape[-2]
    return block([[np.zeros((rows, 3)), columns, np.zeros((rows, count - 6))]])


def assembled(mechanism: Mechanism, R_p0: Array, by_motion: list[Array], own: list[Array]) -> Array:
    """Rows of all legs (…, L r, M), one below the other, of those by motions of the platform in Σp
    (…, L, r, 12 + 2 N) and by each leg's own coordinates and their rates (…, L, r, 2 s), group by group."""
    columns, order = 12 + 2 * mechanism.platform.modes, mechanism.carried_order
    rows = [part.reshape((*part.shape[:-3], part.shape[-3] * part.shape[-2], columns)) for part in by_motion]
    every = block([[np.zeros((0, columns))], *([part] for part in rows)])
    halves = [np.split(part, 2, axis=-1) for part in own]
    carried = [diagonal([block_diagonal(pair[i]) for pair in halves])[..., order] for i in (0, 1)]
    return block([[every[..., :3] @ R_p0, every[..., 3:], *carried]])


def tip_changes(system: System, a: Array) -> list[Array]:
    """The part (…, L, 3t, 12 + 2 N) of −(Wᵀ a + h) by motions of the platform in Σp, group by group, where
    the tips' accelerations are fixed in Σ0."""
    x, (r, _, h) = system.x, system.points
    w, spin, Phi = skew(x.twist[..., 3:]), x.twist[..., None, 3:], system.shapes
    Omega = skew(a[..., 3:6]) + w @ w
    moved = (mtv(system.W_p, a[..., :6]) + mtv(system.W_e, a[..., 6:])).reshape(r.shape) + h
    bending = mv(Phi, x.elastic_rate[..., None, :])
    by_omega = skew(cross(spin, r) + 2.0 * bending) + w[..., None, :, :] @ skew(r)
    none, Omega = np.zeros((3, 3)), Omega[..., None, :, :]
    bent = [-(Omega @ Phi), -(2.0 * w[..., None, :, :] @ Phi)]
    every = block([[none, skew(moved), none, by_omega, *bent]])
    parts = by_group(system.mechanism, merged(every))
    columns = every.shape[-1]
    return [part.reshape((*part.shape[:-2], 3 * part.shape[-2], columns)) for part in parts]


def platform_changes(system: System, a: Array, f: Array, load: Load, legs: LegChanges) -> Array:
    """r_1 (…, 6 + N, M) under forces f (…, k, 3) of all tips, of flexures and soft tips that change like that
    of the legs."""
    mechanism, x = system.mechanism, system.x
    gravity = mtv(x.rotation, mechanism.gravity)
    platform = platform_tangent(mechanism.platform, x, gravity, a)
    N, carried = mechanism.platform.modes, mechanism.layout.carried
    external = load_tangent(load, x)
    turning = platform.gravity @ skew(gravity) - external[..., :3]
    levers = -transpose(hats(f)) @ transpose(system.W_e)
    pushed = block([[np.zeros((3, N))], [levers], [np.zeros((N, N))]])
    bending = platform.elastic + pushed - external[..., 3:]
    still, none = np.zeros((6 + N, 3)), np.zeros((6 + N, 2 * carried))
    changed = block([[still, turning, still, platform.omega, bending, platform.elastic_rate, none]])
    if legs.pulls.shape[-2]:
        changed = changed - pulled_changes(system, legs.pulls)
    if not legs.moments.shape[-2]:
        return changed
    return changed - held_changes(system, legs.moments)


def pulled_changes(system: System, pulls: Array) -> Array:
    """∂(W f) (…, 6 + N, M) of soft tips whose forces change so (…, 3k'', M) where the tips' places do not."""
    groups = system.mechanism.groups
    soft = [any(g.soft) for g in groups for _ in range(3 * g.attachments.size)]
    return block([[system.W_p[..., soft] @ pulls], [system.W_e[..., soft] @ pulls]])


def held_changes(system: System, moments: Array) -> Array:
    """∂(0, Σ m, Σ Θᵀ m) (…, 6 + N, M), of flexures whose moments change so (…, 3k', M)."""
    bend = tilt_slope(system, tip_moments(system.legs))
    flexed = [g.flexures is not None for g in system.mechanism.groups for _ in range(g.attachments.size)]
    tilt, N, columns = system.sections.tilt[..., flexed, :, :], bend.shape[-1], moments.shape[-1]
    rows = transpose(tilt.reshape((*tilt.shape[:-3], moments.shape[-2], N)))
    sums = [np.zeros((3, columns)), np.tile(np.eye(3), (1, moments.shape[-2] // 3)) @ moments, rows @ moments]
    own = block([[np.zeros((N, 12)), bend, np.zeros((N, columns - 12 - N))]])
    return block([[part] for part in sums]) + block([[np.zeros((6, columns))], [own]])


def load_tangent(load: Load, x: Coordinates) -> Array:
    """∂load/∂(δθ, q_e) (…, 6 + N, 3 + N)."""

    def moved(seeds: Array) -> Array:
        turned = x.rotation @ (np.eye(3) + skew(seeds[..., :3]))
        return load(x._replace(rotation=turned, elastic=seeds[..., 3:]))

    return jacobian(moved, join([0.0 * x.twist[..., :3], x.elastic]))


def hats(vectors: Array) -> Array:
    """â of vectors (…, k, 3), one below the other (…, 3k, 3)."""
    matrices = skew(vectors)
    return matrices.reshape((*vectors.shape[:-2], 3 * vectors.shape[-2], 3))
