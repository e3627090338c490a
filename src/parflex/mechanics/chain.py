"""Legs as modified-Denavit–Hartenberg trees (Sec. 3): frames, Jacobians, Newton–Euler.

A `Chain` holds the tables of L legs of equal structure, so that one pass treats them all:
arrays are (…, L, …) and the structure (antecedents, joint types) is shared.

Source: Khalil and Dombre, Modeling, Identification and Control of Robots, ch. 3, 5 and 9.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, block, cross, dot, matrix, mtv, mv, outer, stack, trace, transpose
from parflex.base.spatial import exact_cos_sin
from parflex.robot.fields import Column, described
from parflex.robot.leg import Joint, Leg

E_Z = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class Chain:
    """Tables of L trees of n joints; `antecedent[j]` is an index, −1 for the base frame.

    Each field of a joint that is a table there (`columns`) is one here, under the same name:
    `chain.alpha` (L, n), `chain.MS` (L, n, 3), `chain.I` (L, n, 3, 3) about the frame's origin.
    """

    antecedent: tuple[int, ...]
    sigma: tuple[int, ...]
    columns: Mapping[str, Column]
    tables: Mapping[str, Array]

    def __getattr__(self, name: str) -> Array:
        """The table of that name."""
        try:
            return vars(self)["tables"][name]
        except KeyError:
            raise AttributeError(f"a chain has no table {name!r}", name=name, obj=self) from None

    def with_tables(self, tables: Mapping[str, Array]) -> "Chain":
        """The chain with some tables in the place of its own."""
        return replace(self, tables={**self.tables, **tables})

    @property
    def n(self) -> int:
        """Number of joints of one tree."""
        return len(self.sigma)

    def path(self, j: int) -> list[int]:
        """The joints from the base to frame j, j included."""
        return [] if j < 0 else [*self.path(self.antecedent[j]), j]


def chain_of(leg: Leg) -> Chain:
    """The tables of one leg; a joint without a field that others have is as by default there."""
    columns: dict[str, Column] = {}
    for kind in (Joint, *map(type, leg.joints)):
        columns |= {name: column for name, column in described(kind).items() if column.table}
    tables = {
        name: np.array([getattr(joint, name, column.default) for joint in leg.joints], dtype=float)
        for name, column in columns.items()
    }
    tables = {name: table.reshape(1, -1, *columns[name].shape) for name, table in tables.items()}
    return Chain(tuple(a - 1 for a in leg.antecedents), tuple(j.sigma for j in leg.joints), columns, tables)


def joined(chains: Sequence[Chain]) -> Chain:
    """Chains of equal structure as one, their legs one after the other."""
    first = chains[0]
    return first.with_tables(
        {name: np.concatenate([c.tables[name] for c in chains]) for name in first.tables}
    )


class Joints(NamedTuple):
    """Joint variables as a closed form gives them: of an angle, its cosine and sine."""

    cos: Array  # (…, L, n); 1 for a prismatic joint
    sin: Array  # (…, L, n); 0 for a prismatic joint
    length: Array  # (…, L, n); 0 for a revolute joint


class Frames(NamedTuple):
    """Per joint j with antecedent a: R_aj, p_aj (in a), and R_0j, p_0j in the base frame.

    The base frame itself, number −1, is the last of R_0j and p_0j.
    """

    R_aj: list[Array]
    p_aj: list[Array]
    R_0j: list[Array]
    p_0j: list[Array]


class Motion(NamedTuple):
    """Angular velocity, angular acceleration and acceleration of a frame, in its own axes."""

    omega: Array
    omegad: Array
    vd: Array


def frame_in_antecedent(chain: Chain, j: int, joints: Joints) -> tuple[Array, Array]:
    """R_aj, p_aj = Rot(z,γ) Trans(z,b) Rot(x,α) Trans(x,d) Rot(z,θ) Trans(z,r)."""
    cg, sg = exact_cos_sin(chain.gamma[:, j])
    ca, sa = exact_cos_sin(chain.alpha[:, j])
    c0, s0 = exact_cos_sin(chain.theta[:, j])
    c, s = joints.cos[..., j], joints.sin[..., j]
    ct, st = c * c0 - s * s0, s * c0 + c * s0
    d, r = chain.d[:, j], chain.r[:, j] + joints.length[..., j]
    R = matrix(
        [
            [cg * ct - sg * ca * st, -cg * st - sg * ca * ct, sg * sa],
            [sg * ct + cg * ca * st, -sg * st + cg * ca * ct, -cg * sa],
            [sa * st, sa * ct, ca],
        ]
    )
    return R, stack([d * cg + r * (sg * sa), d * sg - r * (cg * sa), r * ca + chain.b[:, j]])


def placement(chain: Chain, j: int) -> tuple[Array, Array]:
    """R_aj (L, 3, 3) and p_aj (L, 3) where the joint variable is zero."""
    still = np.zeros(chain.r.shape)
    return frame_in_antecedent(chain, j, Joints(still + 1.0, still, still))


def frames(chain: Chain, joints: Joints) -> Frames:
    """All frames of the trees for given joint variables."""
    legs = joints.cos.shape[:-1]
    out = Frames([], [], [np.broadcast_to(np.eye(3), (*legs, 3, 3))], [np.zeros((*legs, 3))])
    for j, a in enumerate(chain.antecedent):
        R_aj, p_aj = frame_in_antecedent(chain, j, joints)
        out.R_aj.append(R_aj)
        out.p_aj.append(p_aj)
        out.R_0j.insert(j, out.R_0j[a] @ R_aj)
        out.p_0j.insert(j, out.p_0j[a] + mv(out.R_0j[a], p_aj))
    return out


def tip_position(frame: Frames, j: int, offset: Array) -> Array:
    """Position in the base frame of a point given in frame j."""
    return frame.p_0j[j] + mv(frame.R_0j[j], offset)


def tip_jacobian(chain: Chain, frame: Frames, j: int, offset: Array) -> Array:
    """J (…, L, 3, n) with v = J q̇ for the point `offset` of frame j, in base axes."""
    p_0t = tip_position(frame, j, offset)
    on_path = chain.path(j)
    columns = []
    for k in range(chain.n):
        z = frame.R_0j[k][..., :, 2]
        turn, slide = (1 - chain.sigma[k], chain.sigma[k]) if k in on_path else (0, 0)
        columns.append(turn * cross(z, p_0t - frame.p_0j[k]) + slide * z)  # Eq. 3
    return block([[np.zeros((3, 0)), *(column[..., None] for column in columns)]])


def link_motions(chain: Chain, frame: Frames, qd: Array, qdd: Array, gravity: Array) -> list[Motion]:
    """Forward recursion; the base, which comes last, accelerates with −g: gravity needs no further word."""
    motions = [Motion(np.zeros(3), np.zeros(3), -gravity)]
    for j, a in enumerate(chain.antecedent):
        omega_a, omegad_a, vd_a = motions[a]
        R_aj, p_aj = frame.R_aj[j], frame.p_aj[j]
        slide, turn = chain.sigma[j], 1 - chain.sigma[j]
        rate, acceleration = qd[..., j, None] * E_Z, qdd[..., j, None] * E_Z
        omega_ja = mtv(R_aj, omega_a)
        omega = omega_ja + turn * rate
        omegad = mtv(R_aj, omegad_a) + turn * (acceleration + cross(omega_ja, rate))
        vd = mtv(R_aj, vd_a + point_acceleration(omega_a, omegad_a, p_aj))
        vd = vd + slide * (acceleration + 2.0 * cross(omega_ja, rate))
        motions.insert(j, Motion(omega, omegad, vd))
    return motions


def point_acceleration(omega: Array, omegad: Array, p: Array) -> Array:
    """Acceleration of a fixed point p of a frame relative to the frame's origin."""
    return cross(omegad, p) + cross(omega, cross(omega, p))


