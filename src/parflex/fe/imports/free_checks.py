"""The checks that modes are those of a free body, and belong to the masses that were read."""

from dataclasses import dataclass

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import InputError
from parflex.fe.body.integrals import RigidBody
from parflex.fe.imports.foreign import BEYOND
from parflex.fe.imports.imported import ImportedModes, inner, rigid_body_of

RIGID_SHARE = 0.95  # of a mode's kinetic energy in rigid motion, from which it counts as a rigid mode
ELASTIC_SHARE = 0.05  # up to which it counts as an elastic one
RESIDUAL = 1e-4  # ω² of a rigid mode against the first elastic one, at most
STIFF = 1e-3  # deviation of a node from rigid motion in a rigid mode, at most
FLIP = 10.0  # rotation of a node against the slope of the elements, at most
SAME_MASS = 1e-4  # mass and centre of mass against the program's own, at most
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


def check_finite(read: ImportedModes) -> None:
    """Raise InputError where a number of the modes is none, or beyond all bounds."""
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
    return rigid_body_of(np.linalg.inv(B @ B.T))


def check_mass(read: ImportedModes, body: RigidBody, own: RigidBody | None) -> None:
    """Raise InputError where the modes were computed with other masses."""
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
    """Raise InputError where a mode is neither rigid nor without momentum: something holds the model."""
    between = (parts.share > ELASTIC_SHARE) & (parts.share <= RIGID_SHARE)
    if not np.any(between):
        return
    worst = int(np.argmax(np.where(between, parts.share, 0.0)))
    raise InputError(
        f"the model is held, not free: mode {worst + 1} has {100 * parts.share[worst]:.0f} % of its energy "
        f"in rigid motion{held_nodes(read)}; remove the constraints, or give the masses that belong to these "
        f"modes"
    )


def nodes_at_rest(shapes: Array) -> Array:
    """The rows of nodes that move in no mode, of shapes (P, K, 3)."""
    size = np.max(np.abs(shapes), axis=(1, 2), keepdims=True)
    return np.flatnonzero(np.all(np.abs(shapes) <= 1e-9 * size, axis=(0, 2)))


def held_nodes(read: ImportedModes) -> str:
    """The words ', and node 1 moves in no mode', where there is one."""
    still = nodes_at_rest(read.shapes)
    if len(still) == 0:
        return ""
    names = ", ".join(str(read.ids[node]) for node in still[:4])
    more = f" and {len(still) - 4} more" if len(still) > 4 else ""
    one = len(still) == 1
    return f", and node{'' if one else 's'} {names}{more} {'moves' if one else 'move'} in no mode"


def check_rigid_modes(read: ImportedModes, parts: Momenta, rigid: Array, fields: Array) -> None:
    """Raise InputError where a rigid mode bends at a node or costs energy, or where another mode does not."""
    lowest = np.min(read.squares[~rigid], initial=np.inf)
    if not lowest > 0 or residual_stiffness(read, rigid) > RESIDUAL or lowest == np.inf:
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
    """Raise InputError where a node of a shell turns far more than the triangles around it."""
    if read.rotations is None or len(read.triangles) == 0:
        return
    a, b, c = np.moveaxis(read.nodes[read.triangles], 1, 0)
    u, v, w = np.moveaxis(read.shapes[:, read.triangles], 2, 0)
    along, across = np.linalg.norm(b - a, axis=1), np.linalg.norm(c - a, axis=1)
    if not np.all((along > 0) & (across > 0)):
        raise InputError("an element has two corners in one place; mend the mesh, or the file is damaged")
    slope = np.maximum(np.linalg.norm(v - u, axis=2) / along, np.linalg.norm(w - u, axis=2) / across)
    most = np.max(np.abs(read.rotations), axis=2)
    bad = most > FLIP * np.max(slope, axis=1)[:, None]
    if np.any(bad):
        mode, node = np.argwhere(bad)[0]
        raise InputError(
            f"node {read.ids[node]} turns by {most[mode, node]:.3g} in mode {mode + 1}, far more than the "
            f"elements around it; the file is damaged"
        )


def residual_stiffness(read: ImportedModes, rigid: Array) -> float:
    """The largest ω² of a rigid mode against the first elastic one."""
    lowest = np.min(read.squares[~rigid], initial=np.inf)
    return float(np.max(np.abs(read.squares[rigid]), initial=0.0) / lowest)


def check_size(nodes: Array, mass: float, omega: float) -> None:
    """Raise InputError where nothing of that size (m), mass (kg) has that first elastic frequency (rad/s)."""
    size = float(np.max(np.ptp(nodes, axis=0)))
    speeds = SLOWNESS[0] <= size * omega <= SLOWNESS[1]
    if not (speeds and BULK[0] * size**3 <= mass <= BULK[1] * size**3):
        raise InputError(
            f"units make this a body of {size:.3g} m and {mass:.3g} kg whose first elastic mode is at "
            f"{omega:.3g} rad/s, which nothing is; name the units that the file was written in"
        )
