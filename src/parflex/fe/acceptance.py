"""From modes as another program wrote them to a platform, or to the reason why not.

A free body's elastic modes have no momentum: S = ∫ Φ dm = 0 and β = ∫ r × Φ dm = 0, and ΦᵀMΦ is
diagonal. What is off by rounding is put right; what is off because the modes belong to another mass
matrix (consistent against lumped) is made orthonormal in ours and said; the rest is refused.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import eigh

from parflex.array import Array
from parflex.errors import InputError
from parflex.fe.canonical import clusters
from parflex.fe.check_report import CheckReport
from parflex.fe.imported import ImportedModes, RigidBody, inner, rigid_body, rigid_fields
from parflex.fe.integrals import nodal_moments, rigid_momentum
from parflex.modes import Modes

BEYOND = 1e30  # in SI units, what nothing is
RIGID_SHARE = 0.95  # of a mode's kinetic energy in rigid motion, from which it counts as a rigid mode
ELASTIC_SHARE = 0.05  # up to which it counts as an elastic one
RESIDUAL = 1e-4  # ω² of a rigid mode against the first elastic one, at most
STIFF = 1e-3  # deviation of a node from rigid motion in a rigid mode, at most
FLIP = 10.0  # rotation of a node against the slope of the elements, at most
SAME_MASS = 1e-4  # mass and centre of mass against the program's own, at most
MIXED = 0.1  # deviation from orthogonality that two mass matrices of one model explain
HEAVIER = 0.3  # and of modal masses, of high modes on a coarse mesh
SLOWNESS = (1e-3, 6e4)  # m/s, frequency times size of any platform
BULK = (1e-3, 3e4)  # kg/m³, mass over size³ of any platform


@dataclass(frozen=True, eq=False)
class Momenta:
    """The modes in the mass's own scale: unit modal mass, with their parts along the rigid motions."""

    scale: Array  # (P,) √ΦᵀMΦ as read
    gram: Array  # (P, P) ΦᵀMΦ, of unit diagonal
    along: Array  # (P, 6) parts along orthonormal rigid motions
    motion: Array  # (P, 6) the same as translations and rotations about the origin

    @property
    def share(self) -> Array:
        """(P,) rigid part of the kinetic energy."""
        return np.sum(self.along**2, axis=1)


def accepted(read: ImportedModes) -> Modes:
    """The free platform's elastic modes, orthonormal and without momentum, with their check report.

    Raises InputError, in one sentence, where the modes are those of no free body, do not belong to
    these masses, or are damaged.
    """
    check_finite(read)
    check_turns(read)
    fields = rigid_fields(read.nodes)
    inertia = inner(read.mass, fields, fields)
    body = rigid_body(inertia)
    parts = momenta(read, fields, inertia)
    rigid = parts.share > RIGID_SHARE
    own = read.own or told_by_rigid_modes(read, parts, rigid)
    check_mass(read, body, own)
    check_free(read, parts)
    check_rigid_modes(read, parts, rigid, fields)
    still = turns_missing(read, parts, rigid)
    elastic = np.flatnonzero(~rigid)[np.argsort(read.squares[~rigid], kind="stable")]
    size = float(np.max(np.ptp(read.nodes, axis=0)))
    check_size(size, body.mass, float(np.sqrt(read.squares[elastic[0]])))
    deviation = deviations(read, parts, elastic)
    repaired = repair_note(read, deviation, elastic)
    modes = orthonormal(read, parts, elastic, fields, bool(repaired))
    report = CheckReport(
        source=read.source,
        body=body,
        own=own,
        mass_kind=read.mass_kind,
        normalised=read.normalised,
        rigid_modes=int(np.sum(rigid)),
        residual_stiffness=residual(read, rigid),
        orthonormality=float(np.max(deviation[:, : len(elastic)], initial=0.0)),
        S=float(np.max(np.linalg.norm(parts.along[elastic, :3], axis=1), initial=0.0)),
        beta=float(np.max(np.linalg.norm(parts.along[elastic, 3:], axis=1), initial=0.0)),
        orthonormality_after=float(np.max(np.abs(modal_mass(modes) - np.eye(len(elastic))), initial=0.0)),
        momentum_after=relative_momentum(modes, body),
        frequencies_read=np.sqrt(read.squares[elastic]),
        frequencies=modes.frequencies,
        rotations=read.rotations is not None,
        notes=(*read.notes, *repaired, *still),
    )
    return replace(modes, notes=report.notes, report=report)


