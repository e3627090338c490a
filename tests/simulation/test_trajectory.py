"""Trajectories: what is sampled is a motion, and it is what was asked for."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import parflex as pf

STEP = 1e-4
RATE = 1e-6  # central differences of a quintic at this step


@pytest.fixture(scope="module")
def trajectory():
    rng = np.random.default_rng(0)
    positions = rng.normal(size=(4, 3))
    rotations = Rotation.from_rotvec(rng.normal(size=(4, 3))).as_matrix()
    return pf.Trajectory(positions, rotations, [1.0, 0.7, 1.3], rest=(0.5, 0.25))


def test_poses_are_reached(trajectory):
    assert trajectory.duration == pytest.approx(3.75)
    for k, t in enumerate((0.5, 1.5, 2.2, 3.5)):
        sample = trajectory.sample(t)
        assert np.allclose(sample.position, trajectory.positions[k], atol=1e-12)
        assert np.allclose(sample.rotation, trajectory.rotations[k], atol=1e-12)
        assert np.allclose(sample.twist, 0, atol=1e-12)
        assert np.allclose(sample.acceleration, 0, atol=1e-9)


def test_rest_before_and_after(trajectory):
    for t in (-1.0, 0.0, 0.3, 3.6, 9.0):
        sample = trajectory.sample(t)
        assert np.allclose(sample.twist, 0)
        assert np.allclose(sample.acceleration, 0)


def test_twist_is_the_rate_of_the_pose(trajectory):
    """v_p = Rᵀ ṗ and ω̂ = Rᵀ Ṙ, by central differences."""
    t = np.linspace(0.55, 3.45, 83)
    before, now, after = (trajectory.sample(t + s) for s in (-STEP, 0, STEP))
    velocity = (after.position - before.position) / (2 * STEP)
    R_t = np.swapaxes(now.rotation, -1, -2)
    assert np.allclose(now.twist[:, :3], (R_t @ velocity[..., None])[..., 0], atol=RATE)
    spin = R_t @ (after.rotation - before.rotation) / (2 * STEP)
    omega = np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]], axis=-1)
    assert np.allclose(now.twist[:, 3:], omega, atol=RATE)


def test_acceleration_is_resolved_in_the_platform(trajectory):
    """v̇_p = Rᵀ p̈, not the rate of the components of v_p; ω̇_p is that of ω_p's."""
    t = np.linspace(0.55, 3.45, 83)
    before, now, after = (trajectory.sample(t + s) for s in (-STEP, 0, STEP))
    to_world = [(s.rotation @ s.twist[:, :3, None])[..., 0] for s in (before, after)]
    second = (to_world[1] - to_world[0]) / (2 * STEP)
    expected = (np.swapaxes(now.rotation, -1, -2) @ second[..., None])[..., 0]
    assert np.allclose(now.acceleration[:, :3], expected, atol=20 * RATE)
    turning = (after.twist[:, 3:] - before.twist[:, 3:]) / (2 * STEP)
    assert np.allclose(now.acceleration[:, 3:], turning, atol=20 * RATE)


def test_acceleration_is_continuous(trajectory):
    """Across every pose, the jump vanishes with the step."""
    for t in (0.5, 1.5, 2.2, 3.5):
        left, right = trajectory.sample(t - 1e-9), trajectory.sample(t + 1e-9)
        assert np.allclose(left.acceleration, right.acceleration, atol=1e-6)


def test_orientation_goes_along_the_geodesic(trajectory):
    """At half time of a move, half of the rotation between its poses."""
    start, end = (Rotation.from_matrix(trajectory.rotations[k]) for k in (1, 2))
    half = start * Rotation.from_rotvec(0.5 * (start.inv() * end).as_rotvec())
    assert np.allclose(trajectory.sample(1.5 + 0.35).rotation, half.as_matrix(), atol=1e-12)


def test_shapes_follow_the_times(trajectory):
    assert trajectory.sample(1.0).position.shape == (3,)
    grid = trajectory.sample(np.linspace(0, 3, 12).reshape(3, 4))
    assert grid.rotation.shape == (3, 4, 3, 3)
    assert grid.acceleration.shape == (3, 4, 6)
    assert np.allclose(grid.position[1, 2], trajectory.sample(np.linspace(0, 3, 12)[6]).position)


def test_equal_orientations_do_not_turn():
    still = pf.Trajectory([(0, 0, 0), (1, 0, 0)], [np.eye(3)] * 2, [1.0], rest=(0, 0))
    sample = still.sample(0.4)
    assert np.allclose(sample.rotation, np.eye(3))
    assert np.allclose(sample.twist[3:], 0)
    s = 10 * 0.4**3 - 15 * 0.4**4 + 6 * 0.4**5
    assert np.allclose(sample.position, (s, 0, 0))
