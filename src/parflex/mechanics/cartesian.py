"""The Cartesian form A V̇_p + c = J_sys⁻ᵀ Γ of the paper (Sec. 5, Eqs. 36–49).

The legs are taken to the attachment points by J_i⁻¹, so each needs as many joints as its tips have
force components. It is offered for those who want it, and is the identity test of the contact form.
"""

from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, block_diagonal, join, merged, mtv, mv, transpose
from parflex.base.errors import InputError, SingularPose
from parflex.base.unroll import solve_definite
from parflex.mechanics import kinematics
from parflex.mechanics.leg_terms import LegTerms
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.system import System, actuated_axes, assemble, diagonal
from parflex.robot.layout import Coordinates

SINGULAR = 1e-8  # smallest acceptable ratio of a leg Jacobian's singular values, its columns of unit length


class Cartesian(NamedTuple):
    """A (…, 6, 6), c (…, 6), J_sys⁻ᵀ (…, 6, m), all in Σp."""

    A: Array
    c: Array
    Jsys_invT: Array


class Elastic(NamedTuple):
    """q̈_e = A_ee⁻¹ (J_e⁻ᵀ Γ − A_er V̇_p − c_t)."""

    A_ee: Array  # (…, N, N)
    A_er: Array  # (…, N, 6)
    c_t: Array  # (…, N)
    Je_invT: Array  # (…, N, m)


def cartesian(mechanism: Mechanism, x: Coordinates) -> tuple[Cartesian, Elastic]:
    """The Cartesian dynamic model of the robot, and the elastic accelerations that go with it."""
    system = assemble(mechanism, x)
    A_x, c_x = legs_at_tips(system)
    A_rr, A_re, c_r, c_e = system.platform
    W_p, W_e, h = system.W_p, system.W_e, kinematics.stacked(system.points.h)
    Jp_invT, Je_invT = kinematics.actuator_jacobian(W_p, W_e, actuated_axes(system))

    A_ee = mechanism.platform.m_ee + W_e @ A_x @ transpose(W_e)  # Eq. 45
    A_er = transpose(A_re) + W_e @ A_x @ transpose(W_p)
    reaction = mv(A_x, h) + c_x  # Eqs. 39, 40 at rest
    c_t = mv(W_e, reaction) + c_e  # Eq. 42
    columns = np.concatenate([A_er, Je_invT, c_t[..., None]], axis=-1)
    eliminated = transpose(A_er) @ solve_definite(A_ee, columns)
    A = A_rr + W_p @ A_x @ transpose(W_p) - eliminated[..., :6]  # Eqs. 41, 47
    Jsys_invT = Jp_invT - eliminated[..., 6:-1]  # Eq. 48
    c = c_r + mv(W_p, reaction) - eliminated[..., -1]  # Eq. 49
    return Cartesian(A, c, Jsys_invT), Elastic(A_ee, A_er, c_t, Je_invT)


def direct(mechanism: Mechanism, x: Coordinates, forces: Array) -> tuple[Array, Array]:
    """V̇_p (…, 6) and q̈_e (…, N) for given Γ (…, m)."""
    form, elastic = cartesian(mechanism, x)
    Vd = solve_definite(form.A, (mv(form.Jsys_invT, forces) - form.c)[..., None])[..., 0]  # Eq. 46
    return Vd, elastic_acceleration(elastic, Vd, forces)


def inverse(mechanism: Mechanism, x: Coordinates, Vd: Array) -> tuple[Array, Array]:
    """Γ (…, 6) and q̈_e (…, N) for a wanted V̇_p (…, 6)."""
    form, elastic = cartesian(mechanism, x)
    forces = np.linalg.solve(form.Jsys_invT, (mv(form.A, Vd) + form.c)[..., None])[..., 0]
    return forces, elastic_acceleration(elastic, Vd, forces)


def elastic_acceleration(elastic: Elastic, Vd: Array, forces: Array) -> Array:
    """q̈_e (…, N) that goes with V̇_p and Γ."""
    driving = mv(elastic.Je_invT, forces) - mv(elastic.A_er, Vd) - elastic.c_t
    return solve_definite(elastic.A_ee, driving[..., None])[..., 0]  # Eq. 44


def legs_at_tips(system: System) -> tuple[Array, Array]:
    """A_x (…, 3k, 3k) = J⁻ᵀ A J⁻¹ and c_x (…, 3k): f = a_3 Γ − A_x v̇ − c_x."""
    inertia, bias = [], []
    for leg in system.legs:
        J_inv = inverse_jacobian(leg)
        A_x = transpose(J_inv) @ leg.A @ J_inv  # Eq. 36
        c_x = mtv(J_inv, leg.c) - mv(A_x, leg.Jdqd)  # Eq. 37
        inertia.append(block_diagonal(A_x))
        bias.append(merged(c_x))
    return diagonal(inertia), join([np.zeros(0), *bias])


def inverse_jacobian(leg: LegTerms) -> Array:
    """J_i⁻¹ (…, L, n, 3t) in Σp."""
    contacts, joints = leg.J.shape[-2:]
    if contacts != joints:
        raise InputError(
            f"the Cartesian form needs J⁻¹ of every leg, but legs {leg.group.legs} have {joints} "
            f"joints and shapes, and {contacts} contact force components; use model.direct and model.inverse"
        )
    lengths = np.linalg.norm(leg.J, axis=-2, keepdims=True)
    sizes = np.linalg.svd(leg.J / np.maximum(lengths, np.finfo(float).tiny), compute_uv=False)
    bad = np.argwhere(sizes[..., -1] <= SINGULAR * sizes[..., 0])
    if len(bad):
        raise SingularPose(
            f"the Cartesian form needs J⁻¹ of every leg, but the tip of leg {leg.group.legs[bad[0][-1]] + 1} "
            f"cannot move in all directions; move the pose, or use model.direct and model.inverse"
        )
    return np.linalg.inv(leg.J)


def tip_force(leg: LegTerms, axes: Array, forces: Array, qdd: Array) -> Array:
    """f (…, L, 3t) of the legs of a group on the platform, from q̈ (…, L, n).

    axes (…, L, 3t, m_i) are the columns of J⁻ᵀ S, forces (…, L, m_i).
    """
    return mv(axes, forces) - mtv(inverse_jacobian(leg), mv(leg.A, qdd) + leg.c)  # Eqs. 9, 10


def tip_to_joints(leg: LegTerms, tip_accelerations: Array) -> Array:
    """q̈ (…, L, n) from the tips' accelerations (…, L, 3t) in Σp."""
    return mv(inverse_jacobian(leg), tip_accelerations - leg.Jdqd)  # Eq. 6