def check_finite(read: ImportedModes) -> None:
    """Every number of the modes is one."""
    for fields in (read.shapes, read.rotations):
        if fields is not None and not np.all(np.abs(fields) < BEYOND):
            mode, node, _ = np.argwhere(~(np.abs(fields) < BEYOND))[0]
            raise InputError(
                f"mode {mode + 1} is beyond all bounds at node {read.ids[node]}; the file is damaged: "
                f"write it again"
            )
    if not np.all(np.abs(read.squares) < BEYOND):
        raise InputError("a frequency is beyond all bounds; the file is damaged: write it again")
    if not np.all(np.abs(read.nodes) < BEYOND) or not np.all(np.abs(read.mass.data) < BEYOND):
        raise InputError("a node or its mass is beyond all bounds; the file is damaged: write it again")
    if len(read.squares) == 0:
        raise InputError("there are no modes in the file; ask the program for them (Nastran: SOL 103, DISP)")


def momenta(read: ImportedModes, fields: Array, inertia: Array) -> Momenta:
    """ΦᵀMΦ and the modes' parts along the rigid motions."""
    gram = inner(read.mass, read.shapes, read.shapes)
    own = np.diagonal(gram)
    if not np.all(own > 0):
        raise InputError(f"mode {int(np.argmin(own)) + 1} moves no mass; it is no mode of this model")
    scale = np.sqrt(own)
    values = np.linalg.eigvalsh(inertia)
    if values[0] <= 1e-12 * values[-1]:
        raise InputError("the masses lie on one line; a platform needs inertia about every axis")
    lower = np.linalg.cholesky(inertia)
    momentum = inner(read.mass, read.shapes, fields) / scale[:, None]
    along = np.linalg.solve(lower, momentum.T).T
    motion = np.linalg.solve(lower.T, along.T).T
    return Momenta(scale, gram / np.outer(scale, scale), along, motion)


def told_by_rigid_modes(read: ImportedModes, parts: Momenta, rigid: Array) -> RigidBody | None:
    """The mass that the program used, from its own normalisation of six rigid modes.

    With B the motions of the modes, Bᵀ M B = μ, so that M = B⁻ᵀ μ B⁻¹.
    """
    if read.modal_mass is None or np.sum(rigid) != 6:
        return None
    B = (parts.motion[rigid] * (parts.scale[rigid] / np.sqrt(read.modal_mass[rigid]))[:, None]).T
    return rigid_body(np.linalg.inv(B @ B.T))


def check_mass(read: ImportedModes, body: RigidBody, own: RigidBody | None) -> None:
    """The masses are those with which the modes were computed."""
    if own is None:
        return
    size = np.max(np.ptp(read.nodes, axis=0))
    apart = np.linalg.norm(body.com - own.com)
    if abs(body.mass / own.mass - 1) > SAME_MASS or apart > SAME_MASS * size:
        raise InputError(
            f"the masses that were read make {body.mass:.5g} kg at {np.round(body.com, 5)} m, but the modes "
            f"were computed with {own.mass:.5g} kg at {np.round(own.com, 5)} m; give files of one and the "
            f"same model"
        )


def check_free(read: ImportedModes, parts: Momenta) -> None:
    """Each mode is either rigid or without momentum: nothing holds the model."""
    between = (parts.share > ELASTIC_SHARE) & (parts.share <= RIGID_SHARE)
    if not np.any(between):
        return
    worst = int(np.argmax(np.where(between, parts.share, 0.0)))
    raise InputError(
        f"the model is held, not free: mode {worst + 1} has {100 * parts.share[worst]:.0f} % of its energy "
        f"in rigid motion{held_nodes(read)}; remove the constraints, or give the masses that belong to these "
        f"modes"
    )


def held_nodes(read: ImportedModes) -> str:
    """', and node 1 moves in no mode', where there is one."""
    size = np.max(np.abs(read.shapes), axis=(1, 2), keepdims=True)
    still = np.flatnonzero(np.all(np.abs(read.shapes) <= 1e-9 * size, axis=(0, 2)))
    if len(still) == 0:
        return ""
    names = ", ".join(str(read.ids[node]) for node in still[:4])
    more = f" and {len(still) - 4} more" if len(still) > 4 else ""
    one = len(still) == 1
    return f", and node{'' if one else 's'} {names}{more} {'moves' if one else 'move'} in no mode"


