"""The places and frequencies that a platform's modes resolve, and warnings where more is asked."""

import warnings
from collections.abc import Iterable

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import BeyondBasis
from parflex.linear.place import NodePlace
from parflex.linear.signal import Signal
from parflex.robot.body import FlexibleBody

MISSED = 0.01  # of the static compliance at a node: beyond it a response is not that of the platform
CARRIED = 0.5  # of the highest free–free mode: up to here a basis with static shapes is right to 1e-3


def check_places(body: FlexibleBody, signals: Iterable[Signal]) -> None:
    """Warn of nodes at which the modes lack static compliance, each once."""
    if body.missed is None:
        return
    named = {each.node for each in signals if isinstance(each, NodePlace)}
    for node in sorted(named):
        lacking = float(body.missed[node])
        if np.isnan(lacking):
            words = "which is none of the places of its basis, so that shapes under forces there are lacking"
        elif lacking > MISSED:
            words = f"where its modes lack {100 * lacking:.2g} % of the platform's static compliance"
        else:
            continue
        warnings.warn(
            f"node {node} is asked for, {words}; name the point as tool= when the modes are computed, "
            f"pf.fe.FreeFreeWithAttachment(n, points, tool=…)",
            BeyondBasis,
            stacklevel=4,
        )


def check_band(body: FlexibleBody, w: Array) -> None:
    """Warn of frequencies (w,) rad/s beyond half the highest free–free mode of the platform's basis."""
    if body.band is None or np.max(w, initial=0.0) <= CARRIED * body.band:
        return
    top, most = np.max(w) / (2 * np.pi), CARRIED * body.band / (2 * np.pi)
    warnings.warn(
        f"omega reaches {top:.4g} Hz, but the platform's modes are right up to {most:.4g} Hz, half their "
        f"highest free–free one; compute more modes, or end there",
        BeyondBasis,
        stacklevel=4,
    )
