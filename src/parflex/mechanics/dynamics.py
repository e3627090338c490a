"""The dynamic models in contact form: one symmetric system in the forces between legs and platform.

Legs:      A z̈ + c = S Γ − Jᵀ f
Platform:  M_p (V̇_p, q̈_e) + c_p = W f + w
Closure:   J z̈ + J̇ż = Wᵀ (V̇_p, q̈_e) + h

Eliminating the accelerations leaves
(Wᵀ M_p⁻¹ W + J A⁻¹ Jᵀ) f = J A⁻¹ (S Γ − c) + J̇ż − h + Wᵀ M_p⁻¹ (c_p − w),
positive definite for any number of modes, without J⁻¹. It equals Eqs. 36–49 (`cartesian.py`), and
holds for legs of any kind. Rows of the closure that depend on others are left out of the solution;
the contact forces are then those of least norm.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from parflex.base.array import Array, merged, mtv, mv, stack, transpose
from parflex.base.unroll import each, factored_solve, solve_definite, solve_least_norm
from parflex.mechanics.contact import Contact, contact_forces, contact_system, legs_at_tips, loaded
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.output import Output
from parflex.mechanics.stiffening import stiffened
from parflex.mechanics.system import System, assemble
from parflex.robot.layout import Coordinates


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


def direct(mechanism: Mechanism, x: Coordinates, forces: Array, wrench: Array) -> Acceleration:
    """The direct dynamic model: accelerations and contact forces for given Γ (…, m).

    wrench (…, 6 + N) is the generalised force of external loads.
    """
    return direct_of(assemble(mechanism, x), forces, wrench)


def direct_of(system: System, forces: Array, wrench: Array) -> Acceleration:
    """The direct model of an assembled system."""
    contact = contact_system(system, wrench)
    rhs = contact.rhs + mv(contact.JAS, forces)
    f = contact_forces(system.mechanism, contact.C, rhs[..., None])[..., 0]
    return accelerations(system, contact, f)


def inverse(
    mechanism: Mechanism,
    x: Coordinates,
    target: Array,
    wrench: Array,
    output: Output,
    preload: Array | None = None,
) -> Inverse:
    """The inverse dynamic model: Γ for a wanted output acceleration (…, o).

    The model is affine in Γ: one factorisation serves Γ = 0 and the columns of S; the map from Γ
    to the output is then solved. Where there are more actuators than outputs Γ is the nearest to
    `preload` (…, m), by default the shortest.
    """
    preload = np.zeros(mechanism.n_forces) if preload is None else preload
    return inverse_of(assemble(mechanism, x), target, wrench, output, preload)


def inverse_of(
    system: System,
    target: Array,
    wrench: Array,
    output: Output,
    preload: Array,
    unforeseen: Array | None = None,
) -> Inverse:
    """The inverse model of an assembled system; accelerations are those under one more load, unforeseen."""
    contact = contact_system(system, wrench)
    actual = contact if unforeseen is None else loaded(system, contact, unforeseen)
    columns = np.concatenate([stack([contact.rhs, actual.rhs]), contact.JAS], axis=-1)
    f = contact_forces(system.mechanism, contact.C, columns)
    f_0, f_1, F = f[..., 0], f[..., 1], f[..., 2:]
    free = accelerations(system, contact, f_0)
    gain = output.gain(system, contact, F, acceleration_map(system, contact, F))
    reached = output.free(system, f_0, (free.platform[..., None], free.elastic[..., None])) + mv(
        gain, preload
    )
    forces = preload + solve_least_norm(gain, target - reached)
    driven = accelerations(system, actual, f_1 + mv(F, forces))
    return Inverse(forces, driven, gain)


def gains(system: System, output: Output) -> tuple[Array, Array]:
    """∂output/∂Γ (…, o, m), and what it would be if neither platform nor legs could bend."""
    none, stiff = np.zeros(6 + system.mechanism.platform.modes), stiffened(system)
    contact = contact_system(system, none)
    F = contact_forces(system.mechanism, contact.C, contact.JAS)
    flexible = output.gain(system, contact, F, acceleration_map(system, contact, F))
    rigid = contact if stiff is system else contact_system(stiff, none)
    F, Vd = frozen(stiff, rigid.compliance, rigid.JAS)
    still = np.zeros(Vd.shape[:-2] + (system.mechanism.platform.modes, Vd.shape[-1]))
    return flexible, output.gain(stiff, rigid, F, (Vd, still))


def frozen_inverse(system: System, target: Array) -> tuple[Array, Array]:
    """Γ (…, m) and contact forces (…, 3k) for a wanted V̇_p (…, 6), platform and legs frozen in their bend.

    At rest these are the forces of the equilibrium with that bend. Of more than six actuators they are the
    shortest; fewer give what comes nearest, angular rows in metres.
    """
    system = stiffened(system)
    legs, W_p, (A_rr, _, c_r, _) = legs_at_tips(system), system.W_p, system.platform
    fall = solve_definite(A_rr, c_r[..., None])
    rhs = (legs.drift - merged(system.points.h))[..., None] + transpose(W_p) @ fall
    F, moved = frozen(system, legs.compliance, np.concatenate([rhs, legs.driven], axis=-1))
    gain, left = moved[..., 1:], target - moved[..., 0] + fall[..., 0]
    if gain.shape[-1] >= gain.shape[-2]:
        forces = solve_least_norm(gain, left)
    else:
        weighted = transpose(gain) * np.repeat([1.0, system.mechanism.size**2], 3)
        forces = solve_definite(weighted @ gain, mv(weighted, left)[..., None])[..., 0]
    return forces, F[..., 0] + mv(F[..., 1:], forces)


def frozen(system: System, compliance: Array, columns: Array) -> tuple[Array, Array]:
    """f (…, 3k, c) and A_rr⁻¹ W_p f (…, 6, c) of a platform frozen in its bend on stiffened legs, for
    C_r f = columns (…, 3k, c), C_r = W_pᵀ A_rr⁻¹ W_p + J A⁻¹ Jᵀ."""
    A_rr, W_p = system.platform.A_rr, system.W_p
    C = transpose(W_p) @ solve_definite(A_rr, W_p) + compliance
    unbent = replace(system.mechanism, rows=system.mechanism.rows_unbent)
    f = contact_forces(unbent, C, columns)
    return f, solve_definite(A_rr, W_p @ f)


def accelerations(system: System, contact: Contact, f: Array) -> Acceleration:
    """(V̇_p, q̈_e) = M_p⁻¹ (W f − c_p) for contact forces f (…, 3k)."""
    E, A_s, B = contact.inertia
    Vd = factored_solve(A_s, (mv(B, f) - contact.c_s)[..., None])[..., 0]
    elastic = system.mechanism.platform.modal_solve((mv(system.W_e, f) - contact.c_e)[..., None])[..., 0]
    return Acceleration(Vd, elastic - mtv(E, Vd), f)  # Eq. 43


def acceleration_map(system: System, contact: Contact, F: Array) -> tuple[Array, Array]:
    """The linear part of `accelerations` for columns of contact forces (…, 3k, c)."""

    def moved(F: Array, E: Array, A_s: Array, B: Array, soft: Array) -> Array:
        Vd = factored_solve(A_s, B @ transpose(F))
        return transpose(np.concatenate([Vd, soft @ transpose(F) - transpose(E) @ Vd], axis=-2))

    both = each(moved, [transpose(F)], [*contact.inertia, system.mechanism.platform.modal_solve(system.W_e)])
    return transpose(both[..., :6]), transpose(both[..., 6:])
