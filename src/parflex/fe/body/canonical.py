"""One choice among equivalent modes: signs, and the orientation of degenerate clusters."""

from itertools import pairwise

import numpy as np

from parflex.base.array import Array

DEGENERATE = 1e-3  # relative gap below which neighbouring frequencies count as one
EQUAL = 1e-8  # and below which their modes may be turned into one another


def canonical(vectors: Array, frequencies: Array, deflection: Array, corners: int) -> Array:
    """Deterministic signs and orientation of clusters; deflection (nodes, N) of the columns."""
    parts = []
    for first, last in clusters(frequencies):
        w = deflection[:, first:last]
        scale = np.max(np.abs(w))
        at = next((i for i in range(1, corners + 1) if np.linalg.norm(w[i]) > 1e-6 * scale), None)
        if at is None:
            at = int(np.argmax(np.linalg.norm(w, axis=1) > 0.5 * scale))
        turn = np.linalg.qr(np.column_stack([w[at], np.eye(last - first)]))[0]
        turned = w @ turn
        moving = np.abs(turned) > 0.01 * np.max(np.abs(turned), axis=0)
        moving[at, 1:] = False
        where = [at] + [int(np.argmax(moving[1:, k])) + 1 for k in range(1, last - first)]
        sign = np.sign([turned[i, k] for k, i in enumerate(where)])
        parts.append(vectors[:, first:last] @ turn * sign)
    return np.concatenate([vectors[:, :0], *parts], axis=1)


def clusters(frequencies: Array) -> list[tuple[int, int]]:
    """Ranges of modes whose neighbours lie closer than `EQUAL`."""
    N = len(frequencies)
    breaks = [i for i in range(1, N) if not close(frequencies, i, EQUAL)]
    return [(a, b) for a, b in pairwise([0, *breaks, N]) if b > a]


def close(frequencies: Array, i: int, gap: float = DEGENERATE) -> bool:
    """True where mode i and the one before it count as degenerate."""
    return bool(frequencies[i] - frequencies[i - 1] < gap * frequencies[i])


def cut_pair(frequencies: Array, n_modes: int) -> tuple[str, ...]:
    """A note where the last mode asked for and the next one are degenerate."""
    if not 0 < n_modes < len(frequencies) or not close(frequencies, n_modes):
        return ()
    return (
        f"{n_modes} modes cut a degenerate pair in two (modes {n_modes} and {n_modes + 1}, "
        f"{frequencies[n_modes - 1]:.2f} rad/s): results depend on the pair's orientation; "
        f"{n_modes - 1} or {n_modes + 1} modes do not",
    )
