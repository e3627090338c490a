"""Modes of a free body, held at the frame of a link: less the motion of the frame's nodes in the mean.

Φ ← Φ − a − θ × (r − p), of the frame's displacement a at p and rotation θ in each mode; then eigh(K, tr P2).
"""

from dataclasses import replace

import numpy as np
from scipy.linalg import eigh

from parflex.base.array import Array, skew, transpose
from parflex.fe.body.basis import without_reduction
from parflex.fe.body.joints import with_places
from parflex.fe.links.places import Patches
from parflex.robot.modal import modal_mass
from parflex.robot.modes import Modes
from parflex.robot.moments import Moments, combined, shifted


def refixed(modes: Modes, held: Patches) -> Modes:
    """The modes, at the frame and the interfaces, of a body that is held at the frame."""
    found = with_places(without_reduction(modes), list(held.nodes), list(held.points))
    assert found.rotations is not None  # of patches
    at, p = found.corners[0], held.points[0]
    a, theta = found.shapes[:, at], found.rotations[:, at]
    moments = less_rigid(shifted(found.moments, p), a, theta)
    squares, turn = eigh(np.diag(found.frequencies**2), modal_mass(moments))
    shapes = found.shapes - a[:, None] - np.cross(theta[:, None], found.nodes - p)
    return replace(
        found,
        shapes=np.einsum("kn,kia->nia", turn, shapes),
        rotations=np.einsum("kn,kia->nia", turn, found.rotations - theta[:, None]),
        frequencies=np.sqrt(squares),
        frequency_error=np.full(len(squares), np.nan),
        moments=shifted(combined(moments, turn), -p),
    )


def less_rigid(old: Moments, a: Array, theta: Array) -> Moments:
    """The integrals, about a point, of shapes less displacements a (N, 3) of the point and rotations (N,
    3)."""
    hat = skew(theta)
    S = old.m * a + hat @ old.MS0
    P1 = a[:, :, None] * old.MS0 + hat @ old.P0
    mixed = old.S.T[:, None, :, None] * a[None, :, None, :] + old.P1[:, None] @ transpose(hat)[None]
    rigid = a[:, None, :, None] * S[None, :, None, :] + hat[:, None] @ transpose(P1)[None]
    both = np.transpose(mixed, (1, 0, 3, 2))
    return old._replace(S=old.S - S.T, P1=old.P1 - P1, P2=old.P2 - mixed - both + rigid)
