"""The inertia matrix of a robot whose legs close by themselves, in all that its state holds.

Joints that the state does not carry follow their tips: J_p δq_p = Wᵀ δ(pose, q_e) − J_s δs.
"""

import numpy as np

from parflex.base.array import Array, block, transpose
from parflex.mechanics.leg_terms import LegTerms
from parflex.mechanics.system import System


def mobile_mass(system: System) -> Array:
    """M (…, 6 + N + n, 6 + N + n) of (V̇_p, q̈_e, s̈) at a batch of states."""
    mechanism, (A_rr, A_re, _, _) = system.mechanism, system.platform
    first, tip = 6 + mechanism.platform.modes, 0
    body = block([[A_rr, A_re], [transpose(A_re), mechanism.platform.m_ee]])
    size = first + mechanism.layout.carried
    found = np.zeros((*body.shape[:-2], size, size))
    found[..., :first, :first] = body
    W = np.concatenate([system.W_p, np.broadcast_to(system.W_e, (*body.shape[:-2], *system.W_e.shape))], -2)
    for leg in system.legs:
        rows, count = 3 * len(leg.group.tip_frames), len(leg.group.legs)
        W_legs = W[..., tip : tip + rows * count].reshape((*W.shape[:-1], count, rows))
        T = followed(leg, np.moveaxis(W_legs, -2, -3))
        of_legs = transpose(T) @ leg.A @ T
        for i, carried in enumerate(leg.group.carried):
            places = np.concatenate([np.arange(first), first + carried])
            found[..., places[:, None], places] += of_legs[..., i, :, :]
        tip += rows * count
    return found


def followed(leg: LegTerms, W: Array) -> Array:
    """δz (…, L, z, 6 + N + s) by the platform, of maps W (…, L, 6 + N, 3t), and by carried coordinates."""
    z, kept = leg.group.chain.size, list(leg.group.kept)
    follows = np.setdiff1d(np.arange(z), kept)
    first = W.shape[-2]
    found = np.zeros((*leg.A.shape[:-1], first + len(kept)))
    found[..., kept, first + np.arange(len(kept))] = 1.0
    if len(follows):
        pushed = np.concatenate([transpose(W), -leg.J[..., kept]], axis=-1)
        found[..., follows, :] = np.linalg.solve(leg.J[..., follows], pushed)
    return found
