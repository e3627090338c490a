"""From modes as another program wrote them to a platform, or to the reason why not.

A free body's elastic modes have no momentum: S = ∫ Φ dm = 0 and β = ∫ r × Φ dm = 0, and ΦᵀMΦ is
diagonal. What is off by rounding is put right; what is off because the modes belong to another mass
matrix (consistent against lumped) is made orthonormal in ours and said; the rest is refused.
"""

from dataclasses import replace

import numpy as np
from scipy.linalg import eigh

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.fe.body.basis import ComputedModes
from parflex.fe.body.canonical import clusters
from parflex.fe.body.check_report import CheckReport
from parflex.fe.body.integrals import RigidBody, nodal_moments, rigid_fields, rigid_momentum
from parflex.fe.imports.free_checks import (
    RIGID_SHARE,
    Momenta,
    check_finite,
    check_free,
    check_mass,
    check_rigid_modes,
    check_size,
    check_turns,
    momenta,
    residual_stiffness,
    told_by_rigid_modes,
    turns_missing,
)
from parflex.fe.imports.imported import ImportedModes, inner, rigid_body_of
from parflex.robot.modal import modal_mass

MIXED = 0.1  # deviation from orthogonality that two mass matrices of one model explain
HEAVIER = 0.3  # and of modal masses, of high modes on a coarse mesh


def accepted(read: ImportedModes) -> ComputedModes:
    """The free platform's elastic modes, orthonormal and without momentum, with their check report.

    Raises InputError, in one sentence, where the modes are those of no free body, do not belong to
    these masses, or are damaged.
    """
    check_finite(read)
    check_turns(read)
    fields = rigid_fields(read.nodes)
    inertia = inner(read.mass, fields, fields)
    body = rigid_body_of(inertia)
    parts = momenta(read, fields, inertia)
    rigid = parts.share > RIGID_SHARE
    own = read.own or told_by_rigid_modes(read, parts, rigid)
    check_mass(read, body, own)
    check_free(read, parts)
    check_rigid_modes(read, parts, rigid, fields)
    still = turns_missing(read, parts, rigid)
    elastic = np.flatnonzero(~rigid)[np.argsort(read.squares[~rigid], kind="stable")]
    check_size(read.nodes, body.mass, float(np.sqrt(read.squares[elastic[0]])))
    deviation = mode_deviations(read, parts, elastic)
    repaired = repair_note(read, deviation, elastic)
    modes = orthonormal_modes(read, parts, elastic, fields, bool(repaired))
    notes = (*read.notes, *repaired, *still)
    report = modes_report(read, parts, elastic, modes, body, own, deviation, notes)
    return replace(modes, notes=notes, report=report)


def modes_report(
    read: ImportedModes,
    parts: Momenta,
    elastic: Array,
    modes: ComputedModes,
    body: RigidBody,
    own: RigidBody | None,
    deviation: Array,
    notes: tuple[str, ...],
) -> CheckReport:
    """The check report of modes, as they were read and as they were accepted."""
    N = len(elastic)
    momentum = np.linalg.norm(parts.along[elastic].reshape(N, 2, 3), axis=2)
    return CheckReport(
        source=read.source,
        notes=notes,
        body=body,
        own=own,
        mass_kind=read.mass_kind,
        normalised=read.normalised,
        rigid_modes=len(read.squares) - N,
        residual_stiffness=residual_stiffness(read, parts.share > RIGID_SHARE),
        orthonormality=float(np.max(deviation[:, :N], initial=0.0)),
        S=float(np.max(momentum[:, 0], initial=0.0)),
        beta=float(np.max(momentum[:, 1], initial=0.0)),
        orthonormality_after=float(np.max(np.abs(modal_mass(modes.moments) - np.eye(N)), initial=0.0)),
        momentum_after=relative_momentum(modes, body),
        frequencies_read=np.sqrt(read.squares[elastic]),
        frequencies=modes.frequencies,
        rotations=read.rotations is not None,
    )


def mode_deviations(read: ImportedModes, parts: Momenta, elastic: Array) -> Array:
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


def orthonormal_modes(
    read: ImportedModes, parts: Momenta, elastic: Array, fields: Array, repaired: bool
) -> ComputedModes:
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
    return ComputedModes(
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


def relative_momentum(modes: ComputedModes, body: RigidBody) -> float:
    """The largest of S against √m, and of β against √I."""
    size = np.sqrt(body.mass) * np.ones(3), np.sqrt(np.trace(body.inertia)) * np.ones(3)
    return float(np.max(np.abs(rigid_momentum(modes.moments)) / np.concatenate(size)[:, None], initial=0.0))