class Reaction(NamedTuple):
    """Force and moment (about the frame's origin) that each link receives through its joint, and last what
    the base receives from below."""

    force: list[Array]
    moment: list[Array]


def reactions(chain: Chain, frame: Frames, motions: list[Motion], tips: "Reaction") -> Reaction:
    """The backward recursion; `tips` are the wrenches that the links give to the platform."""
    force, moment = list(tips.force), list(tips.moment)
    for j in range(chain.n):
        omega, omegad, vd = motions[j]
        MS, inertia = chain.MS[:, j], chain.I[:, j]
        force[j] = force[j] + chain.M[:, j, None] * vd + point_acceleration(omega, omegad, MS)
        moment[j] = moment[j] + mv(inertia, omegad) + cross(omega, mv(inertia, omega)) + cross(MS, vd)
    for j in reversed(range(chain.n)):
        a, passed = chain.antecedent[j], mv(frame.R_aj[j], force[j])
        force[a] = force[a] + passed
        moment[a] = moment[a] + mv(frame.R_aj[j], moment[j]) + cross(frame.p_aj[j], passed)
    return Reaction(force, moment)


def unloaded(chain: Chain) -> Reaction:
    """No wrenches, of the links and of the base."""
    none = [np.zeros(3)] * (chain.n + 1)
    return Reaction(none, list(none))


