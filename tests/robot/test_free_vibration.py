"""Frequencies of free bodies whose shapes are coupled: by a payload, or by a choice of shapes."""

import numpy as np
import pytest

import parflex as pf
from parflex.robot.modal import free_vibration

PLATE = ([(0, 0), (0.6, 0), (0.6, 0.4), (0, 0.4)], 0.01, 7e10, 0.33, 2700.0)


def vibration(body: pf.FlexibleBody) -> tuple[np.ndarray, np.ndarray]:
    return free_vibration(body.moments, body.stiffness, body.damping)


def test_free_modes_are_their_own():
    body = pf.FlexibleBody.from_modes(pf.fe.plate_modes(*PLATE, n_modes=6), damping_ratio=0.03)
    omega, zeta = vibration(body)
    assert np.allclose(omega, body.frequencies, rtol=1e-9)
    assert np.allclose(zeta, 0.03, rtol=1e-9)


@pytest.mark.parametrize("node", [0, 7])
def test_a_payload_changes_them_as_it_does_the_whole_free_body(node):
    """Against nodal masses: rigid motions and shapes as one basis, its mass matrix summed over the nodes."""
    modes = pf.fe.plate_modes(*PLATE, n_modes=6)
    body = pf.FlexibleBody.from_modes(modes, origin=(0, 0, 0))
    rng = np.random.default_rng(0)
    r, dm = body.nodes, rng.uniform(0.5, 1.0, len(body.nodes))
    shapes = body.shapes
    M = np.einsum("k,nka,jka->nj", dm, shapes, shapes)
    shapes = np.einsum("ij,jka->ika", np.linalg.inv(np.linalg.cholesky(M)), shapes)  # unit modal mass
    nodal = pf.FlexibleBody.from_nodes(r, dm, shapes, body.frequencies, 0.0, [0, 1, 2])
    loaded = nodal.with_payload(node, 3.0)
    dm = dm + 3.0 * (np.arange(len(dm)) == node)
    rigid = np.concatenate(
        [np.broadcast_to(np.eye(3)[:, None], (3, *r.shape)), np.cross(np.eye(3)[:, None], r)]
    )
    basis = np.concatenate([rigid, shapes])
    mass = np.einsum("k,nka,jka->nj", dm, basis, basis)
    stiffness = np.diag(np.concatenate([np.zeros(6), nodal.stiffness]))
    values = np.sort(np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real)[6:]
    assert np.allclose(vibration(loaded)[0], np.sqrt(values), rtol=1e-9)
