"""What many tests draw and compare with: random states and forces, and the measure of agreement."""

import numpy as np
from scipy.spatial.transform import Rotation

import parflex as pf

MODES = (0, 1, 10, 40)  # rigid, one, the paper's, many


def relative(found, expected) -> float:
    """max |Δ| / max(1, max |x|), the measure of every accuracy figure."""
    found, expected = np.asarray(found), np.asarray(expected)
    assert found.shape == expected.shape
    largest = np.max(np.abs(expected), initial=1.0)
    return float(np.max(np.abs(found - expected), initial=0.0) / largest)


def random_states(robot: pf.Robot, count: int, seed: int) -> pf.State:
    """States within ±0.1 m and ±0.1 rad of home, moving and bent, as a batch."""
    rng = np.random.default_rng(seed)
    N = robot.platform.modes
    omega = np.sqrt(robot.platform.stiffness)
    slow = omega[:1] / omega
    return pf.State(
        robot.home.position + rng.uniform(-0.1, 0.1, (count, 3)),
        Rotation.from_rotvec(rng.uniform(-0.1, 0.1, (count, 3))).as_matrix(),
        rng.normal(0, 0.5, (count, 6)),
        0.01 * slow**2 * rng.normal(size=(count, N)),
        0.1 * slow * rng.normal(size=(count, N)),
    )


def random_forces(model: pf.Model, count: int, seed: int) -> np.ndarray:
    """Static forces ± 300 N."""
    _, static = model.equilibrium(*model.robot.home_pose)
    return static + np.random.default_rng(seed).uniform(-300, 300, (count, model.robot.n_forces))


def actuated(robot: pf.Robot, q) -> np.ndarray:
    """(…, m) positions of the actuated joints, of joints (…, n_i) by leg."""
    driven = [bool(joint.mu) for leg in robot.legs for joint in leg.joints]
    return np.concatenate(q, axis=-1)[..., driven]
