"""Rotations as quaternions, against SciPy."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from measures import relative
from parflex.base.spatial import (
    off_orthonormal,
    quaternion_from_rotation,
    rotation_from_vector,
    vector_from_rotation,
)

ROUND_OFF = 1e-15
HALF_TURNS = np.pi * np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [0.6, 0.8, 0], [0, -0.6, 0.8]])


def turns():
    """Random ones, about axes of the frame, none, and half a turn, where the trace is smallest."""
    rng = np.random.default_rng(0)
    vectors = [*rng.normal(0.0, 2.0, (50, 3)), *np.eye(3), np.zeros(3), *HALF_TURNS]
    return Rotation.from_rotvec(vectors).as_matrix()


def test_one_matrix_has_scipys_quaternion():
    for R in turns():
        expected = Rotation.from_matrix(R).as_quat(scalar_first=True)
        assert relative(quaternion_from_rotation(R), expected) <= ROUND_OFF


def test_a_batch_has_the_same():
    found = quaternion_from_rotation(turns()[:, None])
    assert relative(found[:, 0], [quaternion_from_rotation(R) for R in turns()]) <= ROUND_OFF


@pytest.mark.parametrize("error", [3e-10, 1e-6])
def test_what_is_not_quite_a_rotation(error):
    """Each entry of the Gram matrix counts; a matrix that is nearly one has the nearest one's quaternion."""
    R = turns()[0]
    for i in range(3):
        for j in range(3):
            off = np.eye(3)
            off[i, j] += error
            expected = np.max(np.abs(off.T @ off - np.eye(3)))
            assert relative(off_orthonormal(R @ off) / error, expected / error) <= 1e-5
            scipys = Rotation.from_matrix(R @ off).as_quat(scalar_first=True)
            assert relative(quaternion_from_rotation(R @ off), scipys) <= ROUND_OFF


def test_reflections_are_none():
    assert off_orthonormal(np.diag([1.0, 1.0, -1.0])) == np.inf


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.3, 3.1, np.pi, 4.0, 6.2])
def test_rotation_vectors_against_scipy(angle):
    """There and back; SciPy's for the same, of more than half a turn as the other way round."""
    vector = angle * np.array([2.0, -3.0, 6.0]) / 7
    expected = Rotation.from_rotvec(vector)
    R = rotation_from_vector(vector)
    assert np.allclose(R, expected.as_matrix(), rtol=0, atol=1e-15)
    found = vector_from_rotation(R)
    assert np.linalg.norm(found) <= np.pi + 1e-12
    assert np.allclose(rotation_from_vector(found), R, rtol=0, atol=1e-14)
    if angle < 3.0:
        assert np.allclose(found, vector, rtol=1e-9, atol=1e-15)
