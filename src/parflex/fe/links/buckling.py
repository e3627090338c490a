"""The doubt about links that do not know what foreshortening does to them."""

import warnings

import numpy as np

from parflex.base.errors import NoForeshortening
from parflex.robot.body import FlexibleBody


def buckling_load(body: FlexibleBody, attachment: int) -> float:
    """An estimate of Euler's load (N) of a link that is pinned at its frame and at an attachment, from the
    stiffness k of its softest bending there: π² E I / ℓ² with k = 3 E I / ℓ³; infinite where it does not
    bend."""
    point, Phi = body.attachment_points[attachment], body.attachment_shapes[attachment]
    length = float(np.linalg.norm(point))
    across = np.eye(3) - np.outer(point, point) / length**2
    bent = across @ Phi
    compliance = float(np.max(np.linalg.eigvalsh(bent / body.stiffness @ bent.T), initial=0.0))
    return np.pi**2 * length / (3.0 * compliance) if compliance > 0 else np.inf


def doubt_buckling(body: FlexibleBody) -> None:
    """Warn that a link has no foreshortening, and of the loads along it that this is wrong for."""
    load = min(buckling_load(body, each) for each in range(len(body.attachments)))
    if np.isinf(load):
        return
    warnings.warn(
        f"the link has no foreshortening, which its matrices or modes do not tell: a load P along it changes "
        f"its bending by P / P_cr in the wrong direction, P_cr about {load:.3g} N from its first bending "
        f"stiffness; keep loads far below that, give foreshortening (attachments, 3, N, N) in Python, or "
        f"mesh the part as a solid here",
        NoForeshortening,
        stacklevel=4,
    )
