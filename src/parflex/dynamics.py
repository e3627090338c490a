"""The dynamic models in contact form: one symmetric system in the forces between legs and platform.

Legs:      A q̈ + c = S Γ − Jᵀ f
Platform:  M_p (V̇_p, q̈_e) + c_p = W f + w
Closure:   J q̈ + J̇q̇ = Wᵀ (V̇_p, q̈_e) + h

Eliminating the accelerations leaves
(Wᵀ M_p⁻¹ W + J A⁻¹ Jᵀ) f = J A⁻¹ (S Γ − c) + J̇q̇ − h + Wᵀ M_p⁻¹ (c_p − w),
positive definite for any number of modes, without J⁻¹. It equals Eqs. 36–49 (`cartesian.py`), and
holds for legs of any kind. Rows of the closure that depend on others are left out of the solution;
the contact forces are then those of least norm.
"""

from typing import NamedTuple

import numpy as np

from parflex import kinematics
from parflex.array import (
    Array,
    block_diagonal,
    join,
    merged,
    mtv,
    mv,
    solve_definite,
    solve_least_norm,
    transpose,
)
from parflex.assembly import System, assemble, diagonal, selection
from parflex.body import FlexibleBody
from parflex.output import Output
from parflex.robot import Robot
from parflex.state import Coordinates


class MobileInertia(NamedTuple):
    """M_p⁻¹ with the modal block eliminated first: m_ee is constant, the rest has rank six."""

    E: Array  # (…, 6, N), A_re m_ee⁻¹
    A_s: Array  # (…, 6, 6), A_rr − E A_reᵀ
    B: Array  # (…, 6, 3k), W_p − E W_e


class Contact(NamedTuple):
    """The contact system: C f = rhs + JAS Γ."""

    inertia: MobileInertia
    C: Array  # (…, 3k, 3k)
    compliance: Array  # (…, 3k, 3k), the legs' part of C
    rhs: Array  # (…, 3k)
    JAS: Array  # (…, 3k, m)
    c_s: Array  # (…, 6), c_r − E c_e
    c_e: Array  # (…, N)


class Acceleration(NamedTuple):
    """V̇_p (…, 6), q̈_e (…, N) and the contact forces f (…, 3k) on the platform, all in Σp."""

    platform: Array
    elastic: Array
    contact: Array


class Inverse(NamedTuple):
    """Γ (…, m), the accelerations that go with it, ∂output/∂Γ (…, o, m)."""

    forces: Array
    acceleration: Acceleration
    gain: Array


def direct(robot: Robot, x: Coordinates, forces: Array, wrench: Array) -> Acceleration:
    """The direct dynamic model: accelerations and contact forces for given Γ (…, m).

    wrench (…, 6 + N) is the generalised force of external loads.
    """
    return direct_of(robot, assemble(robot, x), forces, wrench)


def direct_of(robot: Robot, system: System, forces: Array, wrench: Array) -> Acceleration:
    """The direct model of an assembled system."""
    contact = contact_system(robot, system, wrench)
    rhs = contact.rhs + mv(contact.JAS, forces)
    f = contact_forces(robot, contact.C, rhs[..., None])[..., 0]
    return accelerations(robot.platform, system, contact, f)


def inverse(
    robot: Robot, x: Coordinates, target: Array, wrench: Array, output: Output, preload: Array | None = None
) -> Inverse:
    """The inverse dynamic model: Γ for a wanted output acceleration (…, o).

    The model is affine in Γ: one factorisation serves Γ = 0 and the columns of S; the map from Γ
    to the output is then solved. Where there are more actuators than outputs Γ is the nearest to
    `preload` (…, m), by default the shortest.
    """
    preload = np.zeros(robot.n_forces) if preload is None else preload
    return inverse_of(robot, assemble(robot, x), target, wrench, output, preload)


def inverse_of(
    robot: Robot, system: System, target: Array, wrench: Array, output: Output, preload: Array
) -> Inverse:
    """The inverse model of an assembled system."""
    contact = contact_system(robot, system, wrench)
    columns = np.concatenate([contact.rhs[..., None], contact.JAS], axis=-1)
    f = contact_forces(robot, contact.C, columns)
    f_0, F = f[..., 0], f[..., 1:]
    free = accelerations(robot.platform, system, contact, f_0)
    body, x = robot.platform, system.x
    gain = output.linear(body, x, *acceleration_map(body, system, contact, F))
    reached = output.linear(body, x, free.platform[..., None], free.elastic[..., None])[..., 0]
    reached = reached + output.drift(body, x) + mv(gain, preload)
    forces = preload + solve_least_norm(gain, target - reached)
    driven = accelerations(robot.platform, system, contact, f_0 + mv(F, forces))
    return Inverse(forces, driven, gain)


