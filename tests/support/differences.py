"""Derivatives by central differences, extrapolated once."""

import numpy as np
from scipy.spatial.transform import Rotation

from parflex.simulation.laws.bound import BoundLaw

STEP = 1e-4


def moved(x: np.ndarray, step: np.ndarray) -> np.ndarray:
    """A flat state after a small motion (δp, δθ, …)."""
    y = np.concatenate([x[:3] + step[:3], x[3:7], x[7:] + step[6:]])
    turned = Rotation.from_quat(x[3:7], scalar_first=True) * Rotation.from_rotvec(step[3:6])
    y[3:7] = turned.as_quat(scalar_first=True)
    return y


def difference(function, size: int, step: float = STEP) -> np.ndarray:
    """∂function/∂δ at 0 by central differences, extrapolated once."""

    def central(i, h):
        d = np.zeros(size)
        d[i] = h
        return (function(d) - function(-d)) / (2 * h)

    columns = [(4 * central(i, step / 2) - central(i, step)) / 3 for i in range(size)]
    return np.stack(columns, axis=-1) if columns else np.zeros((len(function(np.zeros(0))), 0))


def by_column(found, expected) -> float:
    """Largest difference of a column, of its largest entry or 1."""
    assert found.shape == expected.shape
    scale = np.maximum(1.0, np.max(np.abs(expected), axis=0))
    return float(np.max(np.abs(found - expected) / scale, initial=0.0))


def by_differences(law: BoundLaw, t: float, x: np.ndarray) -> np.ndarray:
    """∂ẋ/∂x of the law's motion, entry by entry of the flat state, the quaternion's length among them."""
    n = len(x)

    def central(h: float) -> np.ndarray:
        ahead, behind = (law.replay(np.full(n, t), x + step * np.eye(n)).rate for step in (h, -h))
        return (ahead - behind).T / (2 * h)

    return (4 * central(STEP / 2) - central(STEP)) / 3
