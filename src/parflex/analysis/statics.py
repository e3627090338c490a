"""Forces along the motions that the closure allows, and how they change with them.

Contact forces do no work along motions T (6 + N + z, d) of Σp, of the modes and of all coordinates of the
legs that the closure allows, so that equilibrium is Tᵀ (w − c_p, S Γ − c) = 0.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from parflex.analysis.mobility import null_space
from parflex.base.array import Array, block, block_diagonal, join, merged, transpose
from parflex.kernels.jacobians import load_of
from parflex.mechanics import system as assembly
from parflex.mechanics.closure import EVERY, actuated_rows, closure_matrix, tip_matrix, units
from parflex.mechanics.derivatives.changes import Load
from parflex.mechanics.derivatives.sensitivity import direct_sensitivity
from parflex.mechanics.legs.base import LegGroup
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.system import System
from parflex.mechanics.wrench import places_of, pushes_of
from parflex.robot.wrench import Wrench


class Statics(NamedTuple):
    """A flat state at rest; motions are T = scale · basis ζ."""

    system: System
    x: Array  # the flat state
    scale: Array  # (6 + N + z,)
    basis: Array  # (6 + N + z, d), orthonormal, less what stretches stiff soft tips
    push: Array  # (d,), the forces along the motions without Γ
    drive: Array  # (d, m), those of Γ

    @property
    def T(self) -> Array:
        """(6 + N + z, d), the motions that the closure allows."""
        return self.scale[:, None] * self.basis


def statics(mechanism: Mechanism, x: Array, load: Load) -> Statics:
    """The statics at a flat state at rest, under a generalised force (6 + N,) on the platform."""
    system, scale = assembly.assembled(mechanism, x), scales(mechanism)
    basis = eased(system, scale, null_space(closure_matrix(system) * scale))
    T = scale[:, None] * basis
    of_platform = load(system.x) - join([system.platform.c_r, system.platform.c_e])
    of_legs = [-merged(leg.c) for leg in system.legs]
    return Statics(
        system, x, scale, basis, T.T @ join([of_platform, *of_legs]), (actuated_rows(mechanism) @ T).T
    )


def eased(system: System, scale: Array, basis: Array) -> Array:
    """The basis (6 + N + z, d) turned, and made shorter where it stretches soft tips more stiffly than the
    softest mode, or the softest of them, is bent; as it is without soft tips."""
    mechanism = system.mechanism
    if not mechanism.soft:
        return basis
    _, lengths, turned = np.linalg.svd(stretched(system) * scale @ basis)
    stiff = firmness(mechanism)
    soft = np.sqrt(np.min(stiff[stiff > 0], initial=np.inf) * mechanism.platform.body.moments.m)
    least = min(soft, np.min(lengths[lengths > 1e-9 * np.max(lengths, initial=0.0)], initial=np.inf))
    shorter = np.ones(len(turned))
    shorter[: len(lengths)] = np.where(lengths > least, least / np.where(lengths > 0, lengths, 1.0), 1.0)
    found: Array = (basis @ turned.T) * shorter
    return found


def stretched(system: System) -> Array:
    """√K_t ∂g (3 s, 6 + N + z) of the soft tips, one below the other, in N^½ m^½ per motion."""
    G, first = tip_matrix(system), 0
    found = [np.zeros((0, G.shape[-1]))]
    for leg in system.legs:
        group = leg.group
        places = list(np.ndindex(group.attachments.shape))
        for at, place in enumerate(places, start=first):
            if group.flexures is not None and group.soft[place[1]]:
                values, axes = np.linalg.eigh(group.flexures.translation[place])
                rows = axes.T @ system.sections.turn[at].T @ G[3 * at : 3 * at + 3]
                found.append(np.sqrt(np.maximum(values, 0.0))[:, None] * rows)
        first += len(places)
    return np.concatenate(found)


def loose_twist(at: Statics) -> Array | None:
    """A twist (6,), largest entry 1, of the platform that its tips, soft ones with their stiffness, do not
    hold while the legs stand; None where there is none, or no tip is soft."""
    mechanism = at.system.mechanism
    if not mechanism.soft:
        return None
    lengths = np.repeat([1.0, 1.0 / mechanism.size], 3)
    rows = np.concatenate([closure_matrix(at.system), stretched(at.system)])[:, :6] * lengths
    sizes = np.linalg.norm(rows, axis=1, keepdims=True)
    free = null_space(rows / np.where(sizes > 0, sizes, 1.0))
    if not free.shape[1]:
        return None
    twist: Array = lengths * free[:, 0]
    return twist / np.max(np.abs(twist))


def scales(mechanism: Mechanism) -> Array:
    """(6 + N + z,): what makes displacements comparable, in metres, and elastic ones equally stiff."""
    stiff = firmness(mechanism)
    bends = stiff > 0
    softest = np.min(stiff[bends], initial=np.inf)
    return units(mechanism, EVERY) * np.sqrt(np.where(bends, softest / np.where(bends, stiff, 1.0), 1.0))


def firmness(mechanism: Mechanism) -> Array:
    """(6 + N + z,): the stiffness of modes and links by themselves, zero for other coordinates."""
    legs = [merged(link_stiffness(group)) for group in mechanism.groups]
    return join([np.zeros(6), mechanism.platform.stiffness, *legs])


def link_stiffness(group: LegGroup) -> Array:
    """(L, z), the stiffness of the links and drives of each leg of a group, zero for its joints."""
    links = [np.asarray(link.stiffness) for link in group.chain.links if link is not None]
    drives = group.chain.drive_stiffness[:, list(group.chain.drives)]
    return join([np.zeros((len(group.legs), group.chain.n)), *links, drives])


def stiffness(at: Statics, forces: Array, load: Load) -> Array:
    """H (d, d), what the forces along the motions lose with the motions, under Γ (m,).

    ζ̈ = −(Tᵀ M T)⁻¹ H ζ about an equilibrium. Where legs without inertia leave no accelerations, it is the
    stiffness of modes and links alone.
    """
    T = at.T
    K, _ = linearised(at.system, T, forces, load)
    if not np.all(np.isfinite(K)):
        return T.T @ (firmness(at.system.mechanism)[:, None] * T)
    found: Array = -(T.T @ mass(at.system) @ T) @ K
    return found


def linearised(system: System, T: Array, forces: Array, load: Load) -> tuple[Array, Array]:
    """K and C (d, d) of ζ̈ = K ζ + C ζ̇ about an equilibrium under Γ (m,), for motions T (6 + N + z, d)."""
    mechanism, found = system.mechanism, direct_sensitivity(system, forces, load).state
    motions, first = mechanism.layout.motions, 6 + mechanism.platform.modes
    places = [motions.rotation, motions.elastic, motions.joints]
    rates = [motions.velocity, motions.omega, motions.elastic_rate, motions.joint_rates]
    by_place = [found[:, motions.position] @ system.x.rotation, *(found[:, part] for part in places)]
    moved = np.concatenate([T[:first], T[first:][mechanism.kept]])
    slopes = (np.concatenate(by_place, axis=-1), np.concatenate([found[:, part] for part in rates], axis=-1))
    K, C = (np.linalg.pinv(moved) @ part @ moved for part in slopes)
    return K, C


def mass(system: System) -> Array:
    """The inertia matrix (6 + N + z, 6 + N + z) of platform and legs, the closure aside."""
    A_rr, A_re, _, _ = system.platform
    body = block([[A_rr, A_re], [transpose(A_re), system.mechanism.platform.m_ee]])
    return assembly.diagonal([body, *(block_diagonal(leg.A) for leg in system.legs)])


def held_load(mechanism: Mechanism, wrenches: Sequence[Wrench]) -> Load:
    """The generalised force of wrenches held in the frames they are given in, as a function of the state."""
    none = np.zeros(6 + mechanism.platform.modes)
    return load_of(mechanism, places_of(wrenches), none, pushes_of(wrenches))