def gains(robot: Robot, system: System, output: Output) -> tuple[Array, Array]:
    """∂output/∂Γ (…, o, m), and what it would be if the platform could not bend."""
    contact = contact_system(robot, system, np.zeros(6 + robot.platform.modes))
    F = contact_forces(robot, contact.C, contact.JAS)
    body = robot.platform
    flexible = output.linear(body, system.x, *acceleration_map(body, system, contact, F))
    A_rr, W_p = system.platform.A_rr, system.W_p
    C = transpose(W_p) @ solve_definite(A_rr, W_p) + contact.compliance
    Vd = solve_definite(A_rr, W_p @ contact_forces(robot, C, contact.JAS))
    still = np.zeros(Vd.shape[:-2] + (body.modes, Vd.shape[-1]))
    return flexible, output.linear(body, system.x, Vd, still)


def contact_forces(robot: Robot, C: Array, columns: Array) -> Array:
    """f (…, 3k, c) with C f = columns (…, 3k, c): of least norm where rows depend on others.

    Dependent rows are D times the independent ones, D = C_ds C_ss⁻¹, so that (f_s, f_d) acts as
    f_s + Dᵀ f_d; the shortest pair with the same action has f_d = D f_s.
    """
    kept, dropped, order = robot.rows
    C_s = C[..., kept, :]
    right = np.concatenate([columns[..., kept, :], C_s[..., dropped]], axis=-1)
    solved = solve_definite(C_s[..., kept], right)
    count = columns.shape[-1]
    f, D = solved[..., :count], transpose(solved[..., count:])
    excess = solve_definite(np.eye(len(dropped)) + D @ transpose(D), D @ f)
    f = f - transpose(D) @ excess
    return np.concatenate([f, D @ f], axis=-2)[..., order, :]


def contact_system(robot: Robot, system: System, wrench: Array) -> Contact:
    """The system that is left when joint and platform accelerations are eliminated."""
    body, (A_rr, A_re, c_r, c_e) = robot.platform, system.platform
    c_r, c_e = c_r - wrench[..., :6], c_e - wrench[..., 6:]
    E = transpose(body.modal_solve(transpose(A_re)))
    softness = transpose(body.modal_solve(system.W_e))
    A_s = A_rr - E @ transpose(A_re)
    B = system.W_p - E @ system.W_e
    c_s = c_r - mv(E, c_e)
    held = solve_definite(A_s, np.concatenate([B, c_s[..., None]], axis=-1))
    C = transpose(B) @ held[..., :-1] + softness @ system.W_e
    rhs = mtv(B, held[..., -1]) + mv(softness, c_e)
    rhs = rhs - kinematics.stacked(system.points.h)

    compliance, driven, drift = [], [], []
    for leg in system.legs:
        S = np.broadcast_to(selection(leg.group), leg.A.shape[:-1] + (len(leg.group.actuated),))
        columns = np.concatenate([transpose(leg.J), S, leg.c[..., None]], axis=-1)
        solved = leg.J @ solve_definite(leg.A, columns)
        contacts = leg.J.shape[-2]
        compliance.append(block_diagonal(solved[..., :contacts]))
        driven.append(block_diagonal(solved[..., contacts:-1]))
        by_tip = leg.Jdqd - solved[..., -1]
        drift.append(merged(by_tip))
    JAS = diagonal(driven)[..., robot.force_order]
    empty = np.zeros(0)
    legs = diagonal(compliance)
    return Contact(MobileInertia(E, A_s, B), C + legs, legs, rhs + join([empty, *drift]), JAS, c_s, c_e)


def accelerations(body: FlexibleBody, system: System, contact: Contact, f: Array) -> Acceleration:
    """(V̇_p, q̈_e) = M_p⁻¹ (W f − c_p) for contact forces f (…, 3k)."""
    driven = mv(contact.inertia.B, f) - contact.c_s
    Vd = solve_definite(contact.inertia.A_s, driven[..., None])[..., 0]
    elastic = body.modal_solve((mv(system.W_e, f) - contact.c_e)[..., None])[..., 0]
    return Acceleration(Vd, elastic - mtv(contact.inertia.E, Vd), f)  # Eq. 43


def acceleration_map(body: FlexibleBody, system: System, contact: Contact, F: Array) -> tuple[Array, Array]:
    """The linear part of `accelerations` for columns of contact forces (…, 3k, c)."""
    Vd = solve_definite(contact.inertia.A_s, contact.inertia.B @ F)
    elastic = body.modal_solve(system.W_e @ F)
    return Vd, elastic - transpose(contact.inertia.E) @ Vd
