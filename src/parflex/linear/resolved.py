"""Warnings where a response is asked for that means little: beyond what a platform's modes resolve, or about
an equilibrium that does not last."""

import warnings
from collections.abc import Iterable

import numpy as np

from parflex.base.array import Array
from parflex.base.errors import BeyondBasis, UnstableEquilibrium
from parflex.linear.matrices import Matrices
from parflex.linear.place import NodePlace
from parflex.linear.signal import Signal
from parflex.robot.body import FlexibleBody

MISSED = 0.01  # of the static compliance at a node: beyond it a response is not that of the platform
GROWING = 1e-6  # of the fastest pole: less growth is round-off, as of motions that nothing holds
CARRIED = 0.5  # of the highest free–free mode: up to here a basis with static shapes is right to 1e-3


def check_places(body: FlexibleBody, signals: Iterable[Signal]) -> None:
    """Warn of nodes at which the modes lack static compliance, each once."""
    if body.missed is None or not body.modes:
        return
    named = {each.node for each in signals if isinstance(each, NodePlace)}
    for node in sorted(named):
        lacking = float(body.missed[node])
        if np.isnan(lacking):
            words = "which is none of the places of its basis, so that shapes under forces there are lacking"
        elif lacking > MISSED:
            words = f"where its modes lack {100 * lacking:.3g} % of the platform's static compliance"
        else:
            continue
        warnings.warn(
            f"node {node} is asked for, {words}; name the point as tool= when the modes are computed, "
            f"pf.fe.FreeFreeWithAttachment(n, points, tool=…)",
            BeyondBasis,
            stacklevel=4,
        )


def check_meant(lin: Matrices, w: Array) -> None:
    """Warn of responses at frequencies (w,) rad/s that the system does not have, or that nobody sees."""
    check_band(lin.point.mechanism.robot.platform, w)
    check_stable(lin)


def check_stable(lin: Matrices) -> None:
    """Warn of an equilibrium about which a motion grows."""
    poles = np.linalg.eigvals(lin.own)
    growth = float(np.max(poles.real, initial=0.0))
    if growth > GROWING * np.max(np.abs(poles), initial=0.0):
        warnings.warn(
            f"the equilibrium is unstable: a motion grows e-fold in {1 / growth:.3g} s, {growth:.3g} 1/s, so "
            f"that no response settles; hold the motors with controller=, or with springs beside them, or "
            f"carry less than the legs buckle under",
            UnstableEquilibrium,
            stacklevel=5,
        )


def check_band(body: FlexibleBody, w: Array) -> None:
    """Warn of frequencies (w,) rad/s beyond half the highest free–free mode of the platform's basis."""
    if body.band is None or not body.modes or np.max(w, initial=0.0) <= CARRIED * body.band:
        return
    top, most = np.max(w) / (2 * np.pi), CARRIED * body.band / (2 * np.pi)
    warnings.warn(
        f"omega reaches {top:.4g} Hz, but the platform's modes are right up to {most:.4g} Hz, half their "
        f"highest free–free one; compute more modes, or end there",
        BeyondBasis,
        stacklevel=4,
    )