def check_rigid_modes(read: ImportedModes, parts: Momenta, rigid: Array, fields: Array) -> None:
    """Rigid modes are rigid at each node and cost next to no energy; no other mode is so soft."""
    lowest = np.min(read.squares[~rigid], initial=np.inf)
    if not lowest > 0 or residual(read, rigid) > RESIDUAL or lowest == np.inf:
        elastic = np.flatnonzero(~rigid)
        first = f"mode {elastic[np.argmin(read.squares[~rigid])] + 1}" if len(elastic) else "no mode"
        raise InputError(
            f"the rigid modes are not free of stiffness: {first} is the first elastic one, with ω² = "
            f"{lowest:.3g} s⁻², and a rigid one has {np.max(np.abs(read.squares[rigid]), initial=0.0):.3g}; "
            f"remove springs to ground and mechanisms, and ask for elastic modes too"
        )
    for k in np.flatnonzero(rigid):
        motion = parts.scale[k] * np.einsum("r,rki->ki", parts.motion[k], fields)
        off = np.max(np.abs(read.shapes[k] - motion), axis=1) / np.max(np.abs(motion))
        worst = int(np.argmax(off))
        if off[worst] > STIFF:
            raise InputError(
                f"node {read.ids[worst]} leaves the rigid body in mode {k + 1}, by {100 * off[worst]:.2g} % "
                f"of the motion; its coordinates belong to another model, or the file is damaged"
            )


def turns_missing(read: ImportedModes, parts: Momenta, rigid: Array) -> tuple[str, ...]:
    """A note where nodes do not turn with the body in its rigid modes: drilling, and nodes of solids.

    Raises InputError where a node turns otherwise than the body.
    """
    if read.rotations is None or not np.any(rigid):
        return ()
    turned = read.rotations[rigid] / parts.scale[rigid, None, None]
    motion = parts.motion[rigid, None, 3:]
    off = np.max(np.abs(turned - motion), axis=0) > STIFF * np.max(np.abs(motion))
    never = np.all(read.rotations == 0, axis=0)
    small = np.max(np.abs(read.rotations), axis=0) <= 1e-6 * np.max(np.abs(read.rotations))
    wrong = np.argwhere(off & ~never & ~small)
    if len(wrong):
        raise InputError(
            f"node {read.ids[wrong[0, 0]]} does not turn with the body in the rigid modes; its output "
            f"coordinate system is another, or the file is damaged"
        )
    count = np.sum(off, axis=0)
    if not np.any(count):
        return ()
    most = f"{np.max(count)} of {len(off)}" if np.max(count) < len(off) else "all"
    axes = ", ".join(axis for axis, n in zip("xyz", count, strict=True) if n)
    return (f"{most} nodes have no rotation about {axes}: a moment about it does no work there",)


def check_turns(read: ImportedModes) -> None:
    """Nodes of shells turn about as much as the triangles between them."""
    if read.rotations is None or len(read.triangles) == 0:
        return
    a, b, c = np.moveaxis(read.nodes[read.triangles], 1, 0)
    u, v, w = np.moveaxis(read.shapes[:, read.triangles], 2, 0)
    slope = np.maximum(
        np.linalg.norm(v - u, axis=2) / np.linalg.norm(b - a, axis=1),
        np.linalg.norm(w - u, axis=2) / np.linalg.norm(c - a, axis=1),
    )
    most = np.max(np.abs(read.rotations), axis=2)
    bad = most > FLIP * np.max(slope, axis=1)[:, None]
    if np.any(bad):
        mode, node = np.argwhere(bad)[0]
        raise InputError(
            f"node {read.ids[node]} turns by {most[mode, node]:.3g} in mode {mode + 1}, far more than the "
            f"elements around it; the file is damaged"
        )


def residual(read: ImportedModes, rigid: Array) -> float:
    """Largest ω² of a rigid mode against the first elastic one."""
    lowest = np.min(read.squares[~rigid], initial=np.inf)
    return float(np.max(np.abs(read.squares[rigid]), initial=0.0) / lowest)


def check_size(size: float, mass: float, omega: float) -> None:
    """Raises InputError where nothing has such a size (m), mass (kg) and first elastic frequency (rad/s)."""
    speeds = SLOWNESS[0] <= size * omega <= SLOWNESS[1]
    if not (speeds and BULK[0] * size**3 <= mass <= BULK[1] * size**3):
        raise InputError(
            f"units make this a body of {size:.3g} m and {mass:.3g} kg whose first elastic mode is at "
            f"{omega:.3g} rad/s, which nothing is; name the units that the file was written in"
        )