def inverse_dynamics(
    chain: Chain, frame: Frames, motions: list[Motion], qdd: Array, tips: "Reaction | None" = None
) -> Array:
    """Joint torques τ (…, L, n) = A q̈ + c (+ Jᵀ f) of the trees, without friction and springs."""
    force, moment = reactions(chain, frame, motions, unloaded(chain) if tips is None else tips)
    torque = []
    for j, slides in enumerate(chain.sigma):
        axial = slides * force[j][..., 2] + (1 - slides) * moment[j][..., 2]
        torque.append(axial + chain.IA[:, j] * qdd[..., j])
    return stack(torque)


def friction(chain: Chain, qd: Array) -> Array:
    """Viscous and smoothed Coulomb friction (…, L, n), against the motion."""
    return chain.Fv * qd + chain.Fs * qd / np.sqrt(qd * qd + chain.v_s * chain.v_s)


def stretch(chain: Chain, joints: Joints) -> Array:
    """q − q_0 (…, L, n) of the springs: for revolute joints the angle in (−π, π]."""
    return stack([joint_position(chain, joints, j, chain.q_0[:, j]) for j in range(chain.n)])


def joint_position(chain: Chain, joints: Joints, j: int, reference: Array) -> Array:
    """q_j less a constant reference (L,): (…, L), for a revolute joint an angle in (−π, π]."""
    if chain.sigma[j]:
        return joints.length[..., j] - reference
    c0, s0 = exact_cos_sin(reference)
    c, s = joints.cos[..., j], joints.sin[..., j]
    return np.arctan2(s * c0 - c * s0, c * c0 + s * s0)


def inertia_matrix(chain: Chain, frame: Frames) -> Array:
    """A (…, L, n, n) by composite links: each joint moves all that hangs on it as one body."""
    M = [chain.M[:, j] for j in range(chain.n)]
    MS = [chain.MS[:, j] for j in range(chain.n)]
    inertia = [chain.I[:, j] for j in range(chain.n)]
    entry: dict[tuple[int, int], Array] = {}
    for j in reversed(range(chain.n)):
        slide, turn = chain.sigma[j], 1 - chain.sigma[j]
        force = slide * M[j][..., None] * E_Z + turn * cross(E_Z, MS[j])
        moment = slide * cross(MS[j], E_Z) + turn * inertia[j][..., :, 2]
        k = j
        while k >= 0:
            axial = chain.sigma[k] * force[..., 2] + (1 - chain.sigma[k]) * moment[..., 2]
            entry[j, k] = entry[k, j] = axial
            force, moment = mv(frame.R_aj[k], force), mv(frame.R_aj[k], moment)
            moment = moment + cross(frame.p_aj[k], force)
            k = chain.antecedent[k]
        entry[j, j] = entry[j, j] + chain.IA[:, j]
        a = chain.antecedent[j]
        if a >= 0:
            M_a, MS_a, I_a = in_antecedent(frame.R_aj[j], frame.p_aj[j], M[j], MS[j], inertia[j])
            M[a], MS[a], inertia[a] = M[a] + M_a, MS[a] + MS_a, inertia[a] + I_a
    zero = np.zeros(())
    return matrix([[entry.get((i, k), zero) for k in range(chain.n)] for i in range(chain.n)])


def in_antecedent(R: Array, p: Array, M: Array, MS: Array, inertia: Array) -> tuple[Array, Array, Array]:
    """Mass, first moment and inertia of a body, taken to the frame that sees it at (R, p)."""
    MS_a = mv(R, MS)
    both = outer(p, MS_a) + outer(MS_a, p) + M[..., None, None] * outer(p, p)
    return (
        M,
        MS_a + M[..., None] * p,
        R @ inertia @ transpose(R) + trace(both)[..., None, None] * np.eye(3) - both,
    )


def potential_energy(chain: Chain, frame: Frames, gravity: Array) -> Array:
    """−g·Σ (M p_0j + R_0j MS): (…, L), zero at the base frame."""
    moments = [
        chain.M[:, j, None] * frame.p_0j[j] + mv(frame.R_0j[j], chain.MS[:, j]) for j in range(chain.n)
    ]
    return -dot(gravity, sum(moments, np.zeros(3)))