def deviations(read: ImportedModes, parts: Momenta, elastic: Array) -> Array:
    """|ΦᵀMΦ − 1| of the elastic modes, and their parts along the rigid ones: (N, N + 6).

    The diagonal compares with what the program says of its own normalisation.
    """
    gram = parts.gram[np.ix_(elastic, elastic)]
    if read.modal_mass is not None:
        gram = gram + np.diag(parts.scale[elastic] ** 2 / read.modal_mass[elastic] - 1)
    return np.abs(np.hstack([gram - np.eye(len(elastic)), parts.along[elastic]]))


def repair_note(read: ImportedModes, deviation: Array, elastic: Array) -> tuple[str, ...]:
    """Empty where the modes belong to the masses; a note where they are of another mass matrix.

    Raises InputError where neither explains them.
    """
    worst = float(np.max(deviation, initial=0.0))
    if worst <= read.precision:
        return ()
    lone = lone_offender(deviation, read.precision)
    allowed = np.where(np.eye(*deviation.shape) > 0, HEAVIER, MIXED)
    if lone is not None or np.any(deviation > allowed):
        k = elastic[int(np.argmax(np.max(deviation, axis=1))) if lone is None else lone] + 1
        others = "while the others are" if lone is not None else "so it is no mode of these masses"
        raise InputError(
            f"mode {k} is not orthonormal or carries momentum, by {np.max(deviation):.2g}, {others}; the "
            f"file is damaged, or belongs to another model"
        )
    other = "consistent" if read.mass_kind == "lumped" else "lumped"
    return (
        f"the modes were computed with another mass matrix ({other}?) than the {read.mass_kind} one read "
        f"here: ΦᵀMΦ and momenta were off by {worst:.1e}; they were made orthonormal in the {read.mass_kind} "
        f"one, with the stiffness that their frequencies stand for",
    )


def lone_offender(deviation: Array, tolerance: float) -> int | None:
    """The one mode without which all is well; None where there is none, or there are but two."""
    if len(deviation) < 3:
        return None
    for k in range(len(deviation)):
        rest = np.delete(np.delete(deviation, k, axis=0), k, axis=1)
        if np.max(rest) <= tolerance:
            return k
    return None


def orthonormal(read: ImportedModes, parts: Momenta, elastic: Array, fields: Array, repaired: bool) -> Modes:
    """Rigid parts removed, ΦᵀMΦ = 1; frequencies as read, or of the shapes in the masses read here."""
    motion = parts.motion[elastic]
    shapes = read.shapes[elastic] / parts.scale[elastic, None, None]
    shapes = shapes - np.einsum("nr,rki->nki", motion, fields)
    gram = inner(read.mass, shapes, shapes)
    squares = read.squares[elastic]
    if repaired:
        told = parts.scale**2 if read.modal_mass is None else read.modal_mass
        stiffness = np.diag(squares * told[elastic] / parts.scale[elastic] ** 2)
        squares, turn = eigh(stiffness, gram)
        turn = aligned(squares, turn)
    else:
        values, vectors = np.linalg.eigh(gram)
        turn = vectors / np.sqrt(values) @ vectors.T
    rotations = None
    if read.rotations is not None:
        free = read.rotations[elastic] / parts.scale[elastic, None, None] - motion[:, None, 3:]
        rotations = np.einsum("nm,nki->mki", turn, free)
    shapes = np.einsum("nm,nki->mki", turn, shapes)
    return Modes(
        nodes=read.nodes,
        triangles=read.triangles,
        shapes=shapes,
        rotations=rotations,
        frequencies=np.sqrt(squares),
        frequency_error=np.full(len(elastic), np.nan),
        moments=nodal_moments(read.nodes, read.mass, shapes),
        corners=(),
        source=read.source,
        ids=tuple(int(i) for i in read.ids),
    )


def aligned(squares: Array, turn: Array) -> Array:
    """Signs, and the orientation of degenerate pairs, nearest to those of the file."""
    parts = []
    for a, b in clusters(np.sqrt(squares)):
        left, _, right = np.linalg.svd(turn[a:b, a:b])
        parts.append(turn[:, a:b] @ (left @ right).T)
    return np.concatenate(parts, axis=1)


def modal_mass(modes: Modes) -> Array:
    """ΦᵀMΦ = tr P2."""
    return np.trace(modes.moments.P2, axis1=-2, axis2=-1)


def relative_momentum(modes: Modes, body: RigidBody) -> float:
    """Largest of S against √m, and of β against √I."""
    size = np.sqrt(body.mass) * np.ones(3), np.sqrt(np.trace(body.inertia)) * np.ones(3)
    return float(np.max(np.abs(rigid_momentum(modes.moments)) / np.concatenate(size)[:, None], initial=0.0))
